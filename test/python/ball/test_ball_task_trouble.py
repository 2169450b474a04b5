# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The ball task where something is missing or in the way: each failure has its recovery and its end."""

import numpy as np
import pytest
from ball_play import HELD, TICK, Eyes, play
from test_ball_task import POSTS, assert_won, world_of

from sextant.ball.ball_task import BallTask
from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.floor_grid import FloorGrid, FloorGridParams
from sextant.ball.searching import FullTurn
from sextant.ball.task_view import SeenBall, SeenPillar, TaskView
from sextant.objects.object_kinds import GOAL
from sextant.simulation.ball_ground import BallGround, Pillar

FEW = BallTaskParams(max_searches=1)
RING = [  # about the ball
    Pillar(0.3 * np.cos(a), 0.1 + 0.3 * np.sin(a), 0.05, "red_pillar") for a in np.arange(0.0, 6.2, 0.698)
]


def failed(played):
    """Why."""
    assert played.action.state == "failed" and played.action.is_ended
    assert played.action.command == (0.0, 0.0)
    return played.action.reason


@pytest.mark.slow
def test_no_ball():
    reason = failed(play(world_of()._replace(ball=None), FEW))
    assert reason.startswith("no ball was found from")


@pytest.mark.slow
@pytest.mark.parametrize("posts", [[], POSTS[:1], [POSTS[0], Pillar(-1.0, -0.1, 0.05, "blue_pillar")]])
def test_no_goal(posts):
    assert failed(play(world_of(posts=posts), FEW)).startswith("no goal was found from")


@pytest.mark.slow
def test_a_ball_that_the_robot_cannot_drive_behind():
    played = play(world_of(others=RING))
    assert failed(played) == "no path to the start of a kick"
    assert played.states.count("blocked") == 4
    assert played.pillar_touches == 0


@pytest.mark.slow
def test_an_obstacle_that_moves_away_does_not_end_the_task():
    """The ring is taken away while it looks around."""
    ground = BallGround((6.0, 6.0), [*POSTS, *RING], (0.0, 0.1), (1.2, 0.6, 2.5))
    eyes, task, states = Eyes(ground, 1.0, 0), BallTask(BallTaskParams()), []
    while "aligning" not in states:
        assert ground.stamp < 60.0
        eyes.look()
        view = eyes.view()
        if "blocked" in states:
            view = view._replace(pillars=view.pillars[:2])
            view.grid.evidence[:] = 0
        states.append(task.step(view).state)
        ground.command(*task.step(view).command)
        ground.advance(TICK)
    assert "blocked" in states and "failed" not in states


@pytest.mark.slow
def test_a_ball_that_is_taken_away():
    def meddle(ground, action):
        if action.state == "approaching":
            ground.ball = None

    played = play(world_of(), FEW, meddle=meddle)
    assert failed(played).startswith("no ball was found from")
    assert "approaching" in played.states


def test_a_bumper_that_is_pressed():
    """It backs off, and goes on."""
    bumps, places = [], []

    def meddle(ground, action):
        places.append((action.state, ground.robot.x, ground.robot.y))
        if action.state == "approaching" and not bumps and ground.robot.speed > 0.2:
            bumps.append(len(places))
            ground._pressed.add("something")
        elif action.state == "recovering":
            ground._pressed.discard("something")

    played = play(world_of(), meddle=meddle)
    assert_won(played)
    back = np.array([place[1:] for place in places if place[0] == "recovering"])
    assert "bumped" in played.reasons
    assert np.linalg.norm(back[0] - back[-1]) == pytest.approx(0.25, abs=0.08)


@pytest.mark.slow
def test_a_pillar_that_is_never_seen_is_bumped_into_and_gone_around():
    world = world_of(ball=(0.0, 0.1), robot=(1.6, 0.1, 3.1))
    ground = BallGround(world.size, world.pillars, world.ball, world.robot)
    eyes, task, action = Eyes(ground, 1.0, 0), BallTask(BallTaskParams()), None
    ground.pillars = [*ground.pillars, Pillar(0.95, 0.1, 0.02, "glass")]
    eyes._observations.append([])
    while action is None or not action.is_ended:
        seen, ground.pillars = ground.pillars, ground.pillars[:2]
        eyes.look()
        view = eyes.view()
        ground.pillars = seen
        action = task.step(view)
        ground.command(*action.command)
        ground.advance(TICK)
        assert ground.stamp < 200.0
    assert action.state == "done", action.reason


def test_a_robot_that_does_not_move_recovers_and_then_fails():
    played = play(world_of(), BallTaskParams(max_bumps=2), drive=HELD)
    assert failed(played) == "stuck 3 times"
    assert "recovering" in played.states


def test_the_time_limit():
    played = play(world_of(), BallTaskParams(time_limit=9.0))
    assert failed(played).startswith("not done after 9 s, last: ")
    assert played.ground.stamp == pytest.approx(9.0, abs=0.6)


