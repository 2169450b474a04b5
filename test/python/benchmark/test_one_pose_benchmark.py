# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How the benchmark of the one pose judges rounds that are made for it, and a quick run."""

import numpy as np
import pytest
from one_pose.failures import THREE_SIGMA
from one_pose.failures import judged as judged_failure
from one_pose.kidnappings import judged
from one_pose.rounds import Look
from quick_run import topics_of

SURE, UNSURE = 0.01 * np.eye(3), 4.0 * np.eye(3)


def look(second, pose, covariance=SURE, truth=(10.0, 0.0, 0.0), kidnapped=False, odometry=(0.0, 0.0, 0.0)):
    estimate = (None, None) if pose is None else (np.array(pose, dtype=float), covariance)
    return Look(float(second), kidnapped, np.array(truth), np.array(odometry), *estimate)


TRUE, FAR = (10.1, 0.0, 0.0), (30.0, 0.0, 0.0)


@pytest.mark.parametrize(
    "poses, after, is_wrong",
    [
        ([TRUE] * 9, 0, False),
        ([None] * 4 + [TRUE] * 6, 4, False),
        ([None] * 9, None, False),
        ([None] * 2 + [TRUE] + [None] * 2 + [TRUE] * 5, 5, False),  # one second is not enough
        ([None] + [FAR] * 8, None, True),
        ([None] + [FAR] * 4 + [TRUE] * 5, 5, False),  # not for long
        ([TRUE] * 4 + [FAR] * 8, 0, True),
    ],
)
def test_the_outcome_of_a_start(poses, after, is_wrong):
    (outcome,) = judged([look(second, pose) for second, pose in enumerate(poses)]).kidnappings
    assert outcome == (after, is_wrong)


def test_a_robot_that_is_not_sure_is_neither_right_nor_wrong():
    for pose in (TRUE, FAR):
        (outcome,) = judged([look(second, pose, UNSURE) for second in range(20)]).kidnappings
        assert outcome == (None, False)


def test_a_robot_that_has_not_noticed_is_not_at_a_wrong_place():
    before = [look(second, TRUE) for second in range(5)]
    truth = (30.0, 0.0, 0.0)
    unaware = [look(5 + second, TRUE, truth=truth, kidnapped=second == 0) for second in range(20)]
    moved = [look(5 + second, (20.0, 5.0, 0.0), truth=truth, kidnapped=second == 0) for second in range(20)]
    assert [each.is_wrong for each in judged(before + unaware).kidnappings] == [False, False]
    assert [each.is_wrong for each in judged(before + moved).kidnappings] == [False, True]


def test_nees_is_over_three_from_when_the_pose_is_right():
    off = (10.2, 0.1, 0.0)
    found = judged([look(second, None if second < 3 else off) for second in range(10)])
    assert found.nees == pytest.approx([(0.04 + 0.01) / 0.01 / 3] * 7)
    assert np.isinf(found.distances[:3]).all() and found.distances[3:] == pytest.approx(np.hypot(0.2, 0.1))


@pytest.mark.slow
def test_quick_run():
    topics = topics_of("one_pose.py", "--only", "kidnappings,failures,maps")
    (table,) = topics["kidnappings"]
    one, *_ = table["rows"]
    assert one["kidnappings"]["value"] == 4 and one["relocalized, %"]["value"] >= 50
    assert one["at a wrong place"]["value"] == 0
    for row in topics["failures"][0]["rows"]:
        assert row["within 3 sigma, %"]["value"] > 30
    (maps,) = topics["maps"][0]["rows"]
    assert maps["landmarks in the map"]["value"] >= 3 and maps["pillars, m"]["value"] < 0.5
    assert maps["photos, m"]["value"] < 0.5


@pytest.mark.slow
def test_quick_run_of_the_nodes():
    *nodes, total = topics_of("one_pose.py", "--only", "cost")["cost"][0]["rows"]
    assert {"landmark_slam", "place_localizer", "sextant_manager"} <= {each["name"] for each in nodes}
    assert 0.03 < total["cores (median)"]["value"] < 8 and total["memory, MB"]["value"] > 100
    assert total["images/s"]["value"] > 1


def test_the_outcome_of_a_failure():
    within, off = 10.0 + 0.1 * np.sqrt(THREE_SIGMA) * np.array([0.99, 1.01])
    some = [look(second, (within, 0.0, 0.0)) for second in range(6)]
    rest = [look(6, (off, 0.0, 0.0)), look(7, None), look(8, TRUE), look(9, TRUE)]
    named = [each._replace(problems=["it is black"]) for each in rest]
    assert judged_failure(some + rest, 1.0, "black") == (0.8, 0.1, None, False)
    assert judged_failure(some + named, 1.0, "black") == (0.8, 0.1, 5.0, False)
    assert judged_failure(some + named, 1.0, "white") == (0.8, 0.1, None, True)
