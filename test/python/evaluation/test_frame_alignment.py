# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Trajectories that are moved by a known transform, with noise and wrong poses."""

import numpy as np
import pytest

import sextant
from sextant.evaluation.frame_alignment import frame_alignment
from sextant.geometry.plane_poses import composed
from sextant.simulation.motion import FigureEight

T = np.array([12.0, -7.0, 2.1])
SIGMA = 0.05  # metres, of a map for some seconds
THREE_SIGMA = 14.16  # of chi squared with three degrees of freedom: 99.73 %
EIGHT = FigureEight(half_length=6.0, half_width=3.0, period=60.0)


def eight(seconds):
    motion = EIGHT.at(seconds)
    return np.array([motion.x, motion.y, motion.yaw])


def corridor(seconds):
    """Straight, there and back."""
    return np.array([10.0 * np.sin(0.05 * seconds), 2.0, 0.0])


def space(pose):
    return sextant.pose_from_xyz_rpy([pose[0], pose[1], 0.0], [0.0, 0.0, pose[2]])


def drives(path, seconds=60.0, seed=0, sigma=SIGMA, wrong=0.0, lag=0.0, every=1):
    """In the frame to which T moves, and in the other one, with errors that hold for five seconds.

    :param wrong: share of the poses of the other one that are anywhere
    :param lag: seconds between their stamps
    """
    rng = np.random.default_rng(seed)
    to, of, error = {}, {}, np.zeros(2)
    for number in range(int(10 * seconds)):
        at = number / 10
        to[round(1e9 * at)] = space(composed(T, path(at)))
        if number % 50 == 0:
            error = sigma * rng.standard_normal(2)
        here = path(at + lag)
        here[:2] += error
        if rng.random() < wrong:
            here[:2] = rng.uniform(-10, 10, 2)
        if number % every == 0:
            of[round(1e9 * (at + lag))] = space(here)
    return to, of


@pytest.mark.parametrize("path", [eight, corridor])
def test_the_transform_between_two_drives(path):
    for seed in range(3):
        found = frame_alignment(*drives(path, seed=seed))
        error = found.T_to_from - T
        assert np.hypot(*error[:2]) < 0.06 and abs(error[2]) < 0.006 and np.mean(found.used) > 0.9
        assert 0.5 * SIGMA < found.rms < 2.0 * SIGMA


@pytest.mark.slow
def test_the_covariance_fits():
    squared = []
    for seed in range(30):
        found = frame_alignment(*drives(eight, seconds=120.0, seed=seed, every=10))
        error = found.T_to_from - T
        squared.append(error @ np.linalg.solve(found.covariance, error))
    assert np.mean(np.array(squared) < THREE_SIGMA) > 0.9
    assert 1.0 < np.median(squared) < 5.0  # 2.37 with a known covariance


def test_a_third_of_wrong_poses_changes_nothing():
    plain, found = (frame_alignment(*drives(eight, wrong=share)) for share in (0.0, 0.33))
    np.testing.assert_allclose(found.T_to_from, plain.T_to_from, atol=0.08)
    assert np.mean(found.used) == pytest.approx(0.67, abs=0.05)
    assert np.max(found.distances[found.used]) < 0.3


def test_stamps_need_not_be_equal():
    """The sparser trajectory may be either."""
    to, of = drives(eight, sigma=0.0, lag=0.033, every=7)
    there, back = frame_alignment(to, of), frame_alignment(of, to)
    np.testing.assert_allclose(there.T_to_from, T, atol=1e-3)
    np.testing.assert_allclose(composed(there.T_to_from, back.T_to_from), 0.0, atol=1e-3)
    assert len(there.stamps) == len(back.stamps) == len(of)


def turned(trajectory, angle):
    return {stamp: pose @ space([0.0, 0.0, angle]) for stamp, pose in trajectory.items()}


def test_what_does_not_determine_a_transform_is_refused():
    with pytest.raises(ValueError, match="there are 0 poses in both"):
        frame_alignment({}, drives(eight)[1])
    with pytest.raises(ValueError, match="too short: there are poses in both in 2 periods"):
        frame_alignment(*drives(eight, seconds=20.0))
    with pytest.raises(ValueError, match=r"within 0\.00 m .* drive farther"):
        frame_alignment(*drives(lambda seconds: np.zeros(3)))
    with pytest.raises(ValueError, match="contradict one another"):
        frame_alignment(*drives(eight, wrong=1.0))
    to, of = drives(eight)
    with pytest.raises(ValueError, match="headings differ by 90 degrees"):
        frame_alignment(to, turned(of, 0.5 * np.pi))
    with pytest.raises(ValueError, match="does not determine the transform"):
        frame_alignment(*drives(lambda seconds: 0.3 * eight(seconds), sigma=0.6))
