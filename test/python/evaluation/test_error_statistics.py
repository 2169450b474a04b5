# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
from dataclasses import replace

import numpy as np
import pytest

from sextant.evaluation.error_statistics import (
    ALL,
    QUANTITIES,
    error_statistics,
    overall,
    position_table,
    share_text,
)
from sextant.evaluation.pose_series import pose_series, series_statistics
from sextant.evaluation.surveyed_points import SurveyedPoint, SurveyedPoints

TRUTH = SurveyedPoints(
    [
        SurveyedPoint("a.bag", {"x": 1.0, "y": 2.0, "z": 0.0, "yaw": np.pi}),
        SurveyedPoint("b.bag", {"x": 0.0, "y": 0.0, "z": 0.0, "yaw": None}),
    ]
)


def of(number, errors, method="joint", images=None):
    """Statistics of a point whose poses have these errors of x, y, z and yaw (N, 4)."""
    truth = np.nan_to_num(TRUTH.at(number))
    errors = np.reshape(errors, (-1, 4))
    poses = truth + np.column_stack([errors[:, :3], np.zeros((len(errors), 2)), errors[:, 3]])
    series = pose_series(number, "a.bag", range(len(errors)), poses, images=images)
    return series_statistics(replace(series, method=method), TRUTH)


def test_known_errors():
    errors = [[0.03, 0.04, 0.0, 0.1], [0.03, 0.04, 0.0, -0.1], [-0.03, -0.04, 0.0, 0.3]]
    first, total = error_statistics([of(1, errors, images=4)])
    assert (first.label, total.label, first.poses, first.images) == ("joint point 1", "joint all", 3, 4)
    x, yaw = QUANTITIES.index("x"), QUANTITIES.index("yaw")
    assert first.mean[[0, x, yaw]] == pytest.approx([0.05, 0.01, 0.1])
    assert first.std[[0, x, yaw]] == pytest.approx([0.0, 0.06 / np.sqrt(3.0), 0.2])
    assert first.p95[[0, x]] == pytest.approx([0.05, 0.03])
    assert first.p95[yaw] == pytest.approx(0.1 + 0.9 * 0.2)  # linear between the second and the third
    assert first.worst[[0, x, yaw]] == pytest.approx([0.05, 0.03, 0.3])
    assert share_text(first) == "3 of 4 (75.0 %)"


def test_all_places_weigh_every_pose_and_methods_are_apart():
    near, far = [[0.01, 0.0, 0.0, 0.0]] * 3, [[0.09, 0.0, 0.0, 0.0]]
    statistics = [of(1, near, images=3), of(2, far, images=5), of(1, far, "nearest"), of(2, [], "nearest")]
    errors = error_statistics(statistics)
    assert [each.place for each in errors] == ["point 1", "point 2", ALL] * 2
    joint, nearest = overall(errors)
    assert joint.mean[0] == pytest.approx(0.03) and joint.share == pytest.approx(0.5)
    assert nearest.mean[0] == pytest.approx(0.09) and nearest.images is None and np.isnan(nearest.share)
    assert np.isnan(errors[4].mean).all() and np.isnan(joint.mean[QUANTITIES.index("yaw")])
    lines = position_table(errors)
    assert lines[1].split()[:5] == ["joint", "point", "1", "1.00", "0.00"]
    assert lines[5].split()[3:] == ["-", "-", "-", "-", "0", "poses"]
