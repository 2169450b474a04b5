# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
from dataclasses import asdict

import pytest
import yaml

from sextant.objects.object_kinds import KINDS, ObjectKind, kinds_of


def test_kinds_are_read_of_yaml():
    written = yaml.safe_load("cone: {shape: pillar, radius: 0.1}\ntennis: {shape: ball, radius: 0.033}\n")
    assert kinds_of(written) == {"cone": ObjectKind("pillar", 0.1), "tennis": ObjectKind("ball", 0.033)}
    assert kinds_of({}) == KINDS
    assert kinds_of({name: asdict(kind) for name, kind in KINDS.items()}) == KINDS


@pytest.mark.parametrize(
    "fields, reason",
    [
        ({"shape": "cube", "radius": 0.1}, "kinds/x/shape: must be one of pillar, ball, is 'cube'"),
        ({"shape": "ball", "radius": 0.0}, r"kinds/x/radius: must be within \(0, 1\], is 0.0"),
        ({"shape": "ball", "radius": "thick"}, "kinds/x/radius: must be a finite number, is 'thick'"),
        ({"shape": "ball"}, "kinds/x/radius: required, but not set"),
        (
            {"shape": "ball", "radius": 0.1, "mass": 1},
            "kinds/x/mass: unknown parameter; known are radius, shape",
        ),
    ],
)
def test_what_cannot_be_is_named(fields, reason):
    with pytest.raises(ValueError, match=reason):
        kinds_of({"x": fields})
