# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Changes fields of ROS messages at random, to any value that can be serialized."""

import copy
import re
from typing import Any, Iterator, Tuple

import genpy
import numpy as np

FLOATS = (np.nan, np.inf, -np.inf, 0.0, -1.0, 1e-300, 1e30, 1e300)  # besides, random factors
STRINGS = ("", "nowhere", "/", "a" * 1000, "32FC1", "base_link")
RANGES = {f"{sign}int{bits}": bits for sign in ("", "u") for bits in (8, 16, 32, 64)}
MAX_LENGTH = 1000  # elements that an array is extended to


def changed(message: Any, rng: np.random.Generator) -> Any:
    """A copy of a message with one to three changed fields."""
    result = copy.deepcopy(message)
    leaves = list(_leaves(result))
    for _ in range(int(rng.integers(1, 4))):
        owner, name, kind = leaves[int(rng.integers(len(leaves)))]
        setattr(owner, name, _value(getattr(owner, name), kind, rng))
    return result


def _leaves(message: Any) -> Iterator[Tuple[Any, str, str]]:
    """(message, field, type) of all fields that are not messages, also those of messages in arrays."""
    for name, kind in zip(message.__slots__, message._slot_types):  # noqa: SLF001
        value = getattr(message, name)
        if isinstance(value, genpy.Message):
            yield from _leaves(value)
            continue
        yield message, name, kind
        if isinstance(value, list):
            for each in value:
                if isinstance(each, genpy.Message):
                    yield from _leaves(each)


def _value(value: Any, kind: str, rng: np.random.Generator) -> Any:
    array = re.fullmatch(r"(.*)\[(\d*)\]", kind)
    if array:
        return _array(value, *array.groups(), rng)
    if kind in RANGES:
        return _integer(kind, rng)
    if kind == "bool":
        return not value
    if kind == "string":
        return STRINGS[int(rng.integers(len(STRINGS)))]
    if kind in ("time", "duration"):
        most = 2**32 if kind == "time" else 2**31
        return type(value)(int(rng.integers(0, most)), int(rng.integers(0, 10**9)))
    return _float(value, rng)


def _integer(kind: str, rng: np.random.Generator) -> int:
    bits, low = RANGES[kind], 0 if kind[0] == "u" else -(2 ** (RANGES[kind] - 1))
    choices = (low, low + 2**bits - 1, 0, 1, int(rng.integers(0, 2 ** (bits - 1))))
    return choices[int(rng.integers(len(choices)))]


def _float(value: float, rng: np.random.Generator) -> float:
    choices = (*FLOATS, value * rng.normal(), rng.normal(0, 100.0))
    return float(choices[int(rng.integers(len(choices)))])


def _array(value: Any, kind: str, length: str, rng: np.random.Generator) -> Any:
    if isinstance(value, bytes):
        cut = value[: int(rng.integers(0, len(value) + 1))]
        return rng.bytes(len(value)) if rng.random() < 0.5 else cut
    result = list(value)
    if result and rng.random() < 0.7 and not isinstance(result[0], genpy.Message):
        index = int(rng.integers(len(result)))
        result[index] = _value(result[index], kind, rng)
    elif not length and result:
        result = (result * MAX_LENGTH)[: int(rng.integers(0, MAX_LENGTH))]
    return result
