# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every limit of the ball task holds in every world that is drawn, and is come near to: measured anew."""

import functools
import itertools

import cv2
import numpy as np
import pytest

from sextant.simulation.ball_ground import Pillar
from sextant.simulation.ball_world import TASKS, random_world

WORLDS = 300
PIXELS = 100  # a metre, of a floor plan
SLACK = 0.015  # metres, of the same
LIMITS = {  # of the ball before the goal's line and off its axis, metres; of pillars before the line
    2: (0.5, 1.5, 0.15, 0),
    3: (0.5, 2.0, 0.30, 2),
}


@functools.lru_cache(maxsize=None)
def worlds(task):
    return [random_world(task, seed) for seed in range(WORLDS)]


def places(world):
    """(n, 2) of the pillars."""
    return np.array([[pillar.x, pillar.y] for pillar in world.pillars])


def beside_goal(world, points):
    """(n, 2) of points: toward the ball's side of the goal's line, and along it from its middle."""
    left, right = places(world)[:2]
    along = (left - right) / np.linalg.norm(left - right)
    before = np.array([along[1], -along[0]])
    if (world.ball - left) @ before < 0.0:
        before = -before
    return (np.atleast_2d(points) - 0.5 * (left + right)) @ np.column_stack([before, along])


def plan(world, pillar, wall, ball=0.0):
    """A floor plan of where one can be that keeps so far from pillars' axes, walls and the ball's middle."""
    size = np.array(world.size)
    free = np.full(tuple((size[::-1] * PIXELS).astype(int)), 255, np.uint8)
    edge = int(np.ceil((wall - SLACK) * PIXELS))
    free[:edge], free[-edge:], free[:, :edge], free[:, -edge:] = 0, 0, 0, 0
    for at, keeps in [*((at, pillar) for at in places(world)), (world.ball, ball)]:
        if keeps:
            middle = tuple(int(value) for value in np.rint((at + 0.5 * size) * PIXELS * 16))
            cv2.circle(free, middle, int((keeps - SLACK) * PIXELS * 16), 0, cv2.FILLED, cv2.LINE_8, 4)
    return free


def leads(world, free, start, end):
    _, parts = cv2.connectedComponents(free)
    here, there = (
        parts[tuple(((at + 0.5 * np.array(world.size)) * PIXELS).astype(int)[::-1])] for at in (start, end)
    )
    return here == there != 0


def middle_of_goal(world):
    return places(world)[:2].mean(axis=0)


@pytest.mark.slow
@pytest.mark.parametrize("task", TASKS)
def test_the_ball_lies_in_the_area_of_the_task_and_anywhere_there(task):
    least, most, aside, _ = LIMITS[task]
    off = np.array([beside_goal(world, world.ball)[0] for world in worlds(task)])
    assert np.all((off[:, 0] >= least) & (off[:, 0] <= most)) and np.all(abs(off[:, 1]) <= aside + 1e-9)
    assert off[:, 0].min() < least + 0.05 and off[:, 0].max() > most - 0.1
    assert off[:, 1].min() < -0.9 * aside and off[:, 1].max() > 0.9 * aside


@pytest.mark.parametrize("task", TASKS)
def test_the_goal_is_two_blue_pillars_at_least_700_mm_apart(task):
    widths = [np.linalg.norm(np.subtract(*places(world)[:2])) for world in worlds(task)]
    assert 0.7 <= min(widths) < 0.72 and max(widths) > 1.15
    assert all(pillar.class_name == "blue_pillar" for world in worlds(task) for pillar in world.pillars[:2])


@pytest.mark.parametrize("task", TASKS)
def test_the_robot_starts_700_mm_to_2_and_a_half_m_from_the_ball_looking_anywhere(task):
    far = np.array([np.linalg.norm(world.robot[:2] - world.ball) for world in worlds(task)])
    assert 0.7 <= far.min() < 0.75 and 2.4 < far.max() <= 2.5
    assert np.histogram([world.robot[2] for world in worlds(task)], 8, (-np.pi, np.pi))[0].min() > 15
    side = [beside_goal(world, world.robot[:2])[0, 0] for world in worlds(task)]
    assert np.mean(np.less(side, 0.0)) > 0.03  # also behind the goal


