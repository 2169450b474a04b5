# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is known of the floor: where it was seen, and where something stands on it (an occupancy grid)."""

from dataclasses import dataclass
from typing import Tuple

import numpy as np

from sextant.base.strict_params import ParamError, StrictParams, param, within
from sextant.geometry.plane_poses import rotation

NO_OFFSET = np.zeros(2)


@dataclass(frozen=True)
class FloorGridParams(StrictParams):
    """Of the grid, and of the points that count in it."""

    cell: float = param(0.05, within(0.01, 1))  # metres
    half_side: float = param(8.0, within(1, 100))  # metres from its middle
    nearest: float = param(0.2, within(0, 100))  # metres; points nearer to the robot do not count
    farthest: float = param(3.0, within(1e-9, 100))
    floor: float = param(0.05, within(0, 1))  # metres; points this little above or below the floor are of it
    low: float = param(0.13, within(0, 10))  # metres; what is lower is no obstacle: a ball may lie there
    high: float = param(0.6, within(0, 10))  # the robot's height
    most: int = param(8, within(1, 100))  # looks that are remembered of a cell

    def __post_init__(self) -> None:
        super().__post_init__()
        for less, more in (("nearest", "farthest"), ("floor", "low"), ("low", "high")):
            if getattr(self, less) >= getattr(self, more):
                raise ParamError(less, "must be less than", getattr(self, less), more)


class FloorGrid:
    """Cells of the map; each look at one counts for or against something that stands there."""

    def __init__(self, params: FloorGridParams, middle: np.ndarray = NO_OFFSET):
        """:param middle: (2,) metres, map: where the robot begins

        :raises ValueError: a parameter out of range
        """
        self.params = params
        self._low = np.asarray(middle) - params.half_side
        side = round(2.0 * params.half_side / params.cell)
        self.evidence = np.zeros((side, side), np.int16)  # > 0: something stands there; < 0: floor
        self.seen = np.zeros((side, side), bool)

    def look(self, points: np.ndarray, pose: np.ndarray) -> None:
        """What one depth image shows; points beyond the map, and those that are NaN, do not count.

        :param points: (n, 3) metres, robot frame, z up. :param pose: (3,) x, y, heading of the robot, map
        """
        params = self.params
        away = np.hypot(points[:, 0], points[:, 1])
        points = points[(away >= params.nearest) & (away <= params.farthest)]
        at = points[:, :2] @ rotation(pose[2]).T + pose[:2]
        high = points[:, 2]
        stands = self._counted(at[(high >= params.low) & (high <= params.high)]) >= 2
        floor = self._counted(at[abs(high) <= params.floor]) >= 1
        self.evidence += stands
        self.evidence -= floor & ~stands
        np.clip(self.evidence, -params.most, params.most, out=self.evidence)
        self.seen |= floor | stands

    def cells(self, points: np.ndarray) -> np.ndarray:
        """(n, 2) row and column of points (n, 2) of the map; those outside are put to the border."""
        at = np.floor((np.asarray(points) - self._low) / self.params.cell).astype(int)
        return np.clip(at, 0, len(self.seen) - 1)

    def centers(self, cells: np.ndarray) -> np.ndarray:
        """(n, 2) metres, map, of cells (n, 2)."""
        return (np.asarray(cells) + 0.5) * self.params.cell + self._low

    @property
    def occupied(self) -> np.ndarray:
        """(side, side) bool; the first index goes along x"""
        return self.evidence >= 2

    def mark(self, points: np.ndarray) -> None:
        """Something that was not seen may stand at points (n, 2) of the map, until floor is seen there."""
        self.evidence[tuple(self.cells(points).T)] = self.params.most

    def _counted(self, points: np.ndarray) -> np.ndarray:
        counts = np.zeros(self.seen.shape, np.int32)
        inside = (abs(points - self._low - self.params.half_side) < self.params.half_side).all(axis=1)
        np.add.at(counts, tuple(self.cells(points[inside]).T), 1)
        return counts


def known_box(grid: FloorGrid, points: np.ndarray, margin: float) -> Tuple[slice, slice]:
    """The part of the grid that holds all that was seen, and some points with a margin in metres."""
    at = np.concatenate([grid.cells(points - margin), grid.cells(points + margin), np.argwhere(grid.seen)])
    low, high = at.min(axis=0), at.max(axis=0) + 1
    return slice(low[0], high[0]), slice(low[1], high[1])
