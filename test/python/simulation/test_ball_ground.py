# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A ball that rolls and bounces, a robot that drives and slips: all against closed form."""

import math

import numpy as np
import pytest

from sextant.simulation.ball_ground import STEP, BallGround, BallParams, Pillar, RobotParams
from sextant.simulation.odometry import OdometryNoise

BALL = BallParams()
EXACT = RobotParams(slip=0.0, noise=OdometryNoise(0.0, 0.0, 0.0))
REACH = EXACT.radius + BALL.radius  # between the middles of robot and ball that touch
FAR = (-9.0, -9.0, 0.0)  # where a robot touches nothing


def ground_of(pillars=(), ball=None, robot=FAR, drive=EXACT, ball_params=BALL, seed=0, size=(20.0, 20.0)):
    return BallGround(size, pillars, ball, robot, ball_params, drive, seed)


def rolling(position, velocity, pillars=(), **params):
    ground = ground_of(pillars, position, ball_params=BallParams(**params))
    ground.ball_velocity = np.array(velocity, float)
    return ground


def advance_until(ground, condition, seconds=20.0):
    while not condition():
        assert ground.stamp < seconds
        ground.advance(STEP)


@pytest.mark.parametrize("speed", [0.2, 0.7, 1.5])
def test_a_ball_rolls_v_squared_by_2a(speed):
    ground = rolling((0.0, 0.0), (0.6 * speed, 0.8 * speed))
    ground.advance(speed / BALL.deceleration / 2.0)
    assert ground.ball_speed == pytest.approx(speed / 2.0, abs=BALL.deceleration * STEP)
    ground.advance(10.0)
    assert ground.ball_speed == 0.0
    way = speed**2 / (2.0 * BALL.deceleration)
    np.testing.assert_allclose(ground.ball, [0.6 * way, 0.8 * way], atol=1e-3)


@pytest.mark.parametrize("aside", [0.0, 0.03, -0.07])
@pytest.mark.parametrize("restitution", [0.6, 1.0])
def test_a_ball_bounces_off_a_pillar(aside, restitution):
    """The speed along the line of centres is reversed, times the restitution; the other part stays."""
    ground = rolling(
        (0.0, aside), (1.0, 0.0), [Pillar(1.0, 0.0, 0.05, "")], deceleration=0.0, restitution=restitution
    )
    advance_until(ground, lambda: not np.array_equal(ground.ball_velocity, [1.0, 0.0]))
    angle = math.asin(aside / (BALL.radius + 0.05))
    normal, tangent = (
        np.array([-math.cos(angle), math.sin(angle)]),
        np.array([math.sin(angle), math.cos(angle)]),
    )
    assert ground.ball_velocity @ normal == pytest.approx(
        restitution * math.cos(angle), abs=0.06
    )  # within a step
    assert ground.ball_velocity @ tangent == pytest.approx(math.sin(angle), abs=0.06)
    off = ground.ball - (1.0, 0.0)
    at = off / np.hypot(*off)  # exact for the place where it did
    speeds = np.array([ground.ball_velocity @ at, ground.ball_velocity @ (-at[1], at[0])])
    np.testing.assert_allclose(speeds, [-restitution * at[0], -at[1]], atol=1e-12)


def test_a_ball_bounces_off_walls():
    ground = rolling((9.0, 0.0), (1.0, 0.3), deceleration=0.0)
    ground.advance(2.0)
    np.testing.assert_allclose(ground.ball_velocity, [-0.6, 0.3])
    # to the wall at 10 m in 0.95 s, and back at 0.6 of the speed
    np.testing.assert_allclose(ground.ball, [9.95 - 0.6 * 1.05, 0.6], atol=0.01)


@pytest.mark.parametrize("speed", [0.3, 0.7])
def test_a_kick_gives_1_plus_e_of_the_speed(speed):
    ground = ground_of(ball=(1.5, 0.0), robot=(0.0, 0.0, 0.0))
    ground.command(speed, 0.0)
    advance_until(ground, lambda: ground.ball_speed > 0.0)
    np.testing.assert_allclose(ground.ball_velocity, [(1.0 + BALL.restitution) * speed, 0.0], atol=1e-12)
    assert [touch.what for touch in ground.touches] == ["ball"]
    assert ground.touches[0].bearing == pytest.approx(0.0)
    assert not ground.is_bumped


