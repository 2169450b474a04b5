# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pure pursuit, driven by a simulated differential drive."""

import numpy as np
import pytest

from sextant.ball.path_follower import (
    HALT,
    FollowerParams,
    bearing_of,
    follow,
    lookahead_point,
    stopping_speed,
    turn_on_the_spot,
)

PARAMS = FollowerParams()
STEP = 0.02  # seconds


def driven(path, pose, seconds=40.0):
    """(n, 5) x, y, heading, speed and turn rate, until the robot is within 2 cm of the end."""
    rows, pose, path = [], np.array(pose, float), np.array(path, float)
    while np.hypot(*(pose[:2] - path[-1])) > 0.02:
        assert len(rows) * STEP < seconds, "it does not come to the end"
        v, w = follow(PARAMS, pose, path)
        rows.append([*pose, v, w])
        middle = pose[2] + 0.5 * w * STEP
        pose = pose + STEP * np.array([v * np.cos(middle), v * np.sin(middle), w])
    return np.array(rows)


def off(path, points):
    """(n,) metres from points to a way."""
    found = []
    for start, end in zip(np.array(path[:-1], float), np.array(path[1:], float)):
        leg = end - start
        share = np.clip((points - start) @ leg / (leg @ leg), 0.0, 1.0)
        found.append(np.linalg.norm(start + share[:, np.newaxis] * leg - points, axis=1))
    return np.min(found, axis=0)


@pytest.mark.parametrize("turn", np.linspace(-3.0, 3.0, 7))
def test_it_stays_on_a_straight_line(turn):
    end = 2.0 * np.array([np.cos(turn), np.sin(turn)])
    rows = driven([[0, 0], end], [0, 0, turn])
    assert off([[0, 0], end], rows[:, :2]).max() < 1e-6
    assert rows[:, 3].max() == pytest.approx(PARAMS.speed)
    assert len(rows) * STEP == pytest.approx(2.0 / 0.4, abs=1.0)  # and it slows down at the end


@pytest.mark.parametrize("aside", [-0.2, 0.1, 0.2])
def test_it_comes_back_to_a_line_as_pure_pursuit_does(aside):
    """Near to the line y'' = -2 y / L^2 - 2 y' / L, which goes like exp(-s / L): after 6 L little is left."""
    rows = driven([[0, 0], [4, 0]], [0.0, aside, 0.0])
    late = rows[rows[:, 0] > 6.0 * PARAMS.lookahead]
    assert abs(late[:, 1]).max() < 0.02 * abs(aside)
    assert np.all(rows[:, 1] * np.sign(aside) > -0.1 * abs(aside))


@pytest.mark.parametrize("angle", [0.5, 1.0, 0.5 * np.pi, 2.2])
@pytest.mark.parametrize("side", [-1, 1])
def test_it_cuts_a_corner_by_less_than_its_lookahead(angle, side):
    path = [[0, 0], [1, 0], [1 + np.cos(angle), side * np.sin(angle)]]
    rows = driven(path, [0, 0, 0])
    assert off(path, rows[:, :2]).max() < 0.5 * PARAMS.lookahead


def test_a_robot_that_looks_away_turns_on_the_spot_the_shorter_way():
    for heading in (1.0, 2.0, 3.0):
        for sign in (1, -1):
            v, w = follow(PARAMS, np.array([0, 0, sign * heading]), np.array([[0, 0], [1, 0]]))
            assert v == 0.0 and sign * w < 0.0


def test_limits_hold_and_it_stops_softly():
    """On random ways; it comes to the end with no more than what it can stop from."""
    random = np.random.default_rng(0)
    for _ in range(10):
        turns = np.cumsum(random.uniform(-1.6, 1.6, 3))
        legs = random.uniform(0.3, 1.0, (3, 1)) * np.stack([np.cos(turns), np.sin(turns)], axis=1)
        path = np.cumsum([[0.0, 0.0], *legs], axis=0)
        rows = driven(path, [*path[0], random.uniform(-3, 3)])
        assert rows[:, 3].max() <= PARAMS.speed + 1e-9 and rows[:, 3].min() >= 0.0
        assert abs(rows[:, 4]).max() <= PARAMS.turn_rate + 1e-9
        assert rows[-1, 3] < 0.1
    for rest in (0.02, 0.1, 0.3):
        assert stopping_speed(PARAMS, rest) ** 2 / (2.0 * PARAMS.acceleration) <= rest
    assert stopping_speed(PARAMS, 0.0) == stopping_speed(PARAMS, -1.0) == PARAMS.min_speed
    assert HALT == (0.0, 0.0)


def test_turning_on_the_spot_ends_at_the_angle():
    for angle in (-3.0, -0.2, 0.7):
        left = angle
        for _ in range(int(6.0 / STEP)):
            rate = turn_on_the_spot(PARAMS, left)
            assert abs(rate) <= PARAMS.turn_rate
            left -= STEP * rate
        assert abs(left) < 1e-3


def test_bearings():
    assert bearing_of(np.array([1.0, 1.0, 0.0]), np.array([1.0, 3.0])) == pytest.approx(0.5 * np.pi)
    assert bearing_of(np.array([0.0, 0.0, 3.0]), np.array([-1.0, -0.1])) == pytest.approx(
        0.0997 + np.pi - 3.0, abs=1e-3
    )
    assert abs(bearing_of(np.array([0.0, 0.0, 20.0]), np.array([1.0, 0.0]))) <= np.pi


def test_the_point_ahead():
    path = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    target, rest = lookahead_point(path, np.array([0.9, -0.1]), 0.3)
    np.testing.assert_allclose(target, [1.0, 0.2])
    assert rest == pytest.approx(1.1)
    target, rest = lookahead_point(path, np.array([3.0, 3.0]), 0.3)
    np.testing.assert_allclose(target, [1.0, 1.0])
    assert rest == pytest.approx(0.0)
    target, rest = lookahead_point(np.array([[2.0, 2.0], [2.0, 2.0]]), np.zeros(2), 0.3)  # a way of no length
    np.testing.assert_allclose(target, [2.0, 2.0])
