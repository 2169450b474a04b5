# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Occupancy grid of the floor from depth images."""

from dataclasses import dataclass
from typing import Tuple

import numpy as np

from sextant.base.strict_params import ParamError, StrictParams, also, param, within
from sextant.geometry.plane_poses import rotation

NO_OFFSET = np.zeros(2)


@dataclass(frozen=True)
class FloorGridParams(StrictParams):
    """Size of the grid, and ranges and heights of the points inserted into it."""

    resolution: float = param(0.05, "cell size of the occupancy grid", within(0.01, 1), "m")
    half_side: float = param(
        8.0, "distance from the robot's start to the border of the grid", within(1, 100), "m"
    )
    min_range: float = param(
        0.2,
        "points closer to the robot's centre are ignored",
        also(within(0, 100), "less than `max_range`"),
        "m",
    )
    max_range: float = param(
        3.0, "points farther from the robot's centre are ignored", within(1e-9, 100), "m"
    )
    floor_tolerance: float = param(
        0.05,
        "points up to this height above or below the floor count as floor",
        also(within(0, 1), "less than `min_obstacle_height`"),
        "m",
    )
    min_obstacle_height: float = param(
        0.13,
        "minimum height of an obstacle; the ball must be lower",
        also(within(0, 10), "more than the ball's diameter, less than `max_obstacle_height`"),
        "m",
    )
    max_obstacle_height: float = param(
        0.6,
        "maximum height of an obstacle: the robot's height; higher points are ignored",
        within(0, 10),
        "m",
    )
    max_evidence: int = param(8, "maximum evidence of a cell, in images", within(1, 100))

    def __post_init__(self) -> None:
        super().__post_init__()
        for less, more in (
            ("min_range", "max_range"),
            ("floor_tolerance", "min_obstacle_height"),
            ("min_obstacle_height", "max_obstacle_height"),
        ):
            if getattr(self, less) >= getattr(self, more):
                raise ParamError(less, "must be less than", getattr(self, less), more)


class FloorGrid:
    """Evidence for occupied and free cells in the map frame; each depth image counts once per cell."""

    def __init__(self, params: FloorGridParams, center: np.ndarray = NO_OFFSET):
        """:param center: (2,) metres, map

        :raises ValueError: a parameter out of range
        """
        self.params = params
        self._low = np.asarray(center) - params.half_side
        side = round(2.0 * params.half_side / params.resolution)
        self.evidence = np.zeros((side, side), np.int16)  # > 0: occupied; < 0: free
        self.seen = np.zeros((side, side), bool)

    def update(self, points: np.ndarray, pose: np.ndarray) -> None:
        """Insert the points of one depth image; points outside the grid and NaN are ignored.

        :param points: (n, 3) metres, robot frame, z up. :param pose: (3,) x, y, heading of the robot, map
        """
        params = self.params
        away = np.hypot(points[:, 0], points[:, 1])
        points = points[(away >= params.min_range) & (away <= params.max_range)]
        at = points[:, :2] @ rotation(pose[2]).T + pose[:2]
        height = points[:, 2]
        is_obstacle = (height >= params.min_obstacle_height) & (height <= params.max_obstacle_height)
        occupied = self._counts(at[is_obstacle]) >= 2
        free = self._counts(at[abs(height) <= params.floor_tolerance]) >= 1
        self.evidence += occupied
        self.evidence -= free & ~occupied
        np.clip(self.evidence, -params.max_evidence, params.max_evidence, out=self.evidence)
        self.seen |= free | occupied

    def cells(self, points: np.ndarray) -> np.ndarray:
        """Row and column (n, 2) of points (n, 2) in the map; points outside are clipped to the border."""
        at = np.floor((np.asarray(points) - self._low) / self.params.resolution).astype(int)
        return np.clip(at, 0, len(self.seen) - 1)

    def centers(self, cells: np.ndarray) -> np.ndarray:
        """Centres (n, 2) of cells (n, 2), metres, map."""
        return (np.asarray(cells) + 0.5) * self.params.resolution + self._low

    @property
    def occupied(self) -> np.ndarray:
        """Occupied cells (side, side), bool; the first index is along x."""
        return self.evidence >= 2

    def mark(self, points: np.ndarray) -> None:
        """Mark points (n, 2) in the map as occupied until floor is observed there."""
        self.evidence[tuple(self.cells(points).T)] = self.params.max_evidence

    def _counts(self, points: np.ndarray) -> np.ndarray:
        counts = np.zeros(self.seen.shape, np.int32)
        inside = (abs(points - self._low - self.params.half_side) < self.params.half_side).all(axis=1)
        np.add.at(counts, tuple(self.cells(points[inside]).T), 1)
        return counts


def known_box(grid: FloorGrid, points: np.ndarray, margin: float) -> Tuple[slice, slice]:
    """Slices of the grid that contain all observed cells and some points (n, 2) with a margin in metres."""
    at = np.concatenate([grid.cells(points - margin), grid.cells(points + margin), np.argwhere(grid.seen)])
    low, high = at.min(axis=0), at.max(axis=0) + 1
    return slice(low[0], high[0]), slice(low[1], high[1])
