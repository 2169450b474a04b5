# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Evaluates a place map: localizes queries (images whose places are known) in their order."""

import gc
import os
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from scipy.stats import chi2
from tqdm import tqdm

from sextant.place_maps.place_map import Photo, PlaceMap
from sextant.places.photo_features import decode_photo, photo_features
from sextant.places.place_index import PlaceIndex
from sextant.places.place_index_update import PlaceIndexer
from sextant.places.place_localizer import Localization, PlaceLocalizationParams, PlaceLocalizer, Status
from sextant.places.place_metrics import (
    PrecisionRecall,
    calibration_error,
    perfect_calibration_error,
    precision_recall,
)
from sextant.places.place_queries import (
    Query,
    leave_one_out_queries,
    metres_per_pixel,
    queries_in_clusters,
)

RANKS = (1, 5, 10)  # of recall
ELLIPSE = 0.95  # probability of the confidence ellipse
ROUNDING = 1e-9  # of distances
INDEPENDENT_MODES = ("single", "votes")  # modes that localize each image independently

WARM_UP_IMAGE = np.random.default_rng(1).integers(0, 256, (240, 320), np.uint8)  # has many keypoints


class QueryResult(NamedTuple):
    """Localization of one query."""

    query: Query  # image and ground truth
    found: Localization  # hypotheses
    seconds: float  # processing time

    @property
    def rank(self) -> float:
        """Rank of the first correct hypothesis, starting at 1; inf if there is none."""
        photos = [hypothesis.photo for hypothesis in self.found.hypotheses]
        correct = [n for n, photo in enumerate(photos, 1) if (photo.x, photo.y) in self.query.true_places]
        return correct[0] if correct else np.inf

    def errors(self, pixels: np.ndarray) -> np.ndarray:
        """Distances (hypotheses,) of the hypotheses from the truth, see Query.distance()."""
        photos = [hypothesis.photo for hypothesis in self.found.hypotheses]
        return np.array([self.query.distance((photo.x, photo.y), pixels) for photo in photos])


class Cost(NamedTuple):
    """Time and memory of a map's index."""

    seconds: float  # until the first image can be localized
    is_loaded: bool  # whether the index was loaded from the cache and is unchanged
    index_bytes: int  # size of the index
    resident_bytes: int  # growth of the process's resident memory until the end of the queries
    keypoints: int = 0  # of all photos in the index


