# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import pickle
from dataclasses import dataclass
from typing import Dict, List, Tuple

import pytest

from sextant.base.strict_params import (
    REQUIRED,
    Check,
    ParamError,
    StrictParams,
    above_zero,
    also,
    described,
    each,
    flat_fields,
    nested,
    not_empty,
    one_of,
    param,
    parse_params,
    required,
    struct_param,
    within,
)


@dataclass(frozen=True)
class CameraParams:
    device: str = required("path of the `device`", not_empty)
    width: int = param(640, "image width", within(16, 8192), "px")
    rate: float = param(30.0, "frame rate", within(0.1, 1000.0), "Hz")
    mode: str = param("colour", "colour space", one_of("colour", "grey"))
    flip: bool = param(False, "upside down")
    sizes: Dict[str, float] = param({}, "by id", each(within(0.0, 1.0)), "m")
    names: List[str] = param(["a"], "of the cameras")


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
    near: float = param(0.1, "nearest distance", also(within(0.0, 10.0), "less than `far`"), "m")
    far: float = param(5.0, "farthest distance, after `near`", within(0.0, 10.0), "m")
    glass: str = param("clear", "kind of `wood`")

    def __post_init__(self):
        super().__post_init__()
        if self.near >= self.far:
            raise ParamError("near", "must be less than", self.near, "far")


@dataclass(frozen=True)
class RobotParams(StrictParams):
    speed: float = param(0.5, "maximum speed", above_zero(2.0), "m/s")
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


def test_parameters_are_described_as_those_of_structs():
    assert [tuple(row) for row in described(CameraParams)] == [
        ("device", "string", "not empty", "", "path of the `device`", REQUIRED),
        ("width", "int", "[16, 8192]", "px", "image width", 640),
        ("rate", "double", "[0.1, 1000]", "Hz", "frame rate", 30.0),
        ("mode", "string", "colour, grey", "", "colour space", "colour"),
        ("flip", "bool", "", "", "upside down", False),
        ("sizes", "dictionary of doubles", "[0, 1]", "m", "by id", {}),
        ("names", "list of strings", "", "", "of the cameras", ["a"]),
    ]


def test_texts_name_nested_parameters_in_full():
    rows = {row.name: row for row in described(RobotParams)}
    assert list(rows) == list(flat_fields(RobotParams))
    assert rows["speed"].allowed == "(0, 2]"
    assert rows["left_near"].allowed == "[0, 10], less than `left_far`"
    assert rows["left_far"].what == "farthest distance, after `left_near`"
    assert (rows["near"].allowed, rows["glass"].what) == ("[0, 10], less than `far`", "kind of `wood`")


@pytest.mark.parametrize(
    "low, high, text",
    [(0, 2**31 - 1, "[0, 2147483647]"), (1e-9, 0.999, "[1e-9, 0.999]"), (-1, 1e5, "[-1, 100000]")],
)
def test_texts_of_ranges_are_those_of_structs(low, high, text):
    assert within(low, high).text == text


class Struct:
    """In place of one of the core."""

    gain = 2.0

    @staticmethod
    def fields():
        return [("gain", "double", "[1, 3]", "dB", "amplification")]


@dataclass(frozen=True)
class AmplifierParams(StrictParams):
    gain: float = struct_param(Struct, "gain")
    pair: Tuple[float, ...] = param((1.0, 2.0), "levels", Check("2"))


def test_a_parameter_of_a_struct_has_its_default_and_its_texts():
    (gain, pair) = described(AmplifierParams)
    assert tuple(gain) == ("gain", "double", "[1, 3]", "dB", "amplification", 2.0)
    assert (pair.kind, pair.allowed) == ("list of doubles", "2")
    assert AmplifierParams(gain=7.0).gain == 7.0  # the struct refuses it
