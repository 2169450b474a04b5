# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

from sextant.nodes.objects.pose_buffer import PoseBuffer

SECOND = 10**9


def at(x):
    T = np.eye(4)
    T[0, 3] = x
    return T


def ready(buffer):
    return [(stamp, thing, T[0, 3]) for stamp, thing, T in buffer.ready()]


def test_what_was_seen_between_two_poses_waits_for_the_second():
    buffer = PoseBuffer(3)
    buffer.add_item(SECOND + SECOND // 10, "seen")
    assert buffer.newest is None and ready(buffer) == []
    assert buffer.add(SECOND, at(0.0))
    assert ready(buffer) == []
    assert buffer.add(SECOND + SECOND // 5, at(1.0))
    assert ready(buffer) == [(SECOND + SECOND // 10, "seen", pytest.approx(0.5))]
    assert ready(buffer) == [] and buffer.dropped == 0


def test_what_is_older_than_all_poses_is_forgotten():
    buffer = PoseBuffer(3)
    buffer.add(5 * SECOND, at(0.0))
    buffer.add_item(4 * SECOND, "early")
    assert ready(buffer) == [] and buffer.dropped == 1


def test_of_too_much_that_waits_the_oldest_is_forgotten():
    buffer = PoseBuffer(2)
    for second in (1, 2, 3):
        buffer.add_item(second * SECOND, second)
    for second in range(1, 4):
        buffer.add(second * SECOND, at(second))
    assert ready(buffer) == [(2 * SECOND, 2, 2.0), (3 * SECOND, 3, 3.0)] and buffer.dropped == 1


def test_a_pose_that_is_no_newer_is_not_kept():
    buffer = PoseBuffer(2)
    buffer.add(SECOND, at(1.0))
    assert not buffer.add(SECOND, at(2.0)) and not buffer.add(SECOND // 2, at(3.0))
    stamp, T = buffer.newest
    assert (stamp, T[0, 3]) == (SECOND, 1.0)


def test_a_clock_that_was_set_back_differs_from_a_pose_that_comes_late():
    buffer = PoseBuffer(2)
    assert not buffer.jumps_back(0)
    buffer.add(10 * SECOND, at(1.0))
    assert buffer.jumps_back(8 * SECOND) and not buffer.jumps_back(95 * SECOND // 10)
    buffer.add_item(11 * SECOND, "seen")
    buffer.clear()
    assert buffer.newest is None and buffer.add(11 * SECOND, at(0.0)) and ready(buffer) == []
