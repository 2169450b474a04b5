# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What kinds of objects there are on the floor, by the names of their classes."""

from typing import Any, Dict, Mapping, NamedTuple

SHAPES = ("pillar", "ball")
LARGEST = 1.0  # radius, metres


class ObjectKind(NamedTuple):
    """Shape and size of all objects of a class."""

    shape: str  # "pillar", upright, or "ball"
    radius: float  # metres


BALL, GOAL = "ball", "blue_pillar"
KINDS: Dict[str, ObjectKind] = {
    BALL: ObjectKind("ball", 0.05),
    GOAL: ObjectKind("pillar", 0.05),
    "green_pillar": ObjectKind("pillar", 0.05),
    "red_pillar": ObjectKind("pillar", 0.05),
}


def kinds_of(written: Mapping[str, Any]) -> Dict[str, ObjectKind]:
    """Of a YAML dictionary {class name: {shape: pillar or ball, radius: metres}}; an empty one means KINDS.

    :raises ValueError: names the class, what of it cannot be, and what is allowed
    """
    return {str(name): _kind(f"kinds/{name}", fields) for name, fields in written.items()} or dict(KINDS)


def _kind(name: str, fields: Any) -> ObjectKind:
    if not isinstance(fields, Mapping) or set(fields) != set(ObjectKind._fields):
        raise ValueError(f"{name}: must be {{shape: ..., radius: ...}}, is {fields!r}")
    shape, radius = fields["shape"], fields["radius"]
    if shape not in SHAPES:
        raise ValueError(f"{name}/shape: must be one of {', '.join(SHAPES)}, is {shape!r}")
    if isinstance(radius, bool) or not isinstance(radius, (int, float)) or not 0.0 < radius <= LARGEST:
        raise ValueError(f"{name}/radius: must be within (0, {LARGEST:g}] metres, is {radius!r}")
    return ObjectKind(shape, float(radius))
