# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Strict parameters, of a node or of a file.

They are stated as a dataclass, the only home of their defaults:

    @dataclass(frozen=True)
    class SimulatorParams:
        map_file: str                                  # no default: the parameter is required
        width: int = param(640, within(16, 8192))      # pixels
        mode: str = param("path", one_of("path", "cmd_vel"))
        sizes: Dict[str, float] = param({}, each(within(0.001, 100.0)))

An unknown name, a wrong type, a value out of range or a missing one is refused with the full name and what is
allowed.
"""

import copy
import dataclasses
import difflib
import math
from typing import Any, Callable, Dict, List, Mapping, Type, TypeVar, get_type_hints

Check = Callable[[Any], str]  # "" or what is allowed
Params = TypeVar("Params")


def param(default: Any, check: Check = lambda value: "") -> Any:
    """A dataclass field with a default and a check of its value."""
    return dataclasses.field(default_factory=lambda: copy.copy(default), metadata={"check": check})


def required(check: Check) -> Any:
    """A dataclass field without a default, with a check of its value."""
    return dataclasses.field(metadata={"check": check})


def within(low: float, high: float) -> Check:
    """low <= value <= high."""
    return lambda value: "" if low <= value <= high else f"must be within [{low}, {high}]"


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


def parse_params(
    cls: Type[Params], values: Mapping[str, Any], namespace: str, separator: str = "/"
) -> Params:
    """An instance of the dataclass from a parameter dictionary.

    :param namespace: full name of the node, or the file; with the separator behind it only for the messages
    :raises ValueError: full name of the first parameter that cannot be taken, and what is allowed
    """
    fields = {field.name: field for field in dataclasses.fields(cls)}
    prefix = namespace + separator
    for name in values:
        if name not in fields:
            raise ValueError(f"{prefix}{name}: unknown parameter; {_suggestion(name, sorted(fields))}")
    types = get_type_hints(cls)
    taken = {name: _checked(fields[name], types[name], value, prefix) for name, value in values.items()}
    for name, field in fields.items():
        if name not in taken and _is_required(field):
            raise ValueError(f"{prefix}{name}: required, but not set")
    try:
        return cls(**taken)
    except ValueError as error:  # of values that do not go together
        raise ValueError(f"{prefix}{error}") from None


def _is_required(field: dataclasses.Field) -> bool:
    return field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING


def _suggestion(name: str, known: List[str]) -> str:
    close = difflib.get_close_matches(name, known, 1)
    return f"did you mean {close[0]}?" if close else "known are " + ", ".join(known)


def _checked(field: dataclasses.Field, hint: Any, value: Any, prefix: str) -> Any:
    full_name = prefix + field.name
    try:
        converted = _converted(hint, value)
    except TypeError as error:
        raise ValueError(f"{full_name}: must be {error}, is {value!r}") from None
    reason = field.metadata.get("check", lambda checked: "")(converted)
    if reason:
        raise ValueError(f"{full_name}: {reason}, is {value!r}")
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


def _dict(args, value) -> Dict[str, Any]:
    if not isinstance(value, dict):
        raise TypeError("a dictionary")
    return {str(key): _converted(args[1], item) for key, item in value.items()}


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


_CONTAINERS = {list: _list, dict: _dict}
_SCALARS = {
    bool: ("true or false", lambda value: isinstance(value, bool)),
    int: ("a whole number", lambda value: isinstance(value, int) and not isinstance(value, bool)),
    float: ("a finite number", _is_number),
    str: ("a string (quote a number)", lambda value: isinstance(value, str)),
}
