# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses in the plane against complex numbers: a heading is a factor, a place a summand."""

import numpy as np
import pytest

from sextant.geometry.plane_poses import composed, in_frame, relative, rotation

POSES = np.random.default_rng(3).uniform(-3.0, 3.0, (20, 2, 3))


def as_complex(pose):
    return complex(*pose[:2]), np.exp(1j * pose[2])


@pytest.mark.parametrize("pose, step", POSES)
def test_a_step_after_a_pose(pose, step):
    (place, turn), (off, more) = as_complex(pose), as_complex(step)
    found = composed(pose, step)
    assert complex(*found[:2]) == pytest.approx(place + turn * off)
    assert np.exp(1j * found[2]) == pytest.approx(turn * more)
    assert -np.pi <= found[2] < np.pi


@pytest.mark.parametrize("pose, step", POSES)
def test_the_step_between_two_poses_leads_from_one_to_the_other(pose, step):
    back = relative(pose, composed(pose, step))
    np.testing.assert_allclose(back[:2], step[:2], atol=1e-12)
    assert np.exp(1j * back[2]) == pytest.approx(np.exp(1j * step[2]))


def test_points_in_the_frame_of_a_pose():
    pose, points = np.array([1.0, 2.0, np.pi / 2.0]), np.array([[1.0, 3.0], [0.0, 2.0]])
    np.testing.assert_allclose(in_frame(pose, points), [[1.0, 0.0], [0.0, 1.0]], atol=1e-12)


def test_a_quarter_turn_to_the_left():
    np.testing.assert_allclose(rotation(np.pi / 2.0) @ [1.0, 0.0], [0.0, 1.0], atol=1e-12)
