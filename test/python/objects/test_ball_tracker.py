# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

from sextant.objects.ball_tracker import BallTracker, BallTrackerParams
from sextant.simulation.ball_ground import BallGround, Pillar

RATE = 15.0  # images per second
SIGMAS = np.array([0.016, 0.004])  # of an observation at 2 m
COVARIANCE = np.diag(SIGMAS**2)


def seen(position):
    return np.array(position, float), COVARIANCE


def always(_position):
    return True


class Roll:
    """A ball on a floor, observed at times; errors of its estimates."""

    def __init__(self, velocity=(0.0, 0.0), seed=0, pillars=(), **settings):
        self.random = np.random.default_rng([seed, 9])
        self.ground = BallGround((10.0, 10.0), list(pillars), (0.0, 0.0), (-4.0, -4.0, 0.0))
        self.ground.ball_velocity = np.array(velocity, float)
        self.tracker = BallTracker(BallTrackerParams(**settings))
        self.errors, self.nees = [], []

    def observation(self):
        return seen(self.ground.ball + SIGMAS * self.random.standard_normal(2))

    def go(self, seconds, sees=True):
        for _ in range(round(seconds * RATE)):
            self.ground.advance(1.0 / RATE)
            self.tracker.update(
                self.ground.stamp, [self.observation()] if sees else [], lambda position: sees
            )
            estimate = self.tracker.at(self.ground.stamp)
            if estimate is not None:
                error = estimate.position - self.ground.ball
                self.errors.append([*error, *(estimate.velocity - self.ground.ball_velocity)])
                self.nees.append(error @ np.linalg.solve(estimate.covariance[:2, :2], error))
        return self

    @property
    def speed_errors(self):
        return np.linalg.norm(np.array(self.errors)[:, 2:], axis=1)


def test_a_resting_ball_does_not_drift():
    rolls = [Roll(seed=seed).go(6.0) for seed in range(6)]
    late = np.array([roll.errors[45:] for roll in rolls])
    assert np.linalg.norm(late[..., :2], axis=-1).max() < 0.02
    assert np.sqrt((late[..., 2:] ** 2).sum(axis=-1).mean()) < 0.02
    assert 0.3 < np.mean([roll.nees[15:] for roll in rolls]) / 2 < 1.3


def test_a_rolling_ball_is_tracked_until_it_rests():
    rolls = [Roll((speed, 0.1), seed).go(4.0) for seed, speed in enumerate(np.linspace(0.4, 1.0, 6))]
    speeds = np.array([roll.speed_errors[8:] for roll in rolls])
    assert np.sqrt(np.mean(speeds**2)) < 0.06
    assert 0.3 < np.mean([roll.nees[8:] for roll in rolls]) / 2 < 1.3


@pytest.mark.parametrize("seed", range(5))
def test_a_kick_is_tracked_within_a_third_of_a_second(seed):
    roll = Roll(seed=seed).go(3.0)
    roll.ground.ball_velocity = np.array([0.9, -0.2])
    roll.errors.clear()
    roll.go(1.5)
    assert np.median(roll.speed_errors[5:10]) < 0.12  # one observation may update like another hit
    assert roll.speed_errors[10:].max() < 0.15


@pytest.mark.parametrize("seed", range(5))
def test_a_bounce_is_tracked(seed):
    roll = Roll((0.9, 0.0), seed, [Pillar(0.6, 0.01, 0.05, "red_pillar")]).go(1.5)
    assert roll.ground.ball_velocity[0] < 0
    assert roll.speed_errors[-5:].max() < 0.2


@pytest.mark.slow
def test_a_ball_out_of_view_is_kept_with_growing_covariance_up_to_a_minute():
    roll = Roll().go(2.0)
    sure = roll.tracker.at(roll.ground.stamp).covariance
    roll.go(59.0, sees=False)
    estimate = roll.tracker.at(roll.ground.stamp)
    np.testing.assert_allclose(estimate.position, roll.ground.ball, atol=0.02)
    assert estimate.covariance[0, 0] > 3.0 * sure[0, 0]
    assert roll.go(4.0, sees=False).tracker.at(roll.ground.stamp) is None


