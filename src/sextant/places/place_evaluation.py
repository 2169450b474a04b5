# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How good a map of places is: queries whose places are known are localized, in their order, and compared."""

import gc
import os
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Dict, List, NamedTuple, Sequence, Tuple

import numpy as np
from scipy.stats import chi2
from tqdm import tqdm

from sextant.place_maps.place_map import Photo, PlaceMap
from sextant.places.place_index import PlaceIndex, decode_photo, photo_features
from sextant.places.place_library import Library
from sextant.places.place_localization import Localization, PlaceLocalizationParams, PlaceLocalizer, Status
from sextant.places.place_metrics import (
    PrecisionRecall,
    calibration_error,
    perfect_calibration_error,
    precision_recall,
    recall_at,
)
from sextant.places.place_queries import Query, left_out_queries, pixels_of

RANKS = (1, 5, 10)  # of recall
ELLIPSE = 0.95
ONE_BY_ONE = ("single", "votes")  # modes in which no picture depends on another

_NOTHING = np.zeros((240, 320), np.uint8)


class Outcome(NamedTuple):
    """What was said of a query."""

    query: Query
    found: Localization
    seconds: float  # from the picture to the answer

    @property
    def rank(self) -> float:
        """Of the first right answer, from 1 on; inf: there is none."""
        photos = [answer.photo for answer in self.found.answers]
        right = [n for n, photo in enumerate(photos, 1) if (photo.x, photo.y) in self.query.right]
        return right[0] if right else np.inf


class Cost(NamedTuple):
    """Of a map's index."""

    seconds: float  # until the first picture can be asked for
    is_loaded: bool  # from the cache, as it was
    index_bytes: int
    resident_bytes: int  # by how much the process grew, to the end of the queries


@dataclass(frozen=True)
class PlaceEvaluation:
    """Figures; nan where there is nothing to measure."""

    outcomes: Sequence[Outcome]
    pixels: np.ndarray  # (2,) metres a pixel of the overview; (1, 1) where nobody knows
    cost: Cost

    @property
    def ranks(self) -> np.ndarray:
        """Of the first right answers, of the queries that are in the map."""
        return np.array([each.rank for each in self.outcomes if each.query.right])

    def recall(self, n: int) -> float:
        """Of the queries that are in the map: those with a right answer among the n best."""
        return recall_at(n, self.ranks) if len(self.ranks) else np.nan

    @property
    def said(self) -> Tuple[np.ndarray, np.ndarray]:
        """Probabilities of the best answers, and whether they are right; one of nowhere is wrong."""
        answered = [each for each in self.outcomes if each.found.answers]
        probabilities = [each.found.answers[0].probability for each in answered]
        return np.array(probabilities), np.array([each.rank == 1 for each in answered], bool)

    @property
    def curve(self) -> PrecisionRecall:
        """The more probable, the more confident."""
        probabilities, right = self.said
        if not len(self.ranks) or not len(right):
            return PrecisionRecall(np.zeros(0), np.zeros(0), np.nan if not len(self.ranks) else 0.0)
        return precision_recall(probabilities, right, len(self.ranks))

    @property
    def calibration_error(self) -> float:
        """Expected, over bins of equal mass."""
        return calibration_error(*self.said) if len(self.said[0]) else np.nan

    @property
    def perfect_calibration_error(self) -> float:
        """At most, in 19 of 20 cases, with probabilities that are true."""
        return perfect_calibration_error(self.said[0]) if len(self.said[0]) else np.nan

    def nowhere(self, is_in_map: bool) -> float:
        """Share of the queries that are in the map, or not, of which "nowhere" is said."""
        asked = [each for each in self.outcomes if bool(each.query.right) == is_in_map]
        return float(np.mean([each.found.status == Status.NOWHERE for each in asked])) if asked else np.nan

    @property
    def position_errors(self) -> np.ndarray:
        """(m, 2) of the estimates, along x and y, metres or pixels."""
        errors = [
            (each.found.estimate.x - each.query.position[0], each.found.estimate.y - each.query.position[1])
            for each in self._estimated()
        ]
        return np.array(errors).reshape(-1, 2) * self.pixels

    @property
    def in_ellipse(self) -> float:
        """Share of the estimates whose 95 % ellipse holds the truth."""
        errors = self.position_errors / self.pixels
        covariances = [each.found.estimate.covariance for each in self._estimated()]
        squares = [error @ np.linalg.solve(C, error) for error, C in zip(errors, covariances)]
        return float(np.mean(np.array(squares) <= chi2.ppf(ELLIPSE, 2))) if squares else np.nan

    def _estimated(self) -> List[Outcome]:
        return [each for each in self.outcomes if each.found.estimate and each.query.position]

    @property
    def seconds(self) -> np.ndarray:
        """(queries,)"""
        return np.array([each.seconds for each in self.outcomes])

    def figures(self) -> Dict[str, float]:
        """All of them by name."""
        errors = np.linalg.norm(self.position_errors, axis=1)
        return {
            "queries": len(self.outcomes),
            "nowhere": len(self.outcomes) - len(self.ranks),
            **{f"recall@{n}": self.recall(n) for n in RANKS},
            "area": self.curve.area,
            "calibration_error": self.calibration_error,
            "perfect_calibration_error": self.perfect_calibration_error,
            "said_nowhere_wrongly": self.nowhere(True),
            "said_nowhere_rightly": self.nowhere(False),
            "estimates": len(errors),
            "position_error": _quantile(errors, 0.5),
            "position_error_90": _quantile(errors, 0.9),
            "in_ellipse": self.in_ellipse,
            "query_ms": 1e3 * _quantile(self.seconds, 0.5),
            "query_ms_95": 1e3 * _quantile(self.seconds, 0.95),
            "index_seconds": self.cost.seconds,
            "index_mb": self.cost.index_bytes / 1e6,
            "resident_mb": self.cost.resident_bytes / 1e6,
        }


