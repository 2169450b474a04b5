# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The parameters of landmark SLAM offline are those of the nodelet."""

import dataclasses
import re
from operator import attrgetter
from pathlib import Path

import pytest

from sextant.landmarks.landmark_colours import NAMED
from sextant.landmarks.slam_params import (
    CORE_FIELDS,
    NAMES,
    LandmarkSlamSettings,
    NodeletParams,
    read_settings,
    settings_of,
)

ROOT = Path(__file__).resolve().parents[3]


def test_the_names_are_those_that_the_nodelet_reads():
    source = (ROOT / "src/ros/landmarks/landmark_slam_params.cpp").read_text()
    read = re.findall(r'reader\.read\("(\w+)", params\.([\w.]+)\)', source)
    assert sorted(name for name, _ in read) == sorted(NAMES)
    assert {name: path for name, path in read if "." in path} == CORE_FIELDS


def test_the_defaults_are_the_nodelets():
    header = (ROOT / "include/sextant/ros/landmarks/landmark_slam_params.hpp").read_text()
    for field in dataclasses.fields(NodeletParams):
        default = getattr(NodeletParams(), field.name)
        told = re.search(rf" {field.name}(?: = ([^;]+))?;", header)
        text = str(default).replace("[", "{").replace("]", "}") if isinstance(default, list) else str(default)
        assert told and (told[1] or "").strip('"') == ("" if default == [] else text)


def test_the_colours_are_those_in_rviz():
    source = (ROOT / "src/ros/landmarks/landmark_visualization.cpp").read_text()
    found = re.findall(r'\{"(\w+)", colour\(([\d.f, ]+)\)\}', source)
    assert {
        name: tuple(float(value.strip("f ")) for value in values.split(",")) for name, values in found
    } == NAMED


OTHER = {
    bool: lambda value: not value,
    int: lambda value: value + 1,
    float: lambda value: 0.99 * value or 0.5,
}


def test_every_parameter_arrives_where_it_belongs():
    for name, path in CORE_FIELDS.items():
        default = attrgetter(path)(LandmarkSlamSettings())
        value = 0.9999 if name == "doubt" else OTHER[type(default)](default)
        assert value != default
        assert attrgetter(path)(settings_of({name: value}, "here")) == value


@pytest.mark.parametrize(
    "text, reason",
    [
        ("gat: 0.9", "gat: unknown parameter; did you mean gate?"),
        ("gate: 2", "gate is 2, allowed is [0.5, 1]"),
        ("gate: wide", "gate: must be a finite number, is 'wide'"),
        ("effort: 1000.5", "effort: must be a whole number, is 1000.5"),
        ("read_only: 1", "read_only: must be true or false, is 1"),
        ("start_pose: [1, 2]", "start_pose: must be x, y (m) and heading (rad), is [1, 2]"),
        ("pose_sigma: [0, 1, 1]", "pose_sigma: must be three deviations"),
        ("cameras: [a, a]", "cameras: must be topics, none of them twice"),
        ("start: here", "start: must be one of origin, map, unknown, is 'here'"),
        ("lag: 0", "lag is 0"),
        ("gate", "write `name: value`"),
        ("gate: [", "is no YAML"),
    ],
)
def test_a_file_with_a_mistake_is_refused(tmp_path, text, reason):
    path = tmp_path / "params.yaml"
    path.write_text("max_range: 4.0\n" + text if ":" in text else text)
    with pytest.raises(ValueError) as error:
        read_settings(path)
    assert str(error.value).startswith(f"{path}: ") and reason in str(error.value)


def test_a_file_may_be_empty(tmp_path):
    (tmp_path / "params.yaml").write_text("# nothing\n")
    assert read_settings(tmp_path / "params.yaml").told == ()
