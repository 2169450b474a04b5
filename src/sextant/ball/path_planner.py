# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Path planning on the floor: Dijkstra's algorithm (1959) on a costmap.

Obstacles are inflated by the robot's radius, so that the robot is a point. Cells near obstacles and cells
that were not observed have higher costs.
"""

from typing import Dict, List, NamedTuple, Optional, Tuple

import numpy as np
from scipy.ndimage import distance_transform_edt
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from sextant.ball.floor_grid import FloorGrid, known_box

SOFT_MARGIN = 0.12  # metres beyond the clearance with higher costs
NEAR_COST, UNSEEN_COST = 3.0, 1.0  # additional cost per metre: at the clearance, and of cells not observed
DISC_MARGIN = 0.12  # metres around a disc in which occupied cells are attributed to it
ESCAPE = 0.4  # metres around the start in which the clearance may be violated
MARGIN = 0.8  # metres around start and end
STEPS = ((1, 0), (0, 1), (1, 1), (1, -1))


class Disc(NamedTuple):
    """A round obstacle on the floor."""

    x: float  # metres, map
    y: float  # metres, map
    radius: float  # metres


class Costmap:
    """Costmap of the robot's centre on a part of the occupancy grid."""

    def __init__(
        self, grid: FloorGrid, discs: List[Disc], clearance: float, about: np.ndarray, margin: float = MARGIN
    ):
        """:param discs: round obstacles. :param clearance: from the robot's centre to obstacles, metres
        :param about: (n, 2) points that the costmap contains, with a margin (metres)
        """
        self._grid, self._box = grid, known_box(grid, about, margin)
        cell = grid.params.resolution
        self._low = np.array([part.start for part in self._box])
        occupied = grid.occupied[self._box]
        at = grid.centers(np.stack(np.indices(occupied.shape), axis=-1) + self._low)
        clearances = np.full(occupied.shape, np.inf)
        for disc in discs:
            clearances = np.minimum(
                clearances, np.hypot(at[..., 0] - disc.x, at[..., 1] - disc.y) - disc.radius
            )
        self.distance = np.minimum(clearances, _distances(occupied & (clearances > DISC_MARGIN), cell))
        self.at, self._clearance = at, clearance
        self.is_free = self.distance >= clearance
        self.is_seen = grid.seen[self._box]
        self._costs: Dict[int, Tuple[np.ndarray, np.ndarray]] = {}  # by start

    def cell(self, point: np.ndarray) -> Tuple[int, int]:
        """Row and column of a point (2,) in the map."""
        row, column = self._cells(np.asarray(point)[np.newaxis])
        return int(row[0]), int(column[0])

    def _cells(self, points: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Rows (n,) and columns (n,) of points (n, 2); points outside are clipped to the border."""
        found = np.clip(self._grid.cells(points) - self._low, 0, np.array(self.is_free.shape) - 1)
        return found[:, 0], found[:, 1]

    def contains(self, point: np.ndarray) -> bool:
        """Whether a point (2,) in the map is on the costmap."""
        half = 0.5 * self._grid.params.resolution
        return bool(np.all((point >= self.at[0, 0] - half) & (point <= self.at[-1, -1] + half)))

    def is_free_at(self, point: np.ndarray) -> bool:
        """Whether the robot's centre may be at a point (2,) in the map."""
        return self.contains(point) and bool(self.is_free[self.cell(point)])

    def is_seen_free(self, point: np.ndarray) -> bool:
        """Whether a point (2,) in the map is free and was observed."""
        return self.is_free_at(point) and bool(self.is_seen[self.cell(point)])

    def is_line_free(self, start: np.ndarray, end: np.ndarray) -> bool:
        """Whether the robot may drive straight from start to end."""
        return (
            self.contains(start)
            and self.contains(end)
            and bool(self.is_free[self._between(start, end)].all())
        )

    def _between(self, start: np.ndarray, end: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        count = 2 + int(2.0 * np.linalg.norm(end - start) / self._grid.params.resolution)
        return self._cells(np.linspace(start, end, count))

    def with_escape(self, start: np.ndarray) -> "Costmap":
        """Free the cells through which a robot too close to an obstacle may move away; returns self."""
        here = self.distance[self.cell(start)]
        if here < self._clearance:
            near = np.hypot(*np.moveaxis(self.at - start, -1, 0)) < ESCAPE
            self.is_free |= near & (self.distance >= here - 0.5 * self._grid.params.resolution)
            self._costs.clear()
        return self

    def costs(self, start: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Costs of the cheapest paths to all cells (metres; inf: none), predecessors (flat; < 0: none)."""
        first = int(np.ravel_multi_index(self.cell(start), self.is_free.shape))
        if first not in self._costs:
            costs, before = dijkstra(self._graph(), directed=False, indices=first, return_predecessors=True)
            self._costs[first] = costs.reshape(self.is_free.shape), before
        return self._costs[first]

    def _graph(self) -> csr_matrix:
        """Weighted graph of all free cells and their eight neighbours."""
        near = np.clip((self._clearance + SOFT_MARGIN - self.distance) / SOFT_MARGIN, 0.0, 1.0)
        weight = 1.0 + NEAR_COST * near + UNSEEN_COST * ~self.is_seen
        index = np.arange(self.is_free.size).reshape(self.is_free.shape)
        rows, columns, lengths = [], [], []
        for dx, dy in STEPS:
            here, there = _shifted(dx, dy)
            both = self.is_free[here] & self.is_free[there]
            rows.append(index[here][both])
            columns.append(index[there][both])
            mean = 0.5 * (weight[here] + weight[there])[both]
            lengths.append(np.hypot(dx, dy) * self._grid.params.resolution * mean)
        data = np.concatenate(lengths), (np.concatenate(rows), np.concatenate(columns))
        return csr_matrix(data, shape=(index.size, index.size))

    def path(self, start: np.ndarray, end: np.ndarray) -> Optional[np.ndarray]:
        """Corners (n, 2) of the cheapest path from start to end; None: no path."""
        goal = self.cell(end)
        if not (self.contains(start) and self.is_free_at(end)):
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
        """Remove corners where a straight line is clear."""
        kept = [0]
        while kept[-1] < len(points) - 1:
            here = kept[-1]
            last = here + 1
            while last + 1 < len(points) and self._is_clear(points[here], points[last + 1]):
                last += 1
            kept.append(last)
        return points[kept]

    def _is_clear(self, start: np.ndarray, end: np.ndarray) -> bool:
        """Whether a line is free and keeps the soft margin as well as its ends do."""
        cells = self._between(start, end)
        distance = self.distance[cells]
        least = min(self._clearance + SOFT_MARGIN, distance[0], distance[-1])
        return bool(self.is_free[cells].all() and distance.min() >= least - 1e-6)


def _distances(occupied: np.ndarray, cell: float) -> np.ndarray:
    """Distance from each cell's centre to the nearest obstacle, metres."""
    if not occupied.any():
        return np.full(occupied.shape, np.inf)
    return distance_transform_edt(~occupied) * cell - 0.5 * cell


def _shifted(dx: int, dy: int) -> Tuple[Tuple[slice, slice], Tuple[slice, slice]]:
    """Slices of all cells with a neighbour at this offset, and of these neighbours."""
    columns = slice(None, -1) if dy > 0 else slice(1, None) if dy < 0 else slice(None)
    beside = slice(1, None) if dy > 0 else slice(None, -1) if dy < 0 else slice(None)
    return (slice(None, -1) if dx else slice(None), columns), (slice(1, None) if dx else slice(None), beside)
