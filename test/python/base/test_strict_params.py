# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import pickle
from dataclasses import dataclass
from typing import Dict, List

import pytest

from sextant.base.strict_params import (
    ParamError,
    StrictParams,
    above_zero,
    each,
    flat_fields,
    nested,
    not_empty,
    one_of,
    param,
    parse_params,
    required,
    within,
)


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


@dataclass(frozen=True)
class LensParams(StrictParams):
    near: float = param(0.1, within(0.0, 10.0))
    far: float = param(5.0, within(0.0, 10.0))
    glass: str = param("clear")

    def __post_init__(self):
        super().__post_init__()
        if self.near >= self.far:
            raise ParamError("near", "must be less than", self.near, "far")


@dataclass(frozen=True)
class RobotParams(StrictParams):
    speed: float = param(0.5, above_zero(2.0))
    left: LensParams = nested(LensParams, "left_", only=("near", "far"))
    right: LensParams = nested(LensParams)


def test_nested_parameters_are_flat_with_their_prefixes():
    assert list(flat_fields(RobotParams)) == ["speed", "left_near", "left_far", "near", "far", "glass"]
    params = parse_params(RobotParams, {"left_near": 1, "far": 2, "speed": 1}, "/robot")
    assert params == RobotParams(1.0, LensParams(near=1.0), LensParams(far=2.0))


@pytest.mark.parametrize(
    "values, message",
    [
        ({"left_near": 6.0}, "/robot/left_near: must be less than left_far, is 6.0"),
        ({"near": 6.0}, "/robot/near: must be less than far, is 6.0"),
        ({"left_far": 11.0}, "/robot/left_far: must be within [0.0, 10.0], is 11.0"),
        ({"left_glass": "x"}, "/robot/left_glass: unknown parameter; did you mean left_far?"),
    ],
)
def test_nested_parameters_are_refused_by_their_flat_names(values, message):
    with pytest.raises(ValueError) as refused:
        parse_params(RobotParams, values, "/robot")
    assert str(refused.value) == message


@pytest.mark.parametrize("value", [0.0, 2.1, float("nan")])
def test_a_value_out_of_range_is_refused_on_construction(value):
    with pytest.raises(ParamError, match=r"^speed: must be within \(0, 2\], is "):
        RobotParams(speed=value)
    assert str(pickle.loads(pickle.dumps(ParamError("a", "must be less than", 2, "b")))) == (
        "a: must be less than b, is 2"
    )
