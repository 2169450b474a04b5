# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The floor's grid, of points whose places are known."""

import numpy as np
import pytest

from sextant.ball.floor_grid import FloorGrid, FloorGridParams, known_box

HERE = np.zeros(3)
FLOOR, POST = 0.0, 0.3  # heights


def points_at(places, height, times=2):
    return np.array([[x, y, height] for x, y in places] * times)


def state(grid, place):
    """Of one place: whether it was seen, and whether something stands there."""
    at = tuple(grid.cells(np.array([place]))[0])
    return bool(grid.seen[at]), bool(grid.occupied[at])


def test_what_stands_there_does_so_from_the_second_look_on():
    grid = FloorGrid(FloorGridParams())
    for occupied in (False, True):
        grid.update(points_at([(1.0, 0.5)], POST), HERE)
        assert state(grid, (1.0, 0.5)) == (True, occupied)
    assert grid.occupied.sum() == grid.seen.sum() == 1


def test_points_are_taken_from_the_robot_to_the_map():
    grid = FloorGrid(FloorGridParams())
    for _ in range(2):
        grid.update(points_at([(1.0, 0.5)], POST), np.array([2.0, 3.0, 0.5 * np.pi]))
    assert state(grid, (2.0 - 0.5, 3.0 + 1.0)) == (True, True)


def test_an_obstacle_is_gone_after_the_floor_is_seen_there():
    """However long it was seen: most looks count."""
    params = FloorGridParams()
    grid = FloorGrid(params)
    for _ in range(50):
        grid.update(points_at([(1.0, 0.0)], POST), HERE)
    for i in range(params.max_evidence - 1):
        assert state(grid, (1.0, 0.0)) == (True, True), i
        grid.update(points_at([(1.0, 0.0)], FLOOR), HERE)
    assert state(grid, (1.0, 0.0)) == (True, False)


def test_a_mark_stays_until_the_floor_is_seen_there():
    grid = FloorGrid(FloorGridParams())
    grid.mark(np.array([[0.5, 0.5], [0.6, 0.5]]))
    assert state(grid, (0.5, 0.5))[1] and state(grid, (0.6, 0.5))[1]
    for _ in range(8):
        grid.update(points_at([(0.5, 0.5)], FLOOR), HERE)
    assert not state(grid, (0.5, 0.5))[1] and state(grid, (0.6, 0.5))[1]


@pytest.mark.parametrize(
    "point",
    [
        (1.0, 0.0, 0.1),  # a ball's height
        (1.0, 0.0, 0.7),  # above the robot
        (1.0, 0.0, -0.3),
        (0.1, 0.1, POST),  # the robot's own
        (3.1, 0.0, POST),
        (np.nan, 0.0, POST),
        (1.0, 0.0, np.nan),
    ],
)
def test_points_that_do_not_count(point):
    grid = FloorGrid(FloorGridParams())
    grid.update(np.array([point] * 3), HERE)
    assert not grid.seen.any() and not grid.evidence.any()


def test_nothing_and_points_beyond_the_map_do_not_count():
    grid = FloorGrid(FloorGridParams(half_side=2.0))
    grid.update(np.zeros((0, 3)), HERE)
    grid.update(points_at([(2.5, 0.0)], POST), HERE)
    assert not grid.seen.any()


def test_cells_and_their_centers():
    grid = FloorGrid(FloorGridParams(resolution=0.1, half_side=1.0))
    points = np.random.default_rng(0).uniform(-1.0, 1.0, (200, 2))
    assert abs(grid.centers(grid.cells(points)) - points).max() <= 0.05 + 1e-9
    assert grid.cells(np.array([[-5.0, 5.0]])).tolist() == [[0, 19]]


def test_the_known_box_holds_what_was_seen_and_the_points():
    grid = FloorGrid(FloorGridParams())
    rows, columns = known_box(grid, np.array([[0.0, 0.0]]), 0.5)
    assert (rows, columns) == (slice(150, 171), slice(150, 171))
    grid.update(points_at([(2.02, -1.02)], FLOOR), HERE)
    rows, columns = known_box(grid, np.array([[0.0, 0.0]]), 0.5)
    assert (rows, columns) == (slice(150, 201), slice(139, 171))


def test_a_grid_about_another_middle_is_the_same_moved():
    middle, points = np.array([20.0, -7.0]), points_at([[1.0, 0.0], [2.0, 0.5]], 0.3)
    here, there = FloorGrid(FloorGridParams()), FloorGrid(FloorGridParams(), middle)
    for grid, place in ((here, np.zeros(2)), (there, middle)):
        for _ in range(2):
            grid.update(points, np.array([*place, 0.3]))
    assert here.occupied.any()
    np.testing.assert_array_equal(here.evidence, there.evidence)
    np.testing.assert_allclose(there.centers(np.array([[3, 5]])) - middle, here.centers(np.array([[3, 5]])))
