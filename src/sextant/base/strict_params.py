# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Strict parameters, of a component, of a node or of a file.

They are stated as a dataclass, the only home of their defaults and of what is allowed:

    @dataclass(frozen=True)
    class SimulatorParams(StrictParams):
        map_file: str                                  # no default: the parameter is required
        width: int = param(640, within(16, 8192))      # pixels
        mode: str = param("path", one_of("path", "cmd_vel"))
        sizes: Dict[str, float] = param({}, each(within(0.001, 100.0)))
        lens: LensParams = nested(LensParams, "lens_") # flat in parse_params(): lens_width

A value out of range is refused on construction. parse_params() also refuses an unknown name, a wrong type
or a missing value, with the full name and what is allowed.
"""

import copy
import dataclasses
import difflib
import math
from typing import Any, Callable, Dict, List, Mapping, Sequence, Tuple, Type, TypeVar, get_type_hints

Check = Callable[[Any], str]  # "" or what is allowed
Params = TypeVar("Params")


class ParamError(ValueError):
    """A value that is not allowed: "name: reason other, is value"; `other` is another field."""

    def __init__(self, name: str, reason: str, value: Any, other: str = ""):
        super().__init__(name, reason, value, other)

    def __str__(self) -> str:
        name, reason, value, other = self.args
        return f"{name}: {reason}{' ' * bool(other)}{other}, is {value!r}"

    def with_prefix(self, prefix: str) -> "ParamError":
        """The same of nested parameters."""
        name, reason, value, other = self.args
        return ParamError(prefix + name, reason, value, other and prefix + other)


@dataclasses.dataclass(frozen=True)
class StrictParams:
    """Checks each field on construction; checks of several fields are added in __post_init__()."""

    def __post_init__(self) -> None:
        """:raises ParamError: names the first field whose value is not allowed"""
        for field in dataclasses.fields(self):
            _check(field, getattr(self, field.name))


def param(default: Any, check: Check = lambda value: "") -> Any:
    """A dataclass field with a default and a check of its value."""
    if isinstance(default, (list, dict)):
        return dataclasses.field(default_factory=lambda: copy.copy(default), metadata={"check": check})
    return dataclasses.field(default=default, metadata={"check": check})


def required(check: Check) -> Any:
    """A dataclass field without a default, with a check of its value."""
    return dataclasses.field(metadata={"check": check})


def nested(cls: type, prefix: str = "", only: Sequence[str] = ()) -> Any:
    """A dataclass field of parameters that are a dataclass of their own, flat for parse_params().

    :param prefix: of their flat names
    :param only: their names, without the prefix, that can be set; empty: all
    """
    return dataclasses.field(default_factory=cls, metadata={"prefix": prefix, "only": only})


def within(low: float, high: float) -> Check:
    """low <= value <= high."""
    return lambda value: "" if low <= value <= high else f"must be within [{low}, {high}]"


def above_zero(high: float) -> Check:
    """0 < value <= high."""
    return lambda value: "" if 0.0 < value <= high else f"must be within (0, {high:g}]"


def one_of(*allowed: Any) -> Check:
    """The value is one of these."""
    return lambda value: "" if value in allowed else "must be one of " + ", ".join(map(str, allowed))


def not_empty(value: Any) -> str:
    """The value, a string or a list, has something in it."""
    return "" if value else "must not be empty"


def each(check: Check) -> Check:
    """Every value of a list or dictionary passes the check."""

    def check_all(values):
        items = values.values() if isinstance(values, dict) else values
        return next((f"each {reason}" for reason in map(check, items) if reason), "")

    return check_all


Field = Tuple[dataclasses.Field, Any]  # with its type


def flat_fields(cls: type, only: Sequence[str] = ()) -> Dict[str, Field]:
    """All parameters of a dataclass by name, those of nested ones with their prefixes.

    Where two nested ones have the same name, its value is set in both.
    """
    flat = {}
    for field, hint in _fields(cls):
        if dataclasses.is_dataclass(hint):
            inner = flat_fields(hint)
            flat.update({name: inner[own] for name, own in _nested_names(field, hint).items()})
        else:
            flat[field.name] = field, hint
    return {name: each for name, each in flat.items() if not only or name in only}


def _fields(cls: type) -> List[Field]:
    types = get_type_hints(cls)
    return [(field, types[field.name]) for field in dataclasses.fields(cls)]


def _nested_names(field: dataclasses.Field, cls: type) -> Dict[str, str]:
    """Flat names to those without the prefix."""
    names = flat_fields(cls, field.metadata.get("only", ()))
    return {field.metadata.get("prefix", "") + name: name for name in names}


def parse_params(
    cls: Type[Params], values: Mapping[str, Any], namespace: str, separator: str = "/"
) -> Params:
    """An instance of the dataclass from a dictionary of parameters by flat names.

    :param namespace: full name of the node, or the file; with the separator behind it only for the messages
    :raises ValueError: full name of the first parameter that cannot be taken, and what is allowed
    """
    known, start = flat_fields(cls), namespace + separator
    for name in values:
        if name not in known:
            raise ValueError(f"{start}{name}: unknown parameter; {_suggestion(name, sorted(known))}")
    missing = [name for name, flat in known.items() if name not in values and _is_required(flat[0])]
    try:
        taken = {name: _checked(name, known[name], value) for name, value in values.items()}
        if missing:
            raise ValueError(f"{missing[0]}: required, but not set")
        return _built(cls, taken)
    except ValueError as error:
        raise ValueError(f"{start}{error}") from None


def _built(cls: Type[Params], values: Mapping[str, Any]) -> Params:
    arguments = {}
    for field, hint in _fields(cls):
        if dataclasses.is_dataclass(hint):
            names = _nested_names(field, hint)
            try:
                inner = {name: values[flat] for flat, name in names.items() if flat in values}
                arguments[field.name] = _built(hint, inner)
            except ParamError as error:
                raise error.with_prefix(field.metadata.get("prefix", "")) from None
        elif field.name in values:
            arguments[field.name] = values[field.name]
    return cls(**arguments)


# What sextant._core calls the types of parameters.
_TYPES = {
    "true/false": bool,
    "whole": int,
    "real": float,
    "text": str,
    "list of texts": List[str],
    "list of reals": List[float],
    "table of reals": Dict[str, float],
    "table of texts": Dict[str, str],
}


def parse_struct(
    struct: Type[Params], values: Mapping[str, Any], namespace: str, separator: str = "/"
) -> Params:
    """As parse_params(), an instance of a struct of parameters of the core."""
    fields = [(name, _TYPES[kind]) for name, kind, _, _, _ in struct.fields()]
    record = dataclasses.make_dataclass(struct.__name__, [(*field, param(None)) for field in fields])
    taken, params = parse_params(record, values, namespace, separator), struct()
    for name in values:
        setattr(params, name, getattr(taken, name))
    try:
        params.validate()
    except ValueError as error:
        raise ValueError(f"{namespace}{separator}{error}") from None
    return params


def _is_required(field: dataclasses.Field) -> bool:
    return field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING


def _check(field: dataclasses.Field, value: Any, name: str = "") -> None:
    reason = field.metadata.get("check", lambda checked: "")(value)
    if reason:
        raise ParamError(name or field.name, reason, value)


def _suggestion(name: str, known: List[str]) -> str:
    close = difflib.get_close_matches(name, known, 1)
    return f"did you mean {close[0]}?" if close else "known are " + ", ".join(known)


def _checked(name: str, field: Field, value: Any) -> Any:
    try:
        converted = _converted(field[1], value)
    except TypeError as error:
        raise ParamError(name, f"must be {error}", value) from None
    _check(field[0], converted, name)
    return converted


def _converted(hint: Any, value: Any) -> Any:
    """:raises TypeError: with the name of the type that is allowed"""
    if hint is Any:
        return value
    origin = getattr(hint, "__origin__", None)
    if origin in _CONTAINERS:
        return _CONTAINERS[origin](hint.__args__, value)
    name, accepts = _SCALARS[hint]
    if not accepts(value):
        raise TypeError(name)
    return hint(value)


def _list(args, value) -> List[Any]:
    if not isinstance(value, list):
        raise TypeError("a list")
    return [_converted(args[0], item) for item in value]


def _tuple(args, value) -> Tuple[Any, ...]:
    return tuple(_list(args, value))


def _dict(args, value) -> Dict[str, Any]:
    if not isinstance(value, dict):
        raise TypeError("a dictionary")
    return {str(key): _converted(args[1], item) for key, item in value.items()}


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


_CONTAINERS = {list: _list, tuple: _tuple, dict: _dict}
_SCALARS = {
    bool: ("true or false", lambda value: isinstance(value, bool)),
    int: ("a whole number", lambda value: isinstance(value, int) and not isinstance(value, bool)),
    float: ("a finite number", _is_number),
    str: ("a string (quote a number)", lambda value: isinstance(value, str)),
}
