# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import cv2
import numpy as np
import pytest

from sextant.evaluation.trajectory import error_table, summarize, trajectory_errors


def pose(x=0.0, y=0.0, z=0.0, rotvec=(0.0, 0.0, 0.0)):
    T = np.eye(4)
    T[:3, :3] = cv2.Rodrigues(np.array(rotvec, dtype=float))[0]
    T[:3, 3] = x, y, z
    return T


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-3, 1.0, np.pi - 1e-6])
def test_angle(angle):
    axis = np.array([1.0, -2.0, 2.0]) / 3.0
    truth = pose(rotvec=(0.1, 0.2, 0.3))
    errors = trajectory_errors({0: truth}, {0: truth @ pose(rotvec=angle * axis)})
    assert errors.angle[0] == pytest.approx(angle, abs=1e-12)


def test_errors_do_not_depend_on_where_the_robot_is():
    truth = {1: pose(5.0, -3.0, 1.0, (0.3, -0.8, 2.0)), 2: pose(), 3: pose(1.0)}
    offset = pose(0.03, 0.0, 0.04, (0.0, 0.0, -0.1))
    errors = trajectory_errors(truth, {2: truth[2] @ offset, 1: truth[1] @ offset})
    assert errors.stamps.tolist() == [1, 2]
    assert errors.position == pytest.approx([0.05, 0.05])
    assert errors.angle == pytest.approx([0.1, 0.1])
    assert errors.frames == 3


def test_a_pose_without_truth_is_refused():
    with pytest.raises(ValueError, match="1 poses without ground truth, the first at 7 ns"):
        trajectory_errors({1: pose()}, {1: pose(), 7: pose()})


def test_summary_of_known_numbers():
    summary = summarize(np.arange(101.0))
    assert (summary.mean, summary.p95, summary.worst) == (50.0, 95.0, 100.0)


def test_table():
    truth = {stamp: pose() for stamp in range(4)}
    series = {"joint": {0: pose(0.01), 1: pose(0.03, rotvec=(0, np.pi / 2, 0))}, "none": {}}
    table = error_table({name: trajectory_errors(truth, estimate) for name, estimate in series.items()})
    assert table.splitlines() == [
        "        position error, cm         angle error, degrees       frames",
        "         mean    95 %    worst      mean    95 %    worst   with a pose",
        "joint    2.00    2.90     3.00     45.00   85.50    90.00   2 of 4",
        "none      nan     nan      nan       nan     nan      nan   0 of 4",
    ]