def test_a_ball_in_view_but_not_detected_is_deleted():
    tracker = BallTracker(BallTrackerParams(max_misses=5))
    for i in range(5):
        tracker.update(0.1 * i, [seen([1.0, 0.0])], always)
    for i in range(5, 9):
        tracker.update(0.1 * i, [], always)
        assert tracker.at(0.1 * i) is not None
    tracker.update(0.9, [], always)
    assert tracker.at(0.9) is None


def test_the_expected_position_is_the_predicted_one():
    tracker, asked = BallTracker(BallTrackerParams()), []
    for i in range(10):
        tracker.update(0.1 * i, [seen([0.06 * i, 0.5])], always)
    tracker.update(1.4, [], asked.append)
    np.testing.assert_allclose(asked, [[0.54 + 0.5 * 0.5, 0.5]], atol=0.15)


def test_of_several_balls_the_nearest_is_associated():
    tracker = BallTracker(BallTrackerParams())
    for i in range(20):
        balls = [seen([3.0, 3.0]), seen([1.0, 0.0])] if i > 3 else [seen([1.0, 0.0])]
        tracker.update(0.1 * i, balls, always)
    np.testing.assert_allclose(tracker.at(1.9).position, [1.0, 0.0], atol=0.01)


def test_a_ball_elsewhere_is_confirmed_after_some_observations():
    tracker = BallTracker(BallTrackerParams(relocate_hits=4, max_misses=100))
    for i in range(10):
        tracker.update(0.1 * i, [seen([1.0, 0.0])], always)
    for i in range(10, 14):
        np.testing.assert_allclose(tracker.at(0.1 * i).position, [1.0, 0.0], atol=0.01)
        tracker.update(0.1 * i, [seen([3.0, 1.0])], always)
    np.testing.assert_allclose(tracker.at(1.3).position, [3.0, 1.0], atol=0.02)


def test_one_observation_confirms_no_ball():
    tracker = BallTracker(BallTrackerParams(confirm_hits=2))
    tracker.update(0.0, [seen([1.0, 0.0])], always)
    assert tracker.at(0.0) is None
    tracker.update(0.1, [seen([2.0, 1.0])], always)
    assert tracker.at(0.1) is None
    tracker.update(0.2, [seen([2.0, 1.0])], always)
    assert tracker.at(0.2) is not None


def test_late_images_give_the_same_estimate_as_images_in_order():
    scans = [(0.1 * i, [seen([0.05 * i, 0.02 * (i % 3)])], always) for i in range(12)]
    in_order, mixed = BallTracker(BallTrackerParams()), BallTracker(BallTrackerParams())
    for scan in scans:
        in_order.update(*scan)
    for i in (0, 1, 2, 4, 3, 5, 8, 6, 7, 9, 11, 10):
        mixed.update(*scans[i])
    for stamp in (1.1, 1.5):
        a, b = in_order.at(stamp), mixed.at(stamp)
        np.testing.assert_allclose(a.position, b.position)
        np.testing.assert_allclose(a.covariance, b.covariance)


def test_an_earlier_stamp_and_clearing():
    tracker = BallTracker(BallTrackerParams())
    for i in range(10):
        tracker.update(0.1 * i, [seen([0.06 * i, 0.0])], always)
    assert tracker.at(0.5).position[0] == pytest.approx(0.3, abs=0.05)
    assert tracker.at(-1.0) is None
    tracker.clear()
    assert tracker.at(1.0) is None


@pytest.mark.parametrize(
    "name, value", [("confirm_hits", 0), ("relocate_hits", 0), ("max_misses", 0), ("max_age", 0.0)]
)
def test_a_parameter_out_of_range_is_named(name, value):
    with pytest.raises(ValueError, match=f"{name}: must be within .*, is {value}"):
        BallTracker(BallTrackerParams(**{name: value}))
