# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The shortest way on the floor that touches nothing: Dijkstra's algorithm (1959) on a grid.

What stands on the floor is widened by the robot's radius, so that the robot is a point. Near to things and
where nobody has looked a metre counts as more than one.
"""

from typing import Dict, List, NamedTuple, Optional, Tuple

import numpy as np
from scipy.ndimage import distance_transform_edt
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from sextant.ball.floor_grid import FloorGrid, known_box

SOFT = 0.12  # metres beyond the clearance within which a way costs more
NEAR, UNSEEN = 3.0, 1.0  # of it, per metre: where it touches, and where nobody has looked
OWN = 0.12  # metres about something round within which cells are of it
ESCAPE = 0.4  # metres about the start in which the robot may be nearer to things than it should
MARGIN = 0.8  # metres about start and end, at least
STEPS = ((1, 0), (0, 1), (1, 1), (1, -1))


class Disc(NamedTuple):
    """Something round on the floor."""

    x: float  # metres, map
    y: float
    radius: float


class FreeFloor:
    """Where the robot's middle may be."""

    def __init__(
        self,
        grid: FloorGrid,
        discs: List[Disc],
        clearance: float,
        about: np.ndarray,
        margin: float = MARGIN,
    ):
        """:param clearance: of the robot's middle to everything, metres
        :param about: (n, 2) points that have to be on it, with a margin (metres)
        """
        self._grid, self._box = grid, known_box(grid, about, margin)
        cell = grid.params.cell
        self._low = np.array([part.start for part in self._box])
        occupied = grid.occupied[self._box]
        at = grid.centers(np.stack(np.indices(occupied.shape), axis=-1) + self._low)
        apart = np.full(occupied.shape, np.inf)
        for disc in discs:
            apart = np.minimum(apart, np.hypot(at[..., 0] - disc.x, at[..., 1] - disc.y) - disc.radius)
        self.distance = np.minimum(apart, _distances(occupied & (apart > OWN), cell))
        self.at, self._clearance = at, clearance
        self.is_free = self.distance >= clearance
        self.is_seen = grid.seen[self._box]
        self._costs: Dict[int, Tuple[np.ndarray, np.ndarray]] = {}  # by start

    def cell(self, point: np.ndarray) -> Tuple[int, int]:
        """Row and column of a point (2,) of the map."""
        row, column = self._cells(np.asarray(point)[np.newaxis])
        return int(row[0]), int(column[0])

    def _cells(self, points: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """(n,) rows and columns of points (n, 2); of those outside, at the border."""
        found = np.clip(self._grid.cells(points) - self._low, 0, np.array(self.is_free.shape) - 1)
        return found[:, 0], found[:, 1]

    def holds(self, point: np.ndarray) -> bool:
        """Whether a point (2,) of the map is on it: of those beyond nothing is known."""
        half = 0.5 * self._grid.params.cell
        return bool(np.all((point >= self.at[0, 0] - half) & (point <= self.at[-1, -1] + half)))

    def allows(self, point: np.ndarray) -> bool:
        """Whether the robot's middle may be at a point (2,) of the map."""
        return self.holds(point) and bool(self.is_free[self.cell(point)])

    def knows(self, point: np.ndarray) -> bool:
        """Whether it was seen that the robot's middle may be at a point (2,) of the map."""
        return self.allows(point) and bool(self.is_seen[self.cell(point)])

    def allows_line(self, start: np.ndarray, end: np.ndarray) -> bool:
        """Whether the robot may go straight."""
        return self.holds(start) and self.holds(end) and bool(self.is_free[self._between(start, end)].all())

    def _between(self, start: np.ndarray, end: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        count = 2 + int(2.0 * np.linalg.norm(end - start) / self._grid.params.cell)
        return self._cells(np.linspace(start, end, count))

    def with_escape(self, start: np.ndarray) -> "FreeFloor":
        """Where the robot is too near to something it may go away from it. Changes this, and gives it."""
        here = self.distance[self.cell(start)]
        if here < self._clearance:
            near = np.hypot(*np.moveaxis(self.at - start, -1, 0)) < ESCAPE
            self.is_free |= near & (self.distance >= here - 0.5 * self._grid.params.cell)
            self._costs.clear()
        return self

    def costs(self, start: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Of the cheapest way to each cell, metres, inf: none; the cell before it, flat, negative: none."""
        first = int(np.ravel_multi_index(self.cell(start), self.is_free.shape))
        if first not in self._costs:
            costs, before = dijkstra(self._graph(), directed=False, indices=first, return_predecessors=True)
            self._costs[first] = costs.reshape(self.is_free.shape), before
        return self._costs[first]

    def _graph(self) -> csr_matrix:
        """Of all cells and their eight neighbours."""
        near = np.clip((self._clearance + SOFT - self.distance) / SOFT, 0.0, 1.0)
        weight = 1.0 + NEAR * near + UNSEEN * ~self.is_seen
        index = np.arange(self.is_free.size).reshape(self.is_free.shape)
        rows, columns, lengths = [], [], []
        for dx, dy in STEPS:
            here, there = _shifted(dx, dy)
            both = self.is_free[here] & self.is_free[there]
            rows.append(index[here][both])
            columns.append(index[there][both])
            mean = 0.5 * (weight[here] + weight[there])[both]
            lengths.append(np.hypot(dx, dy) * self._grid.params.cell * mean)
        data = np.concatenate(lengths), (np.concatenate(rows), np.concatenate(columns))
        return csr_matrix(data, shape=(index.size, index.size))

    def path(self, start: np.ndarray, end: np.ndarray) -> Optional[np.ndarray]:
        """(n, 2) corners of the cheapest way, from start to end; None: there is none."""
        goal = self.cell(end)
        if not (self.holds(start) and self.allows(end)):
            return None
        costs, before = self.costs(start)
        if not np.isfinite(costs[goal]):
            return None
        cells = [np.ravel_multi_index(goal, self.is_free.shape)]
        while before[cells[-1]] >= 0:
            cells.append(before[cells[-1]])
        rows = np.stack(np.unravel_index(cells[::-1], self.is_free.shape), axis=-1)
        points = self.at[tuple(rows.T)].copy()
        if len(points) == 1:
            return np.array([start, end])
        points[0], points[-1] = start, end
        return self._straightened(points)

    def _straightened(self, points: np.ndarray) -> np.ndarray:
        """Without the corners that a straight line can do without."""
        kept = [0]
        while kept[-1] < len(points) - 1:
            here = kept[-1]
            last = here + 1
            while last + 1 < len(points) and self._is_clear(points[here], points[last + 1]):
                last += 1
            kept.append(last)
        return points[kept]

    def _is_clear(self, start: np.ndarray, end: np.ndarray) -> bool:
        """Whether a line is not only allowed but as far from things as ways like to be."""
        cells = self._between(start, end)
        distance = self.distance[cells]
        least = min(self._clearance + SOFT, distance[0], distance[-1])
        return bool(self.is_free[cells].all() and distance.min() >= least - 1e-6)


def _distances(occupied: np.ndarray, cell: float) -> np.ndarray:
    """Metres from each cell's middle to the nearest thing."""
    if not occupied.any():
        return np.full(occupied.shape, np.inf)
    return distance_transform_edt(~occupied) * cell - 0.5 * cell


def _shifted(dx: int, dy: int) -> Tuple[Tuple[slice, slice], Tuple[slice, slice]]:
    """All cells with a neighbour so far away, and these neighbours."""
    columns = slice(None, -1) if dy > 0 else slice(1, None) if dy < 0 else slice(None)
    beside = slice(1, None) if dy > 0 else slice(None, -1) if dy < 0 else slice(None)
    return (slice(None, -1) if dx else slice(None), columns), (slice(1, None) if dx else slice(None), beside)
