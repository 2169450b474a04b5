# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The texts that arguments of launch files take over from the parameters that they set."""

import sys
from pathlib import Path

import pytest

from sextant.base.strict_params import Described

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))
import launch_docs  # noqa: E402
from parameter_tables import plain  # noqa: E402

FILE = """<launch>
  <!-- a > b, "quoted" -->
  <arg name="range" default="" doc="1"/>
  <arg name="map" default="" doc="2"/>
  <arg name="both"  default="" doc="3"/>
  <arg name="fixed" default="2.5"
       doc="4"/>
  <arg name="scale" default="" doc="5"/>
  <arg name="parts" default="" doc="6"/>
  <arg name="mode" default="joint" doc="7"/>
  <node pkg="sextant" type="landmark_simulator" name="world">
    <rosparam>{scale: 1.25}</rosparam>
    <rosparam if="$(arg both)">{landmarks: 7}</rosparam>
    <param if="$(eval arg('range') != '')" name="sensor_rate" value="$(arg range)"/>
    <param name="odometry_rate" value="$(arg fixed)"/>
    <param if="$(eval arg('both') != '')" name="delay" value="$(arg both)"/>
    <param if="$(eval arg('scale') != '')" name="scale" value="$(arg scale)"/>
    <param if="$(eval arg('parts') != '')" name="landmarks" value="$(arg parts)"/>
  </node>
  <include file="$(find sextant)/launch/landmarks.launch">
    <arg name="map_file" value="$(arg map)"/>
    <arg name="tf_output" value="$(eval arg('mode'))"/>
  </include>
</launch>
"""
MAP_FILE = "landmark map file: read at start-up if it exists, written by landmark_slam/save_map"


def described(kind="double", allowed="", unit="", what="gain"):
    return Described("gain", kind, allowed, unit, what, 1.0)


@pytest.mark.parametrize(
    "row, text",
    [
        (described(), "gain"),
        (described(unit="m"), "gain, m"),
        (described(unit="m", what="gain; 0: none"), "gain, m; 0: none"),
        (described(unit="m", what="gain after 1 m"), "gain after 1 m, m"),
        (described(unit="bits", what="gained bits"), "gained bits"),
        (described(what="[gains](x.md#a) of `~reset`, `~/.ros` …"), "gains of front/reset, ~/.ros ..."),
        (described(what='by `"ID"`'), "by 'ID'"),
        (described("string", "high, low"), "gain: high or low"),
        (described("string", "high, low, off", what="gain; off: none"), "gain: high, low or off; off: none"),
        (described("string", "high, low", what="A: gain"), "A: gain; values: high or low"),
        (described("string", "high, low", what="`high`: good; `low`: bad"), "high: good; low: bad"),
        (described("string", "not empty"), "gain"),
        (described("list of doubles", "[0, 1]", "m"), "gain, m, as a YAML list"),
    ],
)
def test_plain_text_of_a_parameter(row, text):
    assert plain(row, "front") == text


def test_only_the_texts_of_arguments_that_set_one_parameter_change(tmp_path):
    path = tmp_path / "some.launch"
    path.write_text(FILE)
    expected = FILE
    for old, new in (
        ('doc="1"', 'doc="rate of observations, Hz; empty: 5.0"'),
        ('doc="2"', f'doc="{MAP_FILE}"'),
        ('doc="4"', 'doc="rate of odometry, Hz"'),
        ('doc="5"', 'doc="ratio of the distance that odometry measures to the true distance; empty: 1.25"'),
    ):
        expected = expected.replace(old, new)
    assert launch_docs.with_texts(path) == expected
