# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

from sextant.nodes.objects.pose_trail import PoseTrail

SECOND = 10**9


def at(x):
    T = np.eye(4)
    T[0, 3] = x
    return T


def ready(trail):
    return [(stamp, thing, T[0, 3]) for stamp, thing, T in trail.ready()]


def test_what_was_seen_between_two_poses_waits_for_the_second():
    trail = PoseTrail(3)
    trail.wait(SECOND + SECOND // 10, "seen")
    assert trail.newest is None and ready(trail) == []
    assert trail.add(SECOND, at(0.0))
    assert ready(trail) == []
    assert trail.add(SECOND + SECOND // 5, at(1.0))
    assert ready(trail) == [(SECOND + SECOND // 10, "seen", pytest.approx(0.5))]
    assert ready(trail) == [] and trail.forgotten == 0


def test_what_is_older_than_all_poses_is_forgotten():
    trail = PoseTrail(3)
    trail.add(5 * SECOND, at(0.0))
    trail.wait(4 * SECOND, "early")
    assert ready(trail) == [] and trail.forgotten == 1


def test_of_too_much_that_waits_the_oldest_is_forgotten():
    trail = PoseTrail(2)
    for second in (1, 2, 3):
        trail.wait(second * SECOND, second)
    for second in range(1, 4):
        trail.add(second * SECOND, at(second))
    assert ready(trail) == [(2 * SECOND, 2, 2.0), (3 * SECOND, 3, 3.0)] and trail.forgotten == 1


def test_a_pose_that_is_no_newer_is_not_kept():
    trail = PoseTrail(2)
    trail.add(SECOND, at(1.0))
    assert not trail.add(SECOND, at(2.0)) and not trail.add(SECOND // 2, at(3.0))
    stamp, T = trail.newest
    assert (stamp, T[0, 3]) == (SECOND, 1.0)


def test_a_clock_that_was_set_back_is_told_from_a_pose_that_comes_late():
    trail = PoseTrail(2)
    assert not trail.is_set_back(0)
    trail.add(10 * SECOND, at(1.0))
    assert trail.is_set_back(8 * SECOND) and not trail.is_set_back(95 * SECOND // 10)
    trail.wait(11 * SECOND, "seen")
    trail.clear()
    assert trail.newest is None and trail.add(11 * SECOND, at(0.0)) and ready(trail) == []
