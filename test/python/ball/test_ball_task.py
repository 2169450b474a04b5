# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The ball task, played: ball through the goal, robot stopped before it; scored by the world's truth."""

import numpy as np
import pytest
from ball_play import STEADY, play

from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.kick_plan import KickParams
from sextant.objects.object_kinds import GOAL
from sextant.simulation.ball_ground import Pillar
from sextant.simulation.ball_world import BallWorld, random_world

POSTS = [Pillar(-1.0, -0.5, 0.05, GOAL), Pillar(-1.0, 0.5, 0.05, GOAL)]
ROOM = (6.0, 6.0)


def world_of(ball=(0.0, 0.1), robot=(1.2, 0.6, 2.5), others=(), posts=POSTS):
    return BallWorld(ROOM, [*posts, *others], np.array(ball), np.array(robot))


def assert_won(played):
    assert played.action.state == "done", played.action.reason
    assert played.is_through
    assert played.front == pytest.approx(0.2, abs=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("task, seed", [(2, 0), (2, 1), (2, 5), (3, 2), (3, 4)])
def test_drawn_worlds_are_won(task, seed):
    played = play(random_world(task, seed), seed=seed)
    assert_won(played)
    assert played.pillar_touches == 0
    assert played.states[0] == "searching" and played.states[-3:] == ["watching", "stopping", "done"]


def test_with_the_truth_one_kick_does():
    played = play(world_of(), noise=0.0, drive=STEADY)
    assert_won(played)
    assert played.action.kicks == 1
    steps = ["searching", "approaching", "aligning", "kicking", "watching", "stopping", "done"]
    assert list(dict.fromkeys(played.states)) == steps
    assert played.pillar_touches == 0
    bearings = [touch.bearing for touch in played.ground.touches if touch.what == "ball"]
    assert abs(bearings[0]) < 0.1  # it hits the ball with its front


@pytest.mark.slow
def test_a_kick_that_falls_short_is_followed_by_a_harder_one():
    """It takes the floor for smoother than it is: v^2 = 2 a s with an a of a third."""
    params = BallTaskParams(kick=KickParams(ball_deceleration=0.12))
    played = play(world_of(ball=(0.4, 0.0)), params)
    assert_won(played)
    assert "the ball lies short of the goal" in played.reasons
    assert played.action.kicks in (2, 3, 4)


def test_too_many_kicks_are_an_end():
    params = BallTaskParams(max_kicks=1, kick=KickParams(ball_deceleration=0.12))
    played = play(world_of(ball=(0.4, 0.0)), params)
    assert (played.action.state, played.action.kicks) == ("failed", 1)
    assert played.action.reason == "1 kicks did not bring the ball through the goal"


def test_a_ball_that_comes_to_lie_on_the_line_is_kicked_across_it():
    """It rests a centimetre before the line when its first kick is over."""

    def meddle(ground, action):
        if action.kicks == 1 and action.state == "watching" and ground.ball[0] < -0.5:
            ground.ball, ground.ball_velocity = np.array([-0.99, 0.0]), np.zeros(2)

    played = play(world_of(), meddle=meddle)
    assert_won(played)
    assert played.action.kicks == 2


@pytest.mark.slow
def test_a_ball_that_somebody_puts_elsewhere_is_found_there():
    moved = []

    def meddle(ground, action):
        if action.state == "aligning" and not moved:
            moved.append(ground.stamp)
            ground.ball = np.array([0.3, -1.0])

    assert_won(play(world_of(), meddle=meddle))
    assert moved


@pytest.mark.slow
def test_a_ball_that_rolls_aside_during_the_run_up_is_kicked_again():
    def meddle(ground, action):
        if (
            action.kicks == 1
            and action.state == "kicking"
            and ground.robot.speed > 0.2
            and ground.ball[1] < 0.3
        ):
            ground.ball = np.array([0.0, 0.6])

    played = play(world_of(), meddle=meddle)
    assert_won(played)
    assert played.action.kicks == 2


@pytest.mark.slow
def test_a_ball_that_is_kicked_past_the_goal_is_brought_back():
    """A post that moves the ball's way: it comes to lie behind the line, beside the goal."""

    def meddle(ground, action):
        if action.kicks == 1 and action.state == "watching" and -0.9 < ground.ball[0] < -0.4:
            ground.ball, ground.ball_velocity = np.array([-1.3, 1.0]), np.zeros(2)

    played = play(world_of(), meddle=meddle)
    assert_won(played)
    assert played.action.kicks >= 2


@pytest.mark.slow
def test_something_that_stands_where_it_would_stop_is_gone_around():
    """It comes there when the ball is through, and the robot has not seen it before."""
    post = Pillar(-0.6, 0.0, 0.05, "red_pillar")
    far = Pillar(2.5, -2.5, 0.05, "red_pillar")

    def meddle(ground, action):
        if action.state == "watching" and ground.ball[0] < -0.9:
            ground.pillars[2] = post

    played = play(world_of(ball=(0.4, 0.0), robot=(1.4, 0.6, 2.5), others=[far]), meddle=meddle)
    assert_won(played)
    assert abs(played.ground.robot.y) > 0.1
