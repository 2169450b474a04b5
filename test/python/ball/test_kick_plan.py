# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Kicks: how fast, from where and whereto, in closed form and on the simulated floor."""

import numpy as np
import pytest

from sextant.ball.floor_grid import FloorGrid, FloorGridParams
from sextant.ball.goal import goal_between
from sextant.ball.kick_plan import Kick, KickParams, KickPlanner, angular_tolerance, straight_ahead
from sextant.ball.path_planner import Costmap, Disc
from sextant.simulation.ball_ground import BallGround, RobotParams
from sextant.simulation.odometry import OdometryNoise

PARAMS = KickParams()
POSTS = [Disc(0.0, -0.5, 0.05), Disc(0.0, 0.5, 0.05)]
HALF_GOAL = 0.5
EXACT = RobotParams(slip=0.0, noise=OdometryNoise(0.0, 0.0, 0.0))


def goal_before(ball):
    return goal_between(np.array(POSTS[0][:2]), np.array(POSTS[1][:2]), np.asarray(ball))


def planned(ball, others=(), robot=(2.5, 0.5), previous=None, seen=(-5.0, 5.0)):
    """The kick, among pillars, on a floor that is seen. :param seen: from and to which y"""
    ball, robot = np.array(ball, float), np.array(robot, float)
    grid = FloorGrid(FloorGridParams(half_side=5.0))
    y = grid.centers(np.stack([np.arange(200)] * 2, axis=1))[:, 1]
    grid.seen[:, (y > seen[0]) & (y < seen[1])] = True
    discs = [*POSTS, *others]
    about = np.array([robot, ball, [-1.0, -1.5], [2.5, 1.5]])
    free = Costmap(grid, discs, 0.237, about)
    costs, _ = Costmap(grid, [*discs, Disc(*ball, PARAMS.ball_radius)], 0.237, about).costs(robot)
    return KickPlanner(PARAMS, goal_before([1.0, 0.0]), discs, free, costs).plan(ball, previous)


def test_a_ball_that_is_kicked_so_fast_rolls_so_far():
    """v^2 = 2 a s of the ball, which leaves with 1 + bounce times the robot's speed."""
    for way in (0.3, 0.8, 1.4):
        speed = PARAMS.speed(way, 1.0)
        assert ((1.0 + PARAMS.ball_restitution) * speed) ** 2 == pytest.approx(
            2.0 * PARAMS.ball_deceleration * way
        )
        assert PARAMS.speed(way, 0.9) == pytest.approx(0.9 * speed)
    assert PARAMS.speed(100.0, 1.0) == PARAMS.max_kick_speed
    assert PARAMS.speed(0.0, 1.0) == PARAMS.min_kick_speed


@pytest.mark.parametrize("way", [0.5, 1.0, 1.4])
def test_a_ball_rolls_as_far_on_the_simulated_floor(way):
    speed = PARAMS.speed(way, 1.0)
    ground = BallGround((20.0, 20.0), [], (0.0, 0.0), (-1.0, 0.0, 0.0), drive=EXACT)
    ground.command(speed, 0.0)
    while not ground.touches:
        ground.advance(0.005)
    ground.command(0.0, 0.0)
    ground.advance(6.0)
    np.testing.assert_allclose(ground.ball, [way, 0.0], atol=0.05 * way)


def test_a_ball_rolls_past_the_line_or_stays_well_before_it():
    """It is never meant to lie on the line. Farthest the robot makes it roll: (1.6 * 0.65)^2 / 0.7."""
    farthest = (1.6 * 0.65) ** 2 / 0.7
    for way in np.arange(0.05, 3.0, 0.05):
        roll = PARAMS.roll(way)
        assert 0.0 < roll <= farthest + 1e-9
        assert roll >= way + 0.1 - 1e-9 or roll <= way - 0.4 + 1e-9, way
    assert PARAMS.roll(0.8) == pytest.approx(1.2)
    assert PARAMS.roll(1.5) == pytest.approx(1.1)
    assert PARAMS.roll(3.0) == pytest.approx(farthest)


def test_spread_is_the_room_beside_what_stands_there_by_its_distance():
    ball, target = np.zeros(2), np.array([2.0, 0.0])

    def room(*disc):
        return angular_tolerance(ball, target, np.array([disc]), 0.05)

    assert room(1.0, 0.3, 0.05) == pytest.approx(0.2)
    assert room(2.0, -0.3, 0.05) == pytest.approx(0.1)
    assert room(1.0, 0.05, 0.05) < 0.0  # in the way
    assert room(-0.5, 0.0, 0.05) == room(2.5, 0.0, 0.05) == 1.0  # behind the ball, beyond the target
    assert angular_tolerance(ball, target, np.zeros((0, 3)), 0.05) == 1.0


