# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Strict parameters of a component, a node or a file.

A dataclass declares the parameters with their defaults and allowed values:

    @dataclass(frozen=True)
    class SimulatorParams(StrictParams):
        map_file: str                                  # no default: the parameter is required
        width: int = param(640, "image width", within(16, 8192), "px")
        mode: str = param("path", "motion of the robot", one_of("path", "cmd_vel"))
        sizes: Dict[str, float] = param({}, "edge lengths by id", each(within(0.001, 100.0)), "m")
        lens: LensParams = nested(LensParams, "lens_") # flat in parse_params(): lens_width

A value out of range is refused on construction. parse_params() also refuses an unknown name, a wrong type
or a missing value; the error names the parameter and the allowed values. described() lists the parameters for
the documentation, as fields() of a struct of the core.
"""

import copy
import dataclasses
import difflib
import math
import re
from typing import (
    Any,
    Callable,
    Dict,
    List,
    Mapping,
    NamedTuple,
    Sequence,
    Tuple,
    Type,
    TypeVar,
    get_type_hints,
)

Params = TypeVar("Params")


class Check(NamedTuple):
    """The values that a parameter may have."""

    text: str  # for the documentation, Markdown; empty: every value of the type
    reason: Callable[[Any], str] = lambda value: ""  # "" if the value is allowed, else the allowed values

    def __call__(self, value: Any) -> str:
        return self.reason(value)


ANY = Check("")
REQUIRED = dataclasses.MISSING  # in place of the default of a parameter without one


class ParamError(ValueError):
    """A value is not allowed: "name: reason other, is value"; other is the name of another field."""

    def __init__(self, name: str, reason: str, value: Any, other: str = ""):
        super().__init__(name, reason, value, other)

    def __str__(self) -> str:
        name, reason, value, other = self.args
        return f"{name}: {reason}{' ' * bool(other)}{other}, is {value!r}"

    def with_prefix(self, prefix: str) -> "ParamError":
        """Returns the same error with a prefix of nested parameters before the names."""
        name, reason, value, other = self.args
        return ParamError(prefix + name, reason, value, other and prefix + other)


@dataclasses.dataclass(frozen=True)
class StrictParams:
    """Base class: checks each field on construction. Subclasses check combinations in __post_init__()."""

    def __post_init__(self) -> None:
        """:raises ParamError: a value is not allowed; names the first such field"""
        for field in dataclasses.fields(self):
            _check(field, getattr(self, field.name))


def param(default: Any, what: str, check: Check = ANY, unit: str = "") -> Any:
    """Declares a dataclass field with a default.

    :param what: description, Markdown; other parameters of the dataclass in backticks
    :param unit: as text, e.g. m or px; empty for a value without a unit
    """
    metadata = {"what": what, "check": check, "unit": unit}
    if isinstance(default, (list, dict)):
        return dataclasses.field(default_factory=lambda: copy.copy(default), metadata=metadata)
    return dataclasses.field(default=default, metadata=metadata)


def required(what: str, check: Check = ANY, unit: str = "") -> Any:
    """Declares a dataclass field without a default, otherwise as param()."""
    return dataclasses.field(metadata={"what": what, "check": check, "unit": unit})


def struct_param(struct: type, name: str, check: Callable[[Any], str] = ANY) -> Any:
    """Declares a dataclass field with default, description, unit and allowed values of a struct of the core.

    :param check: refuses values on construction; without it, the struct has to be validated later
    """
    _, _, allowed, unit, what = next(field for field in struct.fields() if field[0] == name)
    return param(getattr(struct(), name), what, Check(allowed, check), unit)


def nested(cls: type, prefix: str = "", only: Sequence[str] = ()) -> Any:
    """Declares a field whose parameters are another dataclass; parse_params() takes them by flat names.

    :param prefix: prefix of the flat names
    :param only: names, without the prefix, that can be set; empty: all
    """
    return dataclasses.field(default_factory=cls, metadata={"prefix": prefix, "only": only})


def within(low: float, high: float) -> Check:
    """Allows low <= value <= high."""
    text = f"[{_number(low)}, {_number(high)}]"
    return Check(text, lambda value: "" if low <= value <= high else f"must be within [{low}, {high}]")


def above_zero(high: float) -> Check:
    """Allows 0 < value <= high."""
    reason = f"must be within (0, {high:g}]"
    return Check(f"(0, {_number(high)}]", lambda value: "" if 0.0 < value <= high else reason)


def _number(value: float) -> str:
    return re.sub(r"e([+-])0*", r"e\1", f"{value:.12g}").replace("e+", "e")


def one_of(*allowed: Any) -> Check:
    """Allows these values."""
    text = ", ".join(map(str, allowed))
    return Check(text, lambda value: "" if value in allowed else f"must be one of {text}")


not_empty = Check("not empty", lambda value: "" if value else "must not be empty")  # strings and lists


def each(check: Check) -> Check:
    """Allows lists and dictionaries in which every value passes the check."""

    def check_all(values):
        items = values.values() if isinstance(values, dict) else values
        return next((f"each {reason}" for reason in map(check, items) if reason), "")

    return Check(check.text, check_all)


def also(check: Check, text: str) -> Check:
    """Adds to the text of a check what is checked elsewhere, e.g. a relation to another parameter."""
    return check._replace(text=f"{check.text}, {text}")


Field = Tuple[dataclasses.Field, Any]  # a field and its type


def flat_fields(cls: type, only: Sequence[str] = ()) -> Dict[str, Field]:
    """Returns all parameters of a dataclass by flat name; names of nested dataclasses have their prefixes.

    Where two nested dataclasses share a name, its value is set in both.
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
    """Returns the names without the prefix by flat name."""
    names = flat_fields(cls, field.metadata.get("only", ()))
    return {field.metadata.get("prefix", "") + name: name for name in names}


