# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Ways on the floor: their lengths in closed form, and how far they are from things."""

import numpy as np
import pytest

from sextant.ball.floor_grid import FloorGrid, FloorGridParams
from sextant.ball.path_planner import Costmap, Disc

CLEARANCE = 0.24
CELL = 0.05


def seen_grid(half=2.0):
    grid = FloorGrid(FloorGridParams(half_side=4.0))
    low, high = grid.cells(np.array([[-half, -half], [half, half]]))
    grid.seen[low[0] : high[0], low[1] : high[1]] = True
    return grid


def floor_of(grid, discs=(), about=((-1.5, 0.0), (1.5, 0.0)), clearance=CLEARANCE):
    return Costmap(grid, list(discs), clearance, np.array(about))


def length(path):
    return np.linalg.norm(np.diff(path, axis=0), axis=1).sum()


def along(path, spacing=0.005):
    """Points of a way, close to one another."""
    for start, end in zip(path[:-1], path[1:]):
        yield from np.linspace(start, end, 2 + int(np.linalg.norm(end - start) / spacing))


def room(grid, half=1.0):
    """Walls about the origin."""
    side = np.arange(-half, half + 1e-9, 0.5 * CELL)
    for x, y in ((side, half), (side, -half), (half, side), (-half, side)):
        grid.mark(np.stack(np.broadcast_arrays(x, y), axis=1))


def test_a_free_way_is_straight():
    for end in ([1.5, 0.0], [1.2, 0.9], [-0.3, -1.1]):
        start = np.array([-1.5, 0.0])
        path = floor_of(seen_grid(), about=(start, end)).path(start, np.array(end))
        np.testing.assert_allclose(path, [start, end])


@pytest.mark.parametrize("aside", [0.0, 0.1, -0.2])
@pytest.mark.parametrize("radius", [0.05, 0.3])
def test_a_way_around_a_disc_is_tangent_arc_tangent(radius, aside):
    """No shorter than the shortest way around it with clearance, no longer than around it as far as it
    wants to be away from it; both within the grid's error."""
    start, end = np.array([-1.5, 0.0]), np.array([1.5, 0.0])
    path = floor_of(seen_grid(), [Disc(0.0, aside, radius)]).path(start, end)

    def around(r):
        d = np.hypot(1.5, aside)
        arc = 2.0 * (np.arcsin(1.5 / d) - np.arccos(r / d))  # the turn between the tangents, on the near side
        return 2.0 * np.sqrt(d**2 - r**2) + r * max(arc, 0.0)

    least = around(radius + CLEARANCE)
    assert least - 0.03 <= length(path) <= 1.06 * around(radius + CLEARANCE + 0.12) + 0.03
    assert min(np.hypot(*(point - [0.0, aside])) for point in along(path)) >= radius + CLEARANCE - CELL


@pytest.mark.parametrize("seed", range(12))
def test_ways_keep_their_clearance(seed):
    """From every disc and every cell, computed without the planner."""
    random = np.random.default_rng(seed)
    grid, start, end = seen_grid(), np.array([-1.6, -1.0]), np.array([1.6, 1.0])
    discs = [Disc(*random.uniform(-1.0, 1.0, 2), 0.05) for _ in range(4)]
    posts = random.uniform(-1.0, 1.0, (3, 2))
    grid.mark(posts)
    cells = grid.centers(np.argwhere(grid.occupied))
    path = floor_of(grid, discs, (start, end)).path(start, end)
    assert path is not None
    np.testing.assert_allclose(path[[0, -1]], [start, end])
    for point in along(path):
        for disc in discs:
            assert np.hypot(point[0] - disc.x, point[1] - disc.y) >= disc.radius + CLEARANCE - CELL
        for cell in cells:
            of_disc = min(np.hypot(cell[0] - d.x, cell[1] - d.y) - d.radius for d in discs) <= 0.12
            assert of_disc or np.hypot(*(point - cell)) >= CLEARANCE - CELL


def test_no_way_leads_out_of_a_closed_room():
    grid = seen_grid()
    room(grid)
    floor = floor_of(grid)
    assert floor.path(np.zeros(2), np.array([1.5, 0.0])) is None
    assert floor.path(np.zeros(2), np.array([0.5, 0.5])) is not None
    assert np.isinf(floor.costs(np.zeros(2))[0][floor.cell(np.array([1.5, 1.5]))])