def evaluate(library: Library, params: PlaceLocalizationParams, queries: Sequence[Query]) -> PlaceEvaluation:
    """Localizes the queries one after the other.

    :raises OSError: a picture cannot be read
    :raises ValueError: a parameter, photos or queries that cannot be used, by name
    """
    _check(queries)
    begun = _begin(library, params)
    outcomes = [_outcome(begun.index, begun.localizer, query) for query in _progress(queries)]
    return begun.evaluation(library.place_map, outcomes)


def evaluate_left_out(library: Library, params: PlaceLocalizationParams, tolerance: float) -> PlaceEvaluation:
    """Every photo of the map is a query to the map and the index without it.

    :param tolerance: as places_near()
    :raises: as evaluate()
    """
    if params.mode not in ONE_BY_ONE:
        raise ValueError(f"mode is '{params.mode}', photos are left out in {' or '.join(ONE_BY_ONE)} only")
    trials = list(left_out_queries(library.place_map, tolerance))
    if len(trials) < 2:
        raise ValueError(f"{library.map_path}: of less than two photos none can be left out")
    begun = _begin(library, params)
    outcomes = [_left_out(begun, *trial) for trial in _progress(trials)]
    return begun.evaluation(library.place_map, outcomes)


class _Begun(NamedTuple):
    """What queries are asked of."""

    index: PlaceIndex
    params: PlaceLocalizationParams
    localizer: PlaceLocalizer
    cost: Cost  # its resident bytes: those of the process before it

    def evaluation(self, place_map: PlaceMap, outcomes: Sequence[Outcome]) -> PlaceEvaluation:
        grown = resident_bytes() - self.cost.resident_bytes
        return PlaceEvaluation(outcomes, pixels_of(place_map), self.cost._replace(resident_bytes=grown))


def _begin(library: Library, params: PlaceLocalizationParams) -> _Begun:
    before, begin, told = resident_bytes(), time.perf_counter(), []

    def report(line: str) -> None:
        told.append(line)
        library.report(line)

    params = replace(params, max_places=max(RANKS))
    index = replace(library, report=report).index()
    localizer = _ready(PlaceLocalizer(library.place_map, index, params))
    cost = Cost(time.perf_counter() - begin, not told, index.bytes, before)
    return _Begun(index, params, localizer, cost)


def _left_out(begun: _Begun, photo: Photo, others: PlaceMap, query: Query) -> Outcome:
    index = begun.index
    index.remove([each for each in index.photos if each.image == photo.image])
    outcome = _outcome(index, _ready(PlaceLocalizer(others, index, begun.params)), query)
    index.add([photo.image], [photo_features(index.params, query.path)])
    return outcome


def resident_bytes() -> int:
    """Of this process."""
    gc.collect()
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE")


def _quantile(values: np.ndarray, share: float) -> float:
    return float(np.quantile(values, share)) if len(values) else np.nan


def _ready(localizer: PlaceLocalizer) -> PlaceLocalizer:
    localizer.localize(_NOTHING)  # OpenCV's matchers learn when they are asked first
    localizer.reset()
    return localizer


def _outcome(index: PlaceIndex, localizer: PlaceLocalizer, query: Query) -> Outcome:
    image = decode_photo(index.params, query.path.read_bytes(), query.path)
    begin = time.perf_counter()
    found = localizer.localize(image)
    return Outcome(query, found, time.perf_counter() - begin)


def _check(queries: Sequence[Query]) -> None:
    if not queries:
        raise ValueError("there is no query")
    lacking = [str(query.path) for query in queries if not query.path.is_file()]
    if lacking:
        more = f", the first of {len(lacking)}" if len(lacking) > 1 else ""
        raise FileNotFoundError(2, f"there is no such query{more}", lacking[0])


def _progress(queries: Sequence) -> tqdm:
    return tqdm(queries, desc="queries", disable=None, unit="query")
