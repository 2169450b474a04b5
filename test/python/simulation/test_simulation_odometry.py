# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

from sextant.simulation.motion import FigureEight, Motion
from sextant.simulation.odometry import OdometryNoise, WheelOdometry

RATE = 30.0
EIGHT = FigureEight()


def drive(noise, seed, frames=600):
    wheels = WheelOdometry(noise, seed)
    return [wheels.update(EIGHT.at(k / RATE), 1.0 / RATE) for k in range(frames)]


def error(reading, truth):
    """x, y, yaw of truth minus reading; the truth as it is seen from where the drive started."""
    start = EIGHT.at(0.0)
    T = np.linalg.inv(start.pose) @ truth.pose
    turn = np.arctan2(T[1, 0], T[0, 0]) - reading.motion.yaw
    return np.array(
        [T[0, 3] - reading.motion.x, T[1, 3] - reading.motion.y, np.arctan2(np.sin(turn), np.cos(turn))]
    )


def test_without_noise_odometry_is_the_truth():
    for k, reading in enumerate(drive(OdometryNoise(0.0, 0.0, 0.0), 1)):
        assert error(reading, EIGHT.at(k / RATE)) == pytest.approx(np.zeros(3), abs=1e-3)
        assert reading.motion.speed == pytest.approx(
            EIGHT.at((k - 0.5) / RATE).speed if k else EIGHT.at(0.0).speed, abs=1e-3
        )
        assert not reading.covariance.any()


@pytest.mark.slow
def test_errors_are_as_large_as_odometry_states():
    """NEES of the last pose over 100 drives, in its 99.9 % band."""
    drives, frames = 100, 600
    nees = 0.0
    for seed in range(drives):
        reading = drive(OdometryNoise(), seed, frames)[-1]
        e = error(reading, EIGHT.at((frames - 1) / RATE))
        nees += e @ np.linalg.solve(reading.covariance, e)
    assert 226.0 < nees < 386.0  # 0.05 % and 99.95 % of chi-squared with 300 degrees of freedom


def test_variances_of_speeds_are_true():
    noise = OdometryNoise()
    readings = drive(noise, 3)
    truth = [EIGHT.at((k - 0.5) / RATE) for k in range(600)]
    speed = [(r.motion.speed - t.speed) / np.sqrt(r.speed_variance) for r, t in zip(readings[1:], truth[1:])]
    turn = [
        (r.motion.turn_rate - t.turn_rate) / np.sqrt(r.turn_rate_variance)
        for r, t in zip(readings[1:], truth[1:])
    ]
    assert np.std(speed) == pytest.approx(1.0, abs=0.1) and np.std(turn) == pytest.approx(1.0, abs=0.1)


def test_a_robot_that_stands_does_not_drift():
    wheels = WheelOdometry(OdometryNoise(), 1)
    readings = [wheels.update(Motion(1.0, 2.0, 0.0, 0.5), 0.1) for _ in range(10)]
    assert readings[-1].motion == Motion() and not readings[-1].covariance.any()


def test_drift_follows_its_seed():
    first, same, other = (drive(OdometryNoise(), seed, 50)[-1].motion for seed in (1, 1, 2))
    assert first == same and first != other