@pytest.mark.parametrize("task", TASKS)
def test_as_many_pillars_stand_before_and_behind_the_goal_as_may(task):
    before, behind, blue = [], [], 0
    for world in worlds(task):
        off = beside_goal(world, places(world)[2:].reshape(-1, 2))[:, 0]
        is_blue = np.array([pillar.class_name == "blue_pillar" for pillar in world.pillars[2:]], bool)
        assert np.all(off[is_blue] <= -0.4 + 1e-9), "the goal is the nearer pair"
        assert np.all(abs(off) >= 0.3 - 1e-9)
        before.append(np.sum(off > 0.0))
        behind.append(np.sum(off < 0.0))
        blue += np.sum(is_blue)
    assert set(before) == set(range(LIMITS[task][3] + 1))
    assert set(behind) == set(range(5))
    assert blue > 0.2 * np.sum(behind)


@pytest.mark.parametrize("task", TASKS)
def test_nothing_touches_anything(task):
    for world in worlds(task):
        things = [*places(world), world.ball, world.robot[:2]]
        for one, other in itertools.combinations(places(world), 2):
            assert np.linalg.norm(one - other) >= 0.2 - 1e-9
        assert min(np.linalg.norm(places(world) - world.ball, axis=1)) >= 0.4 - 1e-9
        assert min(np.linalg.norm(places(world) - world.robot[:2], axis=1)) >= 0.35 - 1e-9
        assert np.all(abs(np.array(things)) <= 0.5 * np.array(world.size) - 0.6 + 1e-9)


@pytest.mark.parametrize("task", TASKS)
def test_a_way_600_mm_wide_leads_the_ball_into_the_goal(task):
    for world in worlds(task):
        assert leads(world, plan(world, 0.3 + 0.05, 0.3), world.ball, middle_of_goal(world))


@pytest.mark.parametrize("task", TASKS)
def test_the_robot_can_come_behind_the_ball(task):
    for world in worlds(task):
        line = world.ball - middle_of_goal(world)
        behind = world.ball + 0.5 * line / np.linalg.norm(line)
        assert leads(world, plan(world, 0.25, 0.25, ball=0.25), world.robot[:2], behind)


@pytest.mark.parametrize("task", TASKS)
def test_strays_leave_the_rules_as_they_are(task):
    for seed in range(20):
        world = random_world(task, seed, strays=4)
        assert world.strays.shape == (4, 2)
        every = np.vstack([places(world), world.strays])
        for one, other in itertools.combinations(every, 2):
            assert np.linalg.norm(one - other) >= 0.2 - 1e-9
        things = np.array([world.ball, world.robot[:2]])
        assert np.linalg.norm(world.strays[:, np.newaxis] - things, axis=2).min() >= 0.35 - 1e-9
        assert np.all(abs(beside_goal(world, world.strays)[:, 1]) >= 0.6 - 1e-9)
        assert np.all(abs(world.strays) <= 0.5 * np.array(world.size) - 0.6 + 1e-9)
        assert all(pillar.class_name for pillar in world.pillars)
        others = [Pillar(*at, 0.05, "") for at in world.strays]
        crowded = world._replace(pillars=[*world.pillars, *others])
        assert leads(crowded, plan(crowded, 0.3 + 0.05, 0.3), world.ball, middle_of_goal(world))


def test_ways_are_not_there_by_themselves():
    """Drafts that have none are rejected: one 800 mm wide is not always there."""
    narrow = [not leads(w, plan(w, 0.45, 0.4), w.ball, middle_of_goal(w)) for w in worlds(3)]
    assert 0.1 < np.mean(narrow) < 0.9
    straight = [world for world in worlds(3) if is_straight(world)]
    assert 0 < len(straight) < WORLDS  # sometimes the way bends


def is_straight(world):
    """Whether nothing stands 350 mm about the line from the ball to the goal's middle."""
    line = middle_of_goal(world) - world.ball
    shares = np.clip((places(world)[2:].reshape(-1, 2) - world.ball) @ line / (line @ line), 0.0, 1.0)
    off = places(world)[2:].reshape(-1, 2) - (world.ball + shares[:, np.newaxis] * line)
    return not len(off) or np.linalg.norm(off, axis=1).min() > 0.35


def test_the_same_seed_gives_the_same_world():
    for one, same, other in zip(worlds(3)[:5], (random_world(3, seed) for seed in range(5)), worlds(3)[1:]):
        assert one.pillars == same.pillars and one.size == same.size
        np.testing.assert_array_equal([*one.ball, *one.robot], [*same.ball, *same.robot])
        assert not np.array_equal(one.ball, other.ball)
    assert not np.array_equal(random_world(2, 0).ball, random_world(3, 0).ball)


def test_a_task_that_is_none_is_refused():
    with pytest.raises(ValueError, match=r"task is 4, allowed is one of \[2, 3\]"):
        random_world(4, 0)
