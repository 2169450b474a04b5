# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The goal among blue pillars; the rules state its position."""

import numpy as np
import pytest

from sextant.ball.goal import find_goal, goal_between, goes_through
from sextant.objects.object_kinds import GOAL
from sextant.simulation.ball_world import random_world

LEFT, RIGHT = np.array([0.0, -0.5]), np.array([0.0, 0.5])  # seen from x > 0
BALL = np.array([1.0, 0.1])


def rotated(points, angle, shift):
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(points) @ np.array([[c, s], [-s, c]]) + shift


def found(*others, ball=BALL, width=0.7):
    return find_goal(np.array([LEFT, RIGHT, *others]).reshape(-1, 2), np.asarray(ball), width)


@pytest.mark.parametrize("angle", np.linspace(-3.0, 3.0, 7))
def test_distances_before_and_aside(angle):
    """Turned and moved as a whole, a goal's distances stay."""
    first, second, ball = rotated([LEFT, RIGHT, BALL], angle, [2.0, -3.0])
    for goal in (goal_between(first, second, ball), goal_between(second, first, ball)):
        np.testing.assert_allclose(goal.posts, [first, second], atol=1e-12)  # left first, whoever comes first
        assert goal.width == pytest.approx(1.0)
        assert goal.distance_before(ball) == pytest.approx(1.0)
        assert goal.lateral_offset(ball) == pytest.approx(-0.1)  # seen from the ball, left is -y
        behind = rotated([[-0.7, -0.2]], angle, [2.0, -3.0])[0]
        assert goal.distance_before(behind) == pytest.approx(-0.7)
        assert goal.lateral_offset(behind) == pytest.approx(0.2)


def test_blue_pillars_behind_do_not_matter():
    for behind in ([-0.5, 0.0], [-0.4, 0.5], [-1.0, -0.5], [-0.6, 1.2]):
        np.testing.assert_allclose(found(behind).posts, [LEFT, RIGHT])


def test_a_blue_pillar_between_or_before_makes_it_no_goal():
    assert found([0.0, 0.05]) is None
    assert found([0.0, 0.2], width=0.6).width == pytest.approx(0.7)  # between it and LEFT is room
    assert found([0.4, 0.0]) is None


@pytest.mark.parametrize("width, is_goal", [(0.6, False), (0.66, True), (2.4, True), (2.6, False)])
def test_a_goal_is_as_wide_as_a_goal(width, is_goal):
    pillars = np.array([[0.0, -0.5 * width], [0.0, 0.5 * width]])
    assert (find_goal(pillars, np.array([1.0, 0.0]), 0.7) is not None) == is_goal


def test_a_ball_beside_the_goal_has_none():
    assert found(ball=[0.5, 0.7]) is not None
    assert found(ball=[0.5, 0.8]) is None


def test_fewer_than_two_pillars_two_in_one_place_and_a_ball_nowhere_are_no_goal():
    assert find_goal(np.zeros((0, 2)), BALL, 0.7) is None
    assert find_goal(LEFT[np.newaxis], BALL, 0.7) is None
    assert find_goal(np.array([LEFT, LEFT]), BALL, 0.7) is None
    assert found([LEFT[0], LEFT[1]]) is not None  # a post that the map holds twice
    assert found(ball=[np.nan, 0.0]) is None


@pytest.mark.parametrize("task", [2, 3])
def test_of_drawn_worlds_the_first_two_pillars_are_the_goal(task):
    for seed in range(60):
        world = random_world(task, seed)
        blue = np.array([pillar[:2] for pillar in world.pillars if pillar.class_name == GOAL])
        order = np.random.default_rng(seed).permutation(len(blue))
        goal = find_goal(blue[order], world.ball, 0.7)
        assert {tuple(post) for post in goal.posts} == {tuple(post) for post in blue[:2]}, seed


@pytest.mark.parametrize(
    "before, now, is_through",
    [
        ([0.5, 0.0], [-0.1, 0.2], True),
        ([0.5, 0.0], [0.0, 0.2], True),
        ([0.5, 0.0], [0.01, 0.2], False),
        ([-0.5, 0.0], [0.5, 0.0], False),  # backward
        ([0.5, 0.4], [-0.5, 0.55], True),  # crosses at 0.475
        ([0.5, 0.4], [-0.5, 0.65], False),  # at 0.525
    ],
)
def test_goes_through(before, now, is_through):
    assert goes_through(goal_between(LEFT, RIGHT, BALL), np.array(before), np.array(now)) == is_through