def test_no_way_leads_onto_something_or_through_a_gap_that_is_too_narrow():
    wall = [Disc(0.0, y, 0.05) for y in np.arange(-3.0, 3.01, 0.1) if abs(y) > 0.35]
    start, end = np.array([-1.5, 0.0]), np.array([1.5, 0.0])
    assert floor_of(seen_grid(), wall, clearance=0.2).path(start, end) is not None  # the gap: 0.8 - 2 * 0.05
    assert floor_of(seen_grid(), wall, clearance=0.42).path(start, end) is None
    assert floor_of(seen_grid(), wall, clearance=0.2).path(start, np.array([0.0, 1.0])) is None


def test_a_way_of_no_length():
    here = np.array([0.31, 0.21])
    path = floor_of(seen_grid()).path(here, here)
    assert len(path) == 2 and length(path) < CELL


def test_a_robot_that_stands_too_near_comes_away():
    disc, start = Disc(0.0, 0.0, 0.05), np.array([0.2, 0.0])  # 0.15 from it, less than CLEARANCE
    end = np.array([1.5, 0.0])
    assert floor_of(seen_grid(), [disc]).path(start, end) is None
    path = floor_of(seen_grid(), [disc]).with_escape(start).path(start, end)
    assert length(path) == pytest.approx(1.3, abs=0.02)
    around = floor_of(seen_grid(), [disc]).with_escape(start).path(start, -end)
    assert min(np.hypot(*point) for point in along(around)) >= 0.2 - CELL  # never nearer than it stood


def test_seen_floor_is_preferred():
    """A metre that was not seen counts twice: where a way around is shorter than that, it is taken."""
    grid = seen_grid()
    middle, half = grid.cells(np.zeros((1, 2)))[0], 3
    grid.seen[middle[0] - 10 : middle[0] + 10, middle[1] - half : middle[1] + half] = False
    path = floor_of(grid).path(np.array([-1.5, 0.0]), np.array([1.5, 0.0]))
    cells, _ = floor_of(grid).costs(np.array([-1.5, 0.0]))
    cost = cells[floor_of(grid).cell(np.array([1.5, 0.0]))]
    assert 3.0 <= length(path) < cost < 4.0


def test_costs_are_lengths_where_all_is_seen_and_free():
    """Within the eight directions of a grid, whose ways are up to 8.24 % longer."""
    start = np.array([0.02, 0.02])
    floor = floor_of(seen_grid())
    costs, _ = floor.costs(start)
    for end in np.random.default_rng(0).uniform(-1.4, 1.4, (30, 2)):
        if np.all(abs(end) < 0.75):
            straight = np.hypot(*(end - start))
            assert straight - CELL <= costs[floor.cell(end)] <= 1.0824 * straight + 2.0 * CELL


def test_allows_line():
    floor = floor_of(seen_grid(), [Disc(0.0, 0.0, 0.05)])
    assert not floor.is_free_at(np.array([0.2, 0.0])) and floor.is_free_at(np.array([0.4, 0.0]))
    assert not floor.is_line_free(np.array([-1.0, 0.1]), np.array([1.0, 0.1]))
    assert floor.is_line_free(np.array([-1.0, 0.4]), np.array([1.0, 0.4]))


def test_of_what_is_beyond_the_floor_nothing_is_known():
    """The grid ends at 4 m: a pillar beyond it must not be driven through."""
    floor = floor_of(seen_grid(), [Disc(4.5, 0.0, 0.05)])
    beyond = np.array([5.0, 0.0])
    assert not (floor.contains(beyond) or floor.is_free_at(beyond) or floor.is_seen_free(beyond))
    assert floor.path(np.zeros(2), beyond) is None and floor.path(beyond, np.zeros(2)) is None
    assert not floor.is_line_free(np.zeros(2), beyond)


def test_the_floor_holds_a_margin_about_its_points():
    grid = seen_grid(0.5)
    near = Costmap(grid, [], CLEARANCE, np.zeros((1, 2)))
    far = Costmap(grid, [], CLEARANCE, np.zeros((1, 2)), 1.5)
    assert not near.contains([1.4, 0.0]) and far.contains([1.4, 0.0])
