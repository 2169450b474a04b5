# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The examples of the page on landmarks are valid."""

import io
import re
from pathlib import Path

import numpy as np
import pytest
import rospy

import sextant

ROOT = Path(__file__).resolve().parents[3]
PAGE = (ROOT / "doc/how_to/landmarks.md").read_text()


def code(language):
    return re.findall(rf"^```{language}\n(.*?)^```", PAGE, re.M | re.S)


class Publisher:
    messages = []

    def __init__(self, topic, kind, queue_size):
        assert (topic, kind.__name__) == ("/detector/landmarks", "LandmarkObservations") and queue_size > 0

    def publish(self, message):
        message.serialize(io.BytesIO())  # raises for values of a wrong type
        self.messages.append(message)


def test_a_detector_publishes_observations(monkeypatch):
    monkeypatch.setattr(rospy, "init_node", lambda name: None)
    monkeypatch.setattr(rospy, "Publisher", Publisher)
    names = {}
    exec(code("python")[0], names)
    names["publish"](rospy.Time(3), [("door", 2.0, -1.0, 0.1)])
    names["publish"](rospy.Time(4), [])
    first, second = Publisher.messages
    assert (first.header.frame_id, second.observations) == ("base_link", [])
    (seen,) = first.observations
    assert (seen.class_name, seen.id, seen.x, seen.y) == ("door", -1, 2.0, -1.0) and np.isnan(seen.heading)
    np.testing.assert_allclose(np.reshape(seen.covariance, (3, 3))[:2, :2], 0.01 * np.eye(2))


def test_the_example_of_a_map_is_read(tmp_path):
    path = tmp_path / "map.yaml"
    path.write_text(code("yaml")[0])
    found = sextant.read_landmark_map(str(path))
    assert [each.class_name for each in found.labels] == ["blue_pillar", "tag36h11"]
    assert [each.heading for each in found.landmarks] == [None, 3.14]
    np.testing.assert_allclose(found.covariance.diagonal(), [0.01, 0.01, 0.001] + [0.02] * 4 + [0.01])
    path.write_text(code("yaml")[0].replace("[1.5, 0.25, 0.1]", "[1.5, 0.25]"))
    with pytest.raises(RuntimeError, match="map.yaml:2"):
        sextant.read_landmark_map(str(path))


def test_rows_of_diagnostics_are_those_of_the_report():
    report = (ROOT / "src/ros/landmarks/landmark_slam_report.cpp").read_text()
    section = PAGE.partition("## Diagnostics")[2].partition("\n## ")[0]
    cells = re.findall(r"^\| (`.*?) \|", section, re.M)[1:]  # the first one is composed at run time
    parts = [part.strip() for name in re.findall(r"`([^`]+)`", " ".join(cells)) for part in name.split("…")]
    others = ("src/ros/base/trouble_log.cpp", "src/landmarks/source_monitor.cpp")
    texts = report + "".join((ROOT / path).read_text() for path in others)
    assert len(parts) > 12 and [part for part in parts if part not in texts] == []