@dataclass(frozen=True)
class PlaceEvaluation:
    """Results of an evaluation; figures are nan if there is no data for them."""

    results: Sequence[QueryResult]  # in the order of the queries
    pixels: np.ndarray  # (2,) metres per pixel of the overview along x and y; (1, 1) if the map has no scale
    cost: Cost  # of the index

    @property
    def ranks(self) -> np.ndarray:
        """Rank of the first correct hypothesis of each query that is in the map."""
        return np.array([each.rank for each in self.results if each.query.true_places])

    def recall(self, n: int) -> float:
        """Recall@n: fraction of the queries in the map with a correct place among the n best hypotheses."""
        return float(np.mean(self.ranks <= n)) if len(self.ranks) else np.nan

    def within(self, distance: float) -> float:
        """Fraction of the queries in the map whose best hypothesis is within a distance of the truth.

        :param distance: metres, or pixels if the map has no scale; see Query.distance()
        """
        in_map = [each for each in self.results if each.query.true_places]
        errors = [each.errors(self.pixels) for each in in_map]
        right = [len(each) > 0 and each[0] <= distance + ROUNDING for each in errors]
        return float(np.mean(right)) if right else np.nan

    @property
    def predictions(self) -> Tuple[np.ndarray, np.ndarray]:
        """Probabilities of the best hypotheses, and whether each is correct: never for unmapped queries."""
        answered = [each for each in self.results if each.found.hypotheses]
        probabilities = [each.found.hypotheses[0].probability for each in answered]
        return np.array(probabilities), np.array([each.rank == 1 for each in answered], bool)

    @property
    def curve(self) -> PrecisionRecall:
        """Precision and recall of the best hypotheses over their probability."""
        probabilities, correct = self.predictions
        if not len(self.ranks) or not len(correct):
            return PrecisionRecall(np.zeros(0), np.zeros(0), np.nan if not len(self.ranks) else 0.0)
        return precision_recall(probabilities, correct, len(self.ranks))

    @property
    def calibration_error(self) -> float:
        """Expected calibration error, see place_metrics."""
        return calibration_error(*self.predictions) if len(self.predictions[0]) else np.nan

    @property
    def perfect_calibration_error(self) -> float:
        """95 % quantile of the calibration error of perfectly calibrated probabilities."""
        return perfect_calibration_error(self.predictions[0]) if len(self.predictions[0]) else np.nan

    def unknown_rate(self, is_in_map: bool) -> float:
        """Fraction of the queries in the map, or not in the map, whose status is UNKNOWN_PLACE."""
        found = [each.found for each in self.results if bool(each.query.true_places) == is_in_map]
        return float(np.mean([each.status == Status.UNKNOWN_PLACE for each in found])) if found else np.nan

    @property
    def position_errors(self) -> np.ndarray:
        """(m, 2) errors of the estimates along x and y, metres, or pixels if the map has no scale."""
        errors = [
            (each.found.estimate.x - each.query.position[0], each.found.estimate.y - each.query.position[1])
            for each in self._estimated()
        ]
        return np.array(errors).reshape(-1, 2) * self.pixels

    @property
    def ellipse_coverage(self) -> float:
        """Fraction of the estimates whose 95 % ellipse contains the true position."""
        errors = self.position_errors / self.pixels
        covariances = [each.found.estimate.covariance for each in self._estimated()]
        squared = [error @ np.linalg.solve(C, error) for error, C in zip(errors, covariances)]
        return float(np.mean(np.array(squared) <= chi2.ppf(ELLIPSE, 2))) if squared else np.nan

    def _estimated(self) -> List[QueryResult]:
        return [each for each in self.results if each.found.estimate and each.query.position]

    def figures(self) -> Dict[str, float]:
        """All figures by name; see position_errors for the unit of the position errors."""
        errors = np.linalg.norm(self.position_errors, axis=1)
        seconds = np.array([each.seconds for each in self.results])
        return {
            "queries": len(self.results),
            "unmapped_queries": len(self.results) - len(self.ranks),
            **{f"recall@{n}": self.recall(n) for n in RANKS},
            "area": self.curve.area,
            "calibration_error": self.calibration_error,
            "perfect_calibration_error": self.perfect_calibration_error,
            "unknown_rate_in_map": self.unknown_rate(True),
            "unknown_rate_off_map": self.unknown_rate(False),
            "estimates": len(errors),
            "position_error": _quantile(errors, 0.5),
            "position_error_90": _quantile(errors, 0.9),
            "ellipse_coverage": self.ellipse_coverage,
            "query_ms": 1e3 * _quantile(seconds, 0.5),
            "query_ms_95": 1e3 * _quantile(seconds, 0.95),
            "index_seconds": self.cost.seconds,
            "index_mb": self.cost.index_bytes / 1e6,
            "resident_mb": self.cost.resident_bytes / 1e6,
        }


def evaluate(
    indexer: PlaceIndexer,
    params: PlaceLocalizationParams,
    queries: Sequence[Query],
    clusters: Optional[PlaceMap] = None,
) -> PlaceEvaluation:
    """Localizes the queries in their order.

    :param clusters: the map with merged places; if set, the queries are localized in it, see
        queries_in_clusters()
    :raises OSError: an image cannot be read
    :raises ValueError: names the parameter, photos or queries that cannot be used
    """
    _check(queries)
    if clusters:
        queries = queries_in_clusters(queries, indexer.place_map, clusters)
        indexer = replace(indexer, place_map=clusters)
    session = _start(indexer, params)
    results = [_localized(session.index, session.localizer, query) for query in _progress(queries)]
    return session.evaluation(indexer.place_map, results)


