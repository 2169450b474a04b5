# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

from sextant.objects.ball_filter import (
    KICKED,
    RESTING,
    ROLLING,
    BallModes,
    BallMotionParams,
    combined,
    initial_modes,
    predicted,
    predicted_with_transitions,
    squared_distance,
    updated,
)
from sextant.simulation.ball_ground import BallGround

SETTINGS = BallMotionParams()
NOISE = np.diag([0.01, 0.01]) ** 2


def rolling(velocity, sigma=1e-4):
    """All modes roll so."""
    mean = np.array([1.0, 2.0, *velocity])
    return BallModes(
        np.tile(mean, (3, 1)), np.tile(sigma**2 * np.eye(4), (3, 1, 1)), np.array([0.0, 1.0, 0.0])
    )


@pytest.mark.parametrize("seconds", [0.1, 0.5, 1.0, 3.0])
def test_it_rolls_as_the_simulated_ball_does(seconds):
    ground = BallGround((20.0, 20.0), [], (1.0, 2.0), (-5.0, -5.0, 0.0))
    ground.ball_velocity = np.array([0.4, -0.3])
    ground.advance(seconds)
    mean = predicted(rolling([0.4, -0.3]), seconds, SETTINGS).means[ROLLING]
    np.testing.assert_allclose(mean[:2], ground.ball, atol=2e-3)
    np.testing.assert_allclose(mean[2:], ground.ball_velocity, atol=2e-3)


@pytest.mark.parametrize("seconds", [0.2, 1.0, 5.0])
def test_its_covariance_is_that_of_many_balls(seconds):
    random = np.random.default_rng(1)
    sigma, settings = 0.02, BallMotionParams(deceleration_sigma=0.0)
    begun = random.multivariate_normal([1.0, 2.0, 0.5, 0.2], sigma**2 * np.eye(4), 4000)
    ended = []
    for each in begun:
        speed = np.hypot(*each[2:])
        until = min(seconds, speed / settings.deceleration)
        way = speed * until - 0.5 * settings.deceleration * until**2
        ended.append(
            [
                *(each[:2] + way * each[2:] / speed),
                *(each[2:] * (1.0 - settings.deceleration * until / speed)),
            ]
        )
    computed = predicted(rolling([0.5, 0.2], sigma), seconds, settings).covariances[ROLLING]
    np.testing.assert_allclose(computed, np.cov(np.array(ended).T), atol=0.12 * computed.max())


def test_what_lies_stays_and_becomes_a_little_less_sure():
    modes = initial_modes(np.array([1.0, 2.0]), NOISE, SETTINGS)
    later = predicted(modes, 60.0, SETTINGS)
    np.testing.assert_array_equal(later.means[RESTING], [1.0, 2.0, 0.0, 0.0])
    assert later.covariances[RESTING, 0, 0] == pytest.approx(NOISE[0, 0] + 60.0 * SETTINGS.drift_sigma**2)
    np.testing.assert_array_equal(predicted(modes, 0.0, SETTINGS).covariances, modes.covariances)


def test_probabilities_follow_what_is_seen():
    modes = initial_modes(np.zeros(2), NOISE, SETTINGS)
    for _ in range(30):
        modes = updated(predicted_with_transitions(modes, 0.1, SETTINGS), np.zeros(2), NOISE)
    assert modes.probabilities[RESTING] > 0.95
    for i in range(1, 6):
        modes = updated(predicted_with_transitions(modes, 0.1, SETTINGS), np.array([0.06 * i, 0.0]), NOISE)
        assert modes.probabilities.sum() == pytest.approx(1.0)
    assert modes.probabilities[ROLLING] + modes.probabilities[KICKED] > 0.95
    mean, covariance = combined(modes)
    assert mean[2] == pytest.approx(0.6, abs=0.1)
    assert np.all(np.linalg.eigvalsh(covariance) > 0)


def test_a_far_observation_is_far_in_every_mode():
    modes = predicted_with_transitions(initial_modes(np.zeros(2), NOISE, SETTINGS), 0.1, SETTINGS)
    assert squared_distance(modes, np.array([0.01, 0.0]), NOISE) < 1.0
    assert squared_distance(modes, np.array([2.0, 0.0]), NOISE) > 100.0


@pytest.mark.parametrize(
    "name, value",
    [("deceleration", 0.0), ("kick_sigma", 0.0), ("drift_sigma", -1.0), ("deceleration_sigma", 11)],
)
def test_a_setting_out_of_range_is_named(name, value):
    with pytest.raises(ValueError, match=f"{name}: must be within .*, is {value}"):
        BallMotionParams(**{name: value})