@pytest.mark.parametrize("aside", [0.1, -0.15])
def test_a_ball_that_is_hit_off_centre_goes_along_the_line_of_the_middles(aside):
    ground = ground_of(ball=(1.0, aside), robot=(0.0, 0.0, 0.0))
    ground.command(0.5, 0.0)
    advance_until(ground, lambda: ground.ball_speed > 0.0)
    angle = math.asin(aside / REACH)
    assert math.atan2(*ground.ball_velocity[::-1]) == pytest.approx(angle, abs=0.02)
    assert ground.ball_speed == pytest.approx(1.6 * 0.5 * math.cos(angle), abs=0.01)
    assert ground.touches[0].bearing == pytest.approx(angle, abs=0.02)


def test_a_ball_bounces_off_a_robot_that_stands():
    ground = ground_of(ball=(1.0, 0.0), robot=(0.0, 0.0, 2.0), ball_params=BallParams(deceleration=0.0))
    ground.ball_velocity = np.array([-0.5, 0.0])
    ground.advance(3.0)
    np.testing.assert_allclose(ground.ball_velocity, [0.3, 0.0], atol=1e-12)
    assert [touch.what for touch in ground.touches] == ["ball"]
    assert ground.touches[0].bearing == pytest.approx(-2.0)
    assert (ground.robot.x, ground.robot.y) == (0.0, 0.0)


def test_speeds_change_no_faster_than_they_can_and_stay_within_limits():
    ground = ground_of(robot=(0.0, 0.0, 0.0))
    ground.command(5.0, -50.0)
    for number in range(1, 200):
        ground.advance(STEP)
        assert ground.robot.speed == pytest.approx(min(EXACT.acceleration * number * STEP, EXACT.max_speed))
        turn_rate = min(EXACT.turn_acceleration * number * STEP, EXACT.max_turn_rate)
        assert ground.robot.turn_rate == pytest.approx(-turn_rate)


def test_a_command_leads_around_a_circle():
    ground = ground_of(
        robot=(1.0, 2.0, 0.5), drive=RobotParams(slip=0.0, noise=EXACT.noise, acceleration=100.0)
    )
    ground.rolled = ground.robot  # from the same place
    ground.command(0.4, 0.8)
    ground.advance(2.0)
    turn = 0.5 + ground.robot.turn_rate * 2.0 - 0.5 * 0.8 * 0.8 / EXACT.turn_acceleration
    assert ground.robot.yaw == pytest.approx(turn, abs=0.005)
    centre = np.array([1.0 - 0.5 * math.sin(0.5), 2.0 + 0.5 * math.cos(0.5)])
    assert np.hypot(*(ground.robot.x, ground.robot.y) - centre) == pytest.approx(
        0.5, abs=0.06
    )  # as it starts
    np.testing.assert_allclose(ground.robot.pose, ground.rolled.pose, atol=1e-9)


@pytest.mark.parametrize("yaw, turned", [(0.0, 0.0), (0.4, 0.0), (-2.0, math.pi)])
def test_a_pillar_stops_the_robot(yaw, turned):
    """Straight on, or backward; the bearing is that of the pillar."""
    way = np.array([math.cos(yaw + turned), math.sin(yaw + turned)])
    pillar = Pillar(*(1.0 * way), 0.05, "")
    ground = ground_of([pillar], robot=(0.0, 0.0, yaw))
    ground.command(0.3 * math.cos(turned), 0.0)
    ground.advance(5.0)
    np.testing.assert_allclose([ground.robot.x, ground.robot.y], (1.0 - 0.177 - 0.05) * way, atol=1e-9)
    assert ground.robot.speed == pytest.approx(0.0)
    (touch,) = ground.touches
    assert (touch.what, abs(touch.bearing)) == ("pillar", pytest.approx(turned))
    assert touch.stamp == pytest.approx(0.773 / 0.3 + 0.3 / 2.0, abs=2 * STEP)
    ground.command(0.0, 0.0)
    ground.advance(1.0)
    assert ground.is_bumped  # until it goes back
    ground.command(-0.3 * math.cos(turned), 0.0)
    ground.advance(1.0)
    assert not ground.is_bumped and len(ground.touches) == 1