@pytest.mark.parametrize("wrong", ["pose", "ball"])
def test_places_that_are_not_finite_are_refused_and_change_nothing(wrong):
    """The next action is the same as without them."""
    ground = BallGround((6.0, 6.0), POSTS, (0.0, 0.1), (1.2, 0.1, 3.1))
    eyes, task, other = Eyes(ground, 0.0, 0), BallTask(BallTaskParams()), BallTask(BallTaskParams())
    for _ in range(40):
        eyes.look()
        view = eyes.view()
        nowhere = np.full(3, np.nan)
        ball = None if view.ball is None else view.ball._replace(position=nowhere[:2])
        bad = view._replace(pose=nowhere) if wrong == "pose" or ball is None else view._replace(ball=ball)
        with pytest.raises(ValueError, match="must be finite"):
            task.step(bad)
        action, expected = task.step(view), other.step(view)
        assert (action.command, action.state) == (expected.command, expected.state)
        ground.command(*action.command)
        ground.advance(TICK)


def test_once_ended_it_does_nothing_until_it_is_started_again():
    ground = BallGround((6.0, 6.0), POSTS, (0.0, 0.1), (1.2, 0.1, 3.1))
    eyes, task = Eyes(ground, 0.0, 0), BallTask(BallTaskParams(time_limit=1.0))
    eyes.look()
    view = eyes.view()
    task.step(view)
    assert task.step(view._replace(stamp=2.0)).state == "failed"
    assert task.step(view._replace(stamp=3.0, is_bumped=True)).state == "failed"
    task.start()
    action = task.step(view._replace(stamp=4.0))
    assert (action.kicks, action.is_ended) == (0, False)


def seen_at(x, now, stamp=None, pose=(1.0, 0.0, np.pi)):
    """A ball on the axis of the goal at x = -1, as a view of a robot that stands; and pillars."""
    ball = SeenBall(np.array([x, 0.0]), np.zeros(2), now if stamp is None else stamp)
    pillars = [SeenPillar(GOAL, np.array(post[:2])) for post in POSTS]
    return TaskView(now, np.array(pose), pillars, ball, False, FloorGrid(FloorGridParams()))


def watching():
    """A task that has kicked."""
    task = BallTask(BallTaskParams())
    task.step(seen_at(0.0, now=0.0))
    task.kicks, task.state = 1, "watching"
    return task


def test_a_ball_not_observed_behind_the_line_is_not_through():
    """It is believed to roll on, and lies before the line in truth."""
    task = watching()
    task.step(seen_at(-0.9, now=0.1))
    for tick in range(2, 40):
        task.step(seen_at(-0.9 - 0.01 * tick, now=0.1 * tick, stamp=0.1))
    assert task.state == "watching"
    task.step(seen_at(-1.3, now=4.0))
    assert task.state == "stopping"


def test_after_a_pause_of_poses_it_is_not_stuck():
    task, stamp = BallTask(BallTaskParams()), 0.0
    pose, states = np.array([1.2, 0.6, 2.5]), []
    for pause in (3.0, 3.0):
        driven = 0
        while driven < 20:
            action = task.step(seen_at(0.0, now=stamp, pose=pose))
            speed, turn_rate = action.command
            pose = pose + 0.05 * np.array([speed * np.cos(pose[2]), speed * np.sin(pose[2]), turn_rate])
            stamp += 0.05
            states.append(action.state)
            driven += action.command[0] > 0.1
        stamp += pause
    assert "approaching" in states and "recovering" not in states


def test_a_post_that_is_lost_does_not_make_both_one():
    """All that is left stands between them."""
    posts = [SeenPillar(GOAL, np.array([-1.0, y])) for y in (-0.36, 0.36)]
    task = BallTask(BallTaskParams())
    task.step(seen_at(0.0, now=0.0)._replace(pillars=posts))
    task.kicks = 1
    task.step(seen_at(0.0, now=0.1)._replace(pillars=[SeenPillar(GOAL, np.array([-1.0, 0.0]))]))
    assert task.goal.width == pytest.approx(0.72)
    assert np.isfinite(task.goal.normal).all()


def test_a_ball_that_presses_the_bumper_is_no_collision():
    """A base whose bumper is as low as the ball: each kick presses it."""
    states = []

    def meddle(ground, action):
        states.append(action.state)
        near = np.linalg.norm(ground.ball - [ground.robot.x, ground.robot.y]) < 0.177 + 0.05 + 0.02
        (ground._pressed.add if near else ground._pressed.discard)("ball")

    played = play(world_of(), meddle=meddle)
    assert_won(played)
    assert "kicking" in states and "recovering" not in states


def test_noise_of_a_standing_robots_heading_is_no_full_turn():
    turn, random = FullTurn(), np.random.default_rng(1)
    assert not any(turn.is_done(each) for each in random.normal(0.0, 0.02, 2000))
    assert any(turn.is_done(-0.01 * i) for i in range(700))
