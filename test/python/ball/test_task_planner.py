# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Vantage points, paths, and obstacles marked by bumps."""

import numpy as np
import pytest

from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.floor_grid import FloorGrid, FloorGridParams
from sextant.ball.goal import goal_between
from sextant.ball.task_planner import TaskPlanner, mark_bump, path_to
from sextant.ball.task_view import SeenBall, SeenPillar, TaskView

PARAMS = BallTaskParams()
REACH = PARAMS.kick.robot_radius


def seen_floor(low, high):
    grid = FloorGrid(FloorGridParams(half_side=4.0))
    first, last = grid.cells(np.array([low, high]))
    grid.seen[first[0] : last[0], first[1] : last[1]] = True
    return grid


def view_of(grid, pillars=(), ball=None, pose=(0.0, 0.0, 0.0)):
    known = [SeenPillar("blue_pillar", np.array(each)) for each in pillars]
    seen = None if ball is None else SeenBall(np.array(ball), np.zeros(2), 0.0)
    return TaskView(0.0, np.array(pose), known, seen, False, grid)


def vantage(view):
    return TaskPlanner(PARAMS, view, [], PARAMS.clearance).vantage()


def test_it_looks_from_where_seen_floor_ends():
    """The only end of what was seen that is not a wall lies at x = 2."""
    grid = seen_floor((-1.5, -1.0), (2.0, 1.0))
    for x in np.arange(-1.5, 2.01, 0.02):
        grid.mark(np.array([[x, -1.02], [x, 1.02]]))
    for y in np.arange(-1.02, 1.03, 0.02):
        grid.mark(np.array([[-1.52, y]]))
    grid.seen |= grid.occupied
    place = vantage(view_of(grid))
    assert 1.2 < place[0] <= 2.0 and abs(place[1]) < 1.0
    for point in (place, [0.0, 0.0]):
        assert TaskPlanner(PARAMS, view_of(grid), [], PARAMS.clearance).with_ball.is_free_at(np.array(point))


def test_there_is_nothing_to_look_at_where_all_was_seen():
    grid = FloorGrid(FloorGridParams(half_side=2.0))
    grid.seen[:] = True
    assert vantage(view_of(grid)) is None
    assert vantage(view_of(FloorGrid(FloorGridParams()))) is None  # nothing was seen: it has to look first


def test_ways_go_around_ball_and_pillars():
    grid = seen_floor((-2.0, -2.0), (2.0, 2.0))
    end = np.array([1.5, 0.0])
    for view, radius in (
        (view_of(grid, ball=(0.7, 0.0)), PARAMS.kick.ball_radius),
        (view_of(grid, pillars=[(0.7, 0.0)]), PARAMS.pillar_radius),
    ):
        path = path_to(PARAMS, view, end)
        points = np.concatenate([np.linspace(a, b, 100) for a, b in zip(path[:-1], path[1:])])
        assert np.linalg.norm(points - [0.7, 0.0], axis=1).min() > REACH + radius


@pytest.mark.parametrize("gap, is_open", [(0.60, True), (0.56, True), (0.40, False)])
def test_a_narrow_gap_is_taken_where_there_is_no_other_way(gap, is_open):
    """The robot is 0.354 wide, pillars 0.1; it wants 0.06 to both sides, and is content with 0.02."""
    wall = [(1.0, sign * (0.5 * gap + 0.1 * i)) for sign in (-1, 1) for i in range(40)]
    path = path_to(PARAMS, view_of(seen_floor((-3.0, -3.0), (3.0, 3.0)), wall), np.array([2.0, 0.0]))
    assert (path is not None) == is_open


def test_kicks_need_no_pillars_but_a_goal():
    grid = seen_floor((-2.0, -2.0), (3.0, 2.0))
    view = view_of(grid, ball=(1.0, 0.0), pose=(2.0, 0.5, 0.0))
    goal = goal_between(np.array([0.0, -0.5]), np.array([0.0, 0.5]), view.ball.position)
    assert TaskPlanner(PARAMS, view, [goal.middle], PARAMS.clearance).kick(goal, None).is_final


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("heading", [0.0, 2.0])
def test_what_was_bumped_into_is_on_the_side_that_it_drove_to(sense, heading):
    grid = FloorGrid(FloorGridParams(half_side=4.0))
    view = view_of(grid, pose=(0.5, 0.5, heading))
    mark_bump(PARAMS, view, sense)
    off = grid.centers(np.argwhere(grid.occupied)) - view.pose[:2]
    assert len(off) >= 5
    assert np.all(abs(np.linalg.norm(off, axis=1) - REACH - 0.05) < 0.04)
    assert np.all(off @ [np.cos(heading), np.sin(heading)] * sense > 0.0)


def test_a_pillar_that_is_known_is_what_was_bumped_into():
    for pillar, is_marked in (
        ((0.23, 0.0), False),
        ((0.18, 0.16), False),
        ((-0.23, 0.0), True),
        ((0.5, 0.0), True),
    ):
        view = view_of(FloorGrid(FloorGridParams()), [pillar])
        mark_bump(PARAMS, view, 1.0)
        assert view.grid.occupied.any() == is_marked, pillar