class Described(NamedTuple):
    """A parameter for the documentation, Markdown."""

    name: str  # flat
    kind: str  # as in fields() of a struct of the core
    allowed: str  # allowed values; empty: every value of the type
    unit: str  # empty: none
    what: str  # description
    default: Any  # REQUIRED: has none

    def renamed(self, names: Mapping[str, str]) -> "Described":
        """Returns the same parameter with other names, also where the texts name parameters."""

        def with_names(text: str) -> str:
            return re.sub(r"`(\w+)`", lambda name: f"`{names.get(name[1], name[1])}`", text)

        name, allowed, what = names[self.name], with_names(self.allowed), with_names(self.what)
        return self._replace(name=name, allowed=allowed, what=what)

    def plain(self) -> str:
        """Returns the description without Markdown."""
        return re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", self.what).replace("`", "")


def described(cls: type) -> List[Described]:
    """Returns all parameters of a dataclass by flat name, as flat_fields() does."""
    rows = {}
    for field, hint in _fields(cls):
        if dataclasses.is_dataclass(hint):
            names = {own: flat for flat, own in _nested_names(field, hint).items()}
            inner = [row.renamed(names) for row in described(hint) if row.name in names]
            rows.update({row.name: row for row in inner})
        else:
            rows[field.name] = _described(field, hint)
    return list(rows.values())


def _described(field: dataclasses.Field, hint: Any) -> Described:
    about = field.metadata
    has_factory = field.default_factory is not dataclasses.MISSING
    default = field.default_factory() if has_factory else field.default
    allowed, unit, what = about.get("check", ANY).text, about.get("unit", ""), about.get("what", "")
    return Described(field.name, _kind(hint), allowed, unit, what, default)


def _kind(hint: Any) -> str:
    """Returns the type as a struct of the core names it."""
    if getattr(hint, "__origin__", None) is tuple:
        hint = List[hint.__args__[0]]
    return next((kind for kind, each in _TYPES.items() if each == hint), "dictionary")


def parse_params(
    cls: Type[Params], values: Mapping[str, Any], namespace: str, separator: str = "/"
) -> Params:
    """Builds an instance of the dataclass from parameters by flat name.

    :param namespace: full name of the node or path of the file, for errors
    :param separator: between namespace and parameter, for errors
    :raises ValueError: a parameter is refused; gives its full name and the allowed values
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


# Parameter types by their names in sextant._core.
_TYPES = {
    "bool": bool,
    "int": int,
    "double": float,
    "string": str,
    "list of strings": List[str],
    "list of doubles": List[float],
    "dictionary of doubles": Dict[str, float],
    "dictionary of strings": Dict[str, str],
}


def parse_struct(
    struct: Type[Params], values: Mapping[str, Any], namespace: str, separator: str = "/"
) -> Params:
    """Builds a params struct of the core, as parse_params()."""
    fields = [(name, _TYPES[kind]) for name, kind, _, _, _ in struct.fields()]
    record = dataclasses.make_dataclass(struct.__name__, [(*field, param(None, "")) for field in fields])
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
    """:raises TypeError: the value has another type; names the allowed one"""
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


def _dict(args, value) -> Dict[str, Any]:
    if not isinstance(value, dict):
        raise TypeError("a dictionary")
    return {str(key): _converted(args[1], item) for key, item in value.items()}


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


_CONTAINERS = {list: _list, tuple: lambda args, value: tuple(_list(args, value)), dict: _dict}
_SCALARS = {
    bool: ("true or false", lambda value: isinstance(value, bool)),
    int: ("a whole number", lambda value: isinstance(value, int) and not isinstance(value, bool)),
    float: ("a finite number", _is_number),
    str: ("a string (quote a number)", lambda value: isinstance(value, str)),
}
