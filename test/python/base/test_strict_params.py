# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
from dataclasses import dataclass
from typing import Dict, List

import pytest

from sextant.base.strict_params import each, not_empty, one_of, param, parse_params, required, within


@dataclass(frozen=True)
class CameraParams:
    device: str = required(not_empty)
    width: int = param(640, within(16, 8192))
    rate: float = param(30.0, within(0.1, 1000.0))
    mode: str = param("colour", one_of("colour", "grey"))
    flip: bool = param(False)
    sizes: Dict[str, float] = param({}, each(within(0.0, 1.0)))
    names: List[str] = param(["a"])


def parse(**values):
    return parse_params(CameraParams, values, "/robot/camera")


def test_defaults_and_values():
    params = parse(device="video0", rate=15, sizes={"7": 1}, names=[])
    assert params == CameraParams("video0", 640, 15.0, "colour", False, {"7": 1.0}, [])
    assert isinstance(params.rate, float)


def test_a_list_default_is_not_shared():
    parse(device="a").names.append("b")
    assert parse(device="a").names == ["a"]


@pytest.mark.parametrize(
    "values, message",
    [
        ({}, "/robot/camera/device: required, but not set"),
        ({"device": ""}, "/robot/camera/device: must not be empty, is ''"),
        ({"device": 7}, "/robot/camera/device: must be a string (quote a number), is 7"),
        ({"device": "a", "widht": 1}, "/robot/camera/widht: unknown parameter; did you mean width?"),
        ({"device": "a", "width": 640.5}, "/robot/camera/width: must be a whole number, is 640.5"),
        ({"device": "a", "width": True}, "/robot/camera/width: must be a whole number, is True"),
        ({"device": "a", "width": 15}, "/robot/camera/width: must be within [16, 8192], is 15"),
        ({"device": "a", "rate": float("nan")}, "/robot/camera/rate: must be a finite number, is nan"),
        ({"device": "a", "rate": "30"}, "/robot/camera/rate: must be a finite number, is '30'"),
        ({"device": "a", "mode": "gray"}, "/robot/camera/mode: must be one of colour, grey, is 'gray'"),
        ({"device": "a", "flip": 1}, "/robot/camera/flip: must be true or false, is 1"),
        (
            {"device": "a", "sizes": {"7": 2.0}},
            "/robot/camera/sizes: each must be within [0.0, 1.0], is {'7': 2.0}",
        ),
        ({"device": "a", "sizes": {"7": "x"}}, "/robot/camera/sizes: must be a finite number, is {'7': 'x'}"),
        ({"device": "a", "sizes": []}, "/robot/camera/sizes: must be a dictionary, is []"),
        ({"device": "a", "names": "a"}, "/robot/camera/names: must be a list, is 'a'"),
    ],
)
def test_refused(values, message):
    with pytest.raises(ValueError) as refused:
        parse(**values)
    assert str(refused.value) == message