@pytest.mark.parametrize("seed", range(5))
def test_a_kick_that_errs_by_less_than_its_spread_touches_nothing(seed):
    """The ball's distance to each pillar, point by point of its way."""
    random = np.random.default_rng(seed)
    ball, target = np.zeros(2), np.array([1.5, 0.0])
    discs = np.column_stack([random.uniform(0.25, 1.5, 3), random.uniform(-0.6, 0.6, 3), np.full(3, 0.05)])
    allowed = angular_tolerance(ball, target, discs, 0.05)
    for turn in np.linspace(-1.0, 1.0, 9) * 0.9 * max(allowed, 0.0):
        way = np.linspace(0.0, 1.5, 300)[:, np.newaxis] * [np.cos(turn), np.sin(turn)]
        apart = np.linalg.norm(way[:, np.newaxis] - discs[:, :2], axis=2).min() - 0.1
        assert apart > -0.01 if allowed > 0.0 else apart < 0.12


def test_with_nothing_in_the_way_it_kicks_at_the_middle():
    kick = planned([1.0, 0.1])
    assert kick.is_final
    np.testing.assert_allclose(kick.target, [0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(kick.start, np.array([1.0, 0.1]) * (1.0 + 0.62 / np.hypot(1.0, 0.1)))
    np.testing.assert_allclose(kick.direction, -np.array([1.0, 0.1]) / np.hypot(1.0, 0.1))


def test_past_a_pillar_in_the_way_and_through_the_goal():
    kick = planned([1.2, 0.0], [Disc(0.5, 0.0, 0.05)])
    assert kick.is_final and abs(kick.target[1]) < HALF_GOAL - 0.1
    assert kick.tolerance >= PARAMS.min_tolerance
    assert abs(kick.target[1] * (1.2 - 0.5) / 1.2) > 0.1 - 0.01  # beside the pillar


def test_a_shut_goal_is_opened_from_elsewhere():
    """Three pillars before the ball: it is first brought to where it can be kicked from."""
    wall = [Disc(0.9, y, 0.05) for y in (-0.22, 0.0, 0.22)]
    kick = planned([1.3, 0.0], wall)
    assert kick is not None and not kick.is_final
    assert kick.distance == pytest.approx(np.hypot(*(kick.target - kick.ball)))
    assert goal_before([1.0, 0.0]).distance_before(kick.target) >= 0.4


def test_a_ball_is_not_kicked_to_unobserved_floor():
    """There may be a wall. With either side seen, it goes to that side."""
    wall = [Disc(0.9, y, 0.05) for y in (-0.22, 0.0, 0.22)]
    for side in (1.0, -1.0):
        kick = planned([1.3, 0.0], wall, seen=(-0.3, 2.0) if side > 0.0 else (-2.0, 0.3))
        assert not kick.is_final and side * kick.target[1] > -0.3
    assert (
        planned([1.3, 0.0], wall, seen=(-0.1, 0.1)) is None
        or planned([1.3, 0.0], wall, seen=(-0.1, 0.1)).is_final
    )


def test_a_ball_that_the_robot_cannot_drive_behind_is_not_kicked():
    ring = [Disc(1.2 + 0.4 * np.cos(a), 0.4 * np.sin(a), 0.05) for a in np.arange(0.0, 6.2, 0.6)]
    assert planned([1.2, 0.0], ring) is None


def test_a_ball_on_the_line_is_kicked_across_it_and_one_behind_it_is_brought_back():
    for before in (0.03, 0.0, -0.02):
        kick = planned([before, 0.1])
        assert kick.is_final and kick.direction[0] < -0.5 and kick.target[0] < before
    back = planned([-0.5, 0.0])
    assert not back.is_final and back.target[0] > -0.5


def test_of_kicks_as_good_it_keeps_to_the_one_it_planned():
    first = planned([1.0, 0.0])
    other = first._replace(target=np.array([0.0, 0.12]))
    again = planned([1.0, 0.0], previous=other)
    assert abs(again.target[1] - 0.12) < 0.06
    np.testing.assert_allclose(planned([1.0, 0.0], previous=first).target, first.target)


def kick_at(ball, is_final=True):
    ball = np.array(ball, float)
    return Kick(ball, np.zeros(2), ball * 1.6, 1.4, 0.3, is_final)


def test_straight_ahead_is_where_the_line_from_robot_to_ball_meets_the_goals():
    discs, goal = np.array(POSTS), goal_before([1.0, 0.0])
    kick = straight_ahead(kick_at([1.0, 0.0]), np.array([1.6, 0.06, 3.0]), goal, discs, 0.05)
    np.testing.assert_allclose(kick.target, [0.0, -0.1], atol=1e-9)
    np.testing.assert_allclose(kick.start, [1.6, 0.06])
    assert (
        straight_ahead(kick_at([1.0, 0.0]), np.array([1.4, 0.4, 3.0]), goal, discs, 0.05) is None
    )  # past a post
    assert (
        straight_ahead(kick_at([1.0, 0.0]), np.array([0.4, 0.0, 0.0]), goal, discs, 0.05) is None
    )  # backward
    aside = straight_ahead(kick_at([1.0, 0.0], False), np.array([1.0, 0.6, 0.0]), goal, discs, 0.05)
    np.testing.assert_allclose(aside.target, [1.0, -1.0], atol=1e-9)  # as far as was planned
