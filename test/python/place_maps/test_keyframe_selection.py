# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which views of a drive are picked."""

import numpy as np
import pytest

import sextant
from sextant.place_maps.keyframe_selection import MAX_CANDIDATES, keyframe_candidates, view_yaw
from sextant.simulation.camera import camera_mount

AHEAD = camera_mount([0.0, 0.0, 1.0], [0.0, 0.0, 0.0])


def looking(x=0.0, yaw=0.0, pitch=0.0):
    """T_map_camera of one that looks along yaw, down by pitch."""
    return sextant.pose_from_xyz_rpy([x, 0.0, 0.0], [0.0, pitch, yaw]) @ AHEAD


def test_a_view_is_due_after_a_distance():
    picks = keyframe_candidates([looking(x) for x in np.arange(0, 3.05, 0.25)], 1.0, 1.0)
    assert [pick[0] for pick in picks] == [0, 4, 8, 12]


def test_a_view_is_due_after_a_turn():
    picks = keyframe_candidates(
        [looking(0.0, yaw) for yaw in np.radians(np.arange(0, 361, 10))], 1.0, np.radians(29.9)
    )
    assert [pick[0] for pick in picks] == list(range(0, 37, 3))


def test_a_robot_that_stands_still_is_due_once():
    picks = keyframe_candidates([looking()] * 1000, 1.0, 1.0)
    assert picks == [list(range(MAX_CANDIDATES))]


def test_candidates_are_almost_alike():
    picks = keyframe_candidates([looking(x) for x in (0, 0.05, 0.09, 0.15, 0.99, 1.01, 1.1, 1.12)], 1.0, 1.0)
    assert picks == [[0, 1, 2], [5, 6]]


def test_no_poses_no_views():
    assert keyframe_candidates([], 1.0, 1.0) == []


@pytest.mark.parametrize("yaw", [-3.0, -0.5, 0.0, 2.0])
@pytest.mark.parametrize("pitch", [-0.9, 0.0, 0.9])
def test_the_yaw_is_that_of_what_lies_ahead(yaw, pitch):
    assert view_yaw(looking(1.0, yaw, pitch)) == pytest.approx(yaw)


@pytest.mark.parametrize("pitch", [-1.5, 1.2])
def test_up_and_down_have_no_yaw(pitch):
    assert view_yaw(looking(0.0, 1.0, pitch)) is None