def evaluate_leave_one_out(
    indexer: PlaceIndexer,
    params: PlaceLocalizationParams,
    tolerance: float,
    clusters: Optional[PlaceMap] = None,
) -> PlaceEvaluation:
    """Localizes every photo of the map with the other photos.

    :param tolerance: see places_near()
    :param clusters: see evaluate()
    :raises: as evaluate()
    """
    if params.mode not in INDEPENDENT_MODES:
        modes = " or ".join(INDEPENDENT_MODES)
        raise ValueError(f"mode is '{params.mode}', leave-one-out needs {modes}")
    trials = list(leave_one_out_queries(indexer.place_map, tolerance, clusters))
    if len(trials) < 2:
        raise ValueError(f"{indexer.map_path}: leave-one-out needs at least two photos")
    session = _start(indexer, params)
    results = [_left_out(session, *trial) for trial in _progress(trials)]
    return session.evaluation(indexer.place_map, results)


class _Session(NamedTuple):
    """A map's index and localizer during an evaluation."""

    index: PlaceIndex
    params: PlaceLocalizationParams
    localizer: PlaceLocalizer
    cost: Cost  # its resident_bytes are those before the index was loaded

    def evaluation(self, place_map: PlaceMap, results: Sequence[QueryResult]) -> PlaceEvaluation:
        growth = resident_bytes() - self.cost.resident_bytes
        return PlaceEvaluation(
            results, metres_per_pixel(place_map), self.cost._replace(resident_bytes=growth)
        )


def _start(indexer: PlaceIndexer, params: PlaceLocalizationParams) -> _Session:
    before, begin, reported = resident_bytes(), time.perf_counter(), []

    def report(line: str) -> None:
        reported.append(line)
        indexer.report(line)

    params = replace(params, max_places=max(RANKS))
    index = replace(indexer, report=report).index()
    localizer = _ready(PlaceLocalizer(indexer.place_map, index, params))
    seconds, keypoints = time.perf_counter() - begin, sum(photo.count for photo in index.photos)
    cost = Cost(seconds, not reported, index.bytes, before, keypoints)
    return _Session(index, params, localizer, cost)


def _left_out(session: _Session, photo: Photo, others: PlaceMap, query: Query) -> QueryResult:
    """Localizes a photo with a map that does not contain it."""
    index, is_searched = session.index, session.index.params.matcher is not None
    if is_searched:  # else the photo's neighbours would take the votes of others
        index.remove([each for each in index.photos if each.image == photo.image])
    localizer = PlaceLocalizer(others, index, session.params)
    result = _localized(index, _ready(localizer) if is_searched else localizer, query)
    if is_searched:
        index.add([photo.image], [photo_features(index.params, query.path)])
    return result


def resident_bytes() -> int:
    """Resident memory of this process, bytes."""
    gc.collect()
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE")


def _quantile(values: np.ndarray, fraction: float) -> float:
    return float(np.quantile(values, fraction)) if len(values) else np.nan


def _ready(localizer: PlaceLocalizer) -> PlaceLocalizer:
    """The localizer after a warm-up, so that the first query is not slower."""
    localizer.localize(WARM_UP_IMAGE)  # OpenCV's matchers are trained by the first search
    localizer.reset()
    return localizer


def _localized(index: PlaceIndex, localizer: PlaceLocalizer, query: Query) -> QueryResult:
    image = decode_photo(index.params, query.path.read_bytes(), query.path)
    begin = time.perf_counter()
    found = localizer.localize(image, rough=query.rough)
    return QueryResult(query, found, time.perf_counter() - begin)


def _check(queries: Sequence[Query]) -> None:
    if not queries:
        raise ValueError("there is no query")
    lacking = [str(query.path) for query in queries if not query.path.is_file()]
    if lacking:
        more = f", the first of {len(lacking)}" if len(lacking) > 1 else ""
        raise FileNotFoundError(2, f"there is no such query{more}", lacking[0])


def _progress(queries: Sequence) -> tqdm:
    return tqdm(queries, desc="queries", disable=None, unit="query")