@pytest.mark.parametrize("noise", [EXACT.noise, RobotParams().noise])
def test_a_wall_stops_the_robot_and_is_touched_once(noise):
    ground = ground_of(robot=(9.0, 0.0, 0.3), drive=RobotParams(slip=0.0, noise=noise))
    ground.command(0.4, 0.0)
    for _ in range(200):
        ground.advance(0.05)
        assert ground.robot.x <= 10.0 - 0.177 + 1e-9
    assert ground.robot.y > 0.1  # it slides along
    assert [touch.what for touch in ground.touches[:1]] == ["wall"]
    assert ground.touches[0].bearing == pytest.approx(-0.3, abs=0.05)
    assert len(ground.touches) == 1 and ground.is_bumped


def test_a_ball_between_robot_and_wall_stays_in_the_room():
    ground = ground_of(ball=(9.8, 0.0), robot=(9.0, 0.0, 0.0))
    ground.command(0.5, 0.0)
    for _ in range(200):
        ground.advance(STEP)
        assert np.all(abs(ground.ball) <= 9.95 + 1e-9)


@pytest.mark.slow
def test_wheels_lose_as_much_as_they_slip_and_no_more():
    shares = []
    for seed in range(40):
        ground = ground_of(robot=(0.0, 0.0, 0.0), drive=RobotParams(slip=0.1, noise=EXACT.noise), seed=seed)
        ground.command(0.5, 0.0)
        ground.advance(4.0)
        way = math.hypot(ground.robot.x, ground.robot.y)
        shares.append(1.0 - way / math.hypot(ground.rolled.x, ground.rolled.y))
    assert min(shares) >= 0.0 and max(shares) <= 0.1 and max(shares) - min(shares) > 0.08
    assert ground.robot.speed == pytest.approx(0.5 * (1.0 - shares[-1]))


@pytest.mark.slow
def test_odometry_errs_with_the_root_of_way_and_turn():
    """100 drives, the mean of their squares in its 99.8 % band (chi-squared)."""
    noise = OdometryNoise(0.02, 0.03, 0.04)
    for command, deviation in (((0.5, 0.0), 0.02), ((0.0, 1.0), 0.04)):
        off = []
        for seed in range(100):
            drive = RobotParams(slip=0.0, noise=noise, acceleration=100.0, turn_acceleration=1000.0)
            ground = ground_of(robot=(0.0, 0.0, 0.0), drive=drive, seed=seed)
            ground.command(*command)
            ground.advance(2.0)
            robot, odometry = ground.robot, ground.rolled
            off.append(robot.x - odometry.x if command[0] else robot.yaw - odometry.yaw)
        root = math.sqrt(2.0 * sum(command))
        assert 0.61 < np.mean(np.square(off)) / (deviation * root) ** 2 < 1.49


def test_a_robot_that_stands_does_not_move():
    ground = ground_of(robot=(1.0, 2.0, 0.5), drive=RobotParams())
    ground.advance(1.0)
    assert (ground.robot.x, ground.robot.y, ground.robot.yaw) == (1.0, 2.0, 0.5)
    assert (ground.stamp, ground.touches) == (pytest.approx(1.0), [])


def test_the_same_seed_gives_the_same_drive():
    def end(seed):
        ground = ground_of(
            [Pillar(1.2, 0.1, 0.05, "")], (0.6, 0.02), (0.0, 0.0, 0.0), RobotParams(), seed=seed
        )
        ground.command(0.5, 0.1)
        ground.advance(4.0)
        return [*ground.ball, ground.robot.x, ground.robot.y, ground.robot.yaw, len(ground.touches)]

    assert end(1) == end(1) != end(2)
