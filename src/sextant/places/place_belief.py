# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the robot may be, carried on from picture to picture: a discrete Bayes filter over a map's places.

One state is "nowhere that the map knows". Between pictures the belief spreads along neighbouring places, or
as far as odometry says; a small part of it starts anew everywhere, so that a robot that was carried away is
found again (Thrun, Burgard, Fox: Probabilistic Robotics, 2005, chapters 4.1 and 8.3).
"""

from dataclasses import dataclass
from typing import List, NamedTuple, Optional

import numpy as np
from scipy.sparse import csr_matrix
from scipy.spatial import cKDTree

from sextant.base.strict_params import ParamError, StrictParams, param, within

ROUND = 0.1  # of a spacing: distances that differ by less are moved by as one
REMEMBERED = 64  # ways to move, by distance
PAIRS = 16_000_000  # of places, that a way to move, or all that are remembered, go between: some 200 MB


@dataclass(frozen=True)
class BeliefParams(StrictParams):
    """How a robot moves among the places, and how far pictures are believed."""

    reach: float = param(4.0, within(1, 20))  # spacings of places between two pictures, without odometry
    restart: float = param(0.01, within(0, 1))  # probability of being carried between two pictures
    leave: float = param(0.01, within(0, 1))  # that it left for where the map knows nothing
    nowhere: float = param(0.5, within(0, 1))  # that it is there at first; 0: never, leave must be 0, too
    trust: float = param(0.6, within(1e-6, 1))  # share of evidence that counts: successive pictures err alike
    doubt: float = param(2.0, within(0, 20))  # subtracted from log ratios: a wrong place may match for long
    distance_noise: float = param(0.1, within(0.001, 1))  # deviation of odometry's distance, share of it
    radius: float = param(2.2, within(0, 20))  # spacings within which places are one answer

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.leave and not self.nowhere:
            raise ParamError("leave", "must be 0 where nowhere is 0", self.leave)
        if self.restart + self.leave > 1:
            raise ParamError("restart + leave", "must be at most 1", self.restart + self.leave)


class BeliefPeak(NamedTuple):
    """An answer: a place, and how probable it is that the robot is there or at one of those around it."""

    place: int
    probability: float
    around: np.ndarray  # int (m,) places that are counted in, itself too


class PlaceBelief:
    """Probabilities of all places and of nowhere; they sum to 1."""

    def __init__(self, positions: np.ndarray, params: Optional[BeliefParams] = None):
        """:param positions: (n, 2) of the places, in any unit; that of the distances given to move()"""
        self._params = params or BeliefParams()
        self._positions = np.asarray(positions, float).reshape(-1, 2)
        self._tree = cKDTree(self._positions)
        self.spacing = self._spacing()
        self._ways = {}
        self.reset()

    def reset(self) -> None:
        """Nothing is known."""
        count = len(self._positions)
        self.nowhere = self._params.nowhere
        self.places = np.full(count, (1 - self.nowhere) / count)  # (n,)

    def move(self, distance: Optional[float] = None) -> None:
        """Carries the belief on to the next picture.

        :param distance: since the last one, by odometry; None: there is none
        """
        params, count = self._params, len(self._positions)
        way = self._way(distance)
        moved = np.full(count, self.places.sum() / count) if way is None else way.T @ self.places
        stay, back = 1 - params.restart - params.leave, params.restart / count
        self.places = stay * moved + back * (self.places.sum() + self.nowhere)
        self.nowhere = max(1 - self.places.sum(), 0.0) if params.nowhere else 0.0

    def see(self, log_ratios: np.ndarray, voted: bool = True) -> None:
        """Weighs the places by what a picture says.

        :param log_ratios: (n,) log of how much likelier the picture is at each place than nowhere
        :param voted: False: it only tells places apart, which is no reason to doubt all of them
        """
        doubt = self._params.doubt if voted else 0.0
        trusted = self._params.trust * (np.asarray(log_ratios, float) - doubt)
        with np.errstate(divide="ignore"):  # logs of 0: what is impossible stays so
            logs = np.log(np.append(self.places, self.nowhere)) + np.append(trusted, 0.0)
        weights = np.exp(logs - logs.max())  # the largest of what is possible: the sum is never 0
        weights /= weights.sum()
        self.places, self.nowhere = weights[:-1], float(weights[-1])

    def hypotheses(self, count: int) -> List[BeliefPeak]:
        """The most probable places, each with those around it that no better one has; most probable first."""
        free = self.places.copy()
        found = []
        for _ in range(min(count, len(free))):
            place = int(free.argmax())
            if free[place] <= 0:
                break
            reach = self._tree.query_ball_point(self._positions[place], self._params.radius * self.spacing)
            around = np.array([each for each in sorted(reach) if free[each] > 0], int)
            found.append(BeliefPeak(place, float(free[around].sum()), around))
            free[around] = 0
        return sorted(found, key=lambda each: -each.probability)

    def _spacing(self) -> float:
        """Median distance of a place to the nearest other."""
        if len(self._positions) < 2:
            return 1.0
        nearest = self._tree.query(self._positions, 2)[0][:, 1]
        apart = nearest[nearest > 0]
        return float(np.median(apart)) if len(apart) else 1.0

    def _way(self, distance: Optional[float]) -> Optional[csr_matrix]:
        """(n, n): row i holds where a robot at place i is next; None: anywhere."""
        step = None if distance is None else round(distance / (ROUND * self.spacing))
        if step not in self._ways:
            way = self._transition(None if step is None else step * ROUND * self.spacing)
            pairs = sum(each.nnz for each in (way, *self._ways.values()) if each is not None)
            if len(self._ways) >= REMEMBERED or pairs > PAIRS:
                self._ways.clear()
            self._ways[step] = way
        return self._ways[step]

    def _transition(self, distance: Optional[float]) -> Optional[csr_matrix]:
        sigma, centre = self.spacing * self._params.reach / 2, 0.0
        if distance is not None:
            # half a spacing: a place stands for its surroundings
            sigma, centre = np.hypot(self.spacing / 2, self._params.distance_noise * distance), distance
        count, farthest = len(self._positions), centre + 3 * sigma
        if self._tree.count_neighbors(self._tree, farthest) > PAIRS:  # a leap of odometry on a large map
            return None
        pairs = self._tree.sparse_distance_matrix(self._tree, farthest, output_type="coo_matrix")
        others = pairs.row != pairs.col
        rows = np.concatenate([pairs.row[others], np.arange(count)])
        columns = np.concatenate([pairs.col[others], np.arange(count)])
        distances = np.concatenate([pairs.data[others], np.zeros(count)])
        weights = np.exp(-0.5 * ((distances - centre) / sigma) ** 2) + 1e-9
        matrix = csr_matrix((weights, (rows, columns)), (count, count))
        return matrix.multiply(1 / matrix.sum(axis=1)).tocsr()
