# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Shapes and sizes of the objects on the floor, by class name."""

from dataclasses import dataclass
from typing import Any, Dict, Mapping

from sextant.base.strict_params import StrictParams, above_zero, one_of, parse_params, required


@dataclass(frozen=True)
class ObjectKind(StrictParams):
    """Shape and size of all objects of a class."""

    shape: str = required("a pillar is an upright cylinder", one_of("pillar", "ball"))
    radius: float = required("radius of the pillar or ball", above_zero(1.0), "m")


BALL, GOAL = "ball", "blue_pillar"
KINDS: Dict[str, ObjectKind] = {
    BALL: ObjectKind("ball", 0.05),
    GOAL: ObjectKind("pillar", 0.05),
    "green_pillar": ObjectKind("pillar", 0.05),
    "red_pillar": ObjectKind("pillar", 0.05),
}


def kinds_of(written: Mapping[str, Mapping[str, Any]]) -> Dict[str, ObjectKind]:
    """Parse a YAML dictionary {class name: {shape: pillar or ball, radius: metres}}; empty: KINDS.

    :raises ValueError: names the class, the invalid field and the allowed values
    """
    kinds = {str(name): parse_params(ObjectKind, kind, f"kinds/{name}") for name, kind in written.items()}
    return kinds or dict(KINDS)
