# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import re
from pathlib import Path

from sextant.landmarks.landmark_colours import NAMED

ROOT = Path(__file__).resolve().parents[3]


def test_the_colours_are_those_in_rviz():
    source = (ROOT / "src/ros/landmarks/landmark_visualization.cpp").read_text()
    found = re.findall(r'\{"(\w+)", colour\(([\d.f, ]+)\)\}', source)
    assert {
        name: tuple(float(value.strip("f ")) for value in values.split(",")) for name, values in found
    } == NAMED
