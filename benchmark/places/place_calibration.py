# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Calibration of the probabilities of places, on the external test data and on simulated walks.

The evidence of single images is fitted to all domains but one, and tested on that one. EvidenceParams has the
fit to all of them. Each image is used twice: with the map, and with the map without the right places.
"""

import tempfile
from dataclasses import astuple
from itertools import product
from pathlib import Path
from typing import Dict, Iterable, List, NamedTuple, Optional, Sequence

import numpy as np
from scipy.optimize import minimize
from scipy.special import logsumexp
from tables import Row, Table, Value

from places import place_domains
from places.place_domains import QuerySet, part_of, still_right
from places.place_recall import measured
from places.place_seasons import FEW, HARD_PAIRS, MAP_STEP, QUERY_STEP, SIZE, SMALL, hard_walk, walk
from sextant.images.photo_file import find_photos
from sextant.place_reports.place_predictors import roc_area
from sextant.places.index_params import IndexParams
from sextant.places.photo_features import decode_photo
from sextant.places.place_evidence import EvidenceParams
from sextant.places.place_index_update import PlaceIndexer
from sextant.places.place_metrics import calibration_error, perfect_calibration_error
from sextant.places.place_queries import Query, default_tolerance, queries_of_map
from sextant.places.place_recognition import PlaceRecognizer

STREETS, SEASONS = (1, 2), ("evening", "autumn", "winter")
MAX_ERROR = 0.08  # maximum calibration error over all domains
SURE = 0.9  # probability of a sure answer
RIGHT, ALL_RIGHT = 90.0, 95.0  # minimum % of the sure answers that are right: in each domain, in all
AREA, FILTERED_AREA = 0.85, 0.97  # minimum area under the ROC curve of "in the map": single images, filter
REGULAR = 1e-3  # factor of the L2 regularization of the weights
BOUNDS = ((0.01, 10.0), (0.0, 10.0), (0.0, 10.0), (-20.0, 20.0))  # of the weights
WEIGHTS = ("slope", "margin", "excess", "offset")


class ImageEvidence(NamedTuple):
    """Evidence of an image, and the correct places."""

    scores: np.ndarray  # (photos,)
    features: np.ndarray  # (2,) see UnknownPlaces.features()
    right: np.ndarray  # bool (photos,) correct ones; none: the image is not of the map
    around: np.ndarray  # bool (photos,) near the best one: merged into one hypothesis
    weight: float  # of the image in the fit: all domains have the same total weight


def calibration_tables(data: Path, quick: bool) -> List[Table]:
    """Three tables: calibration by domain, by mode, and the fitted weights.

    :raises OSError: the external test data is missing
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        walks = [*_corridor(data, quick), *_streets(folder, quick)]
        asked = [*walks, *_hard(folder, quick), *_others(data, quick)]
        seen = {domain: _seen(folder, each) for domain, each in _by_domain(asked).items()}
        areas = {"single": None, "filter": None if quick else FILTERED_AREA}
        rows = [_shipped(folder, walks, mode, area) for mode, area in areas.items()]
    weights = _fitted([one for domain in seen.values() for one in domain])
    return [_domains_table(seen, quick), _modes_table(rows), _weights_table(weights)]


def _corridor(data: Path, quick: bool) -> List[QuerySet]:
    asked, lund = place_domains.corridor(data), find_photos(data / "lund")
    whole, queries = asked.place_map, asked.queries
    if quick:
        whole, queries, lund = part_of(whole, 0, 2 * FEW), queries[:FEW], lund[:FEW]
    half = len(whole.photos) // 2
    asked = [QuerySet("corridor", "corridor", whole, queries)]
    for name, part in (("first_out", part_of(whole, half, None)), ("second_out", part_of(whole, 0, half))):
        asked.append(QuerySet("corridor", name, part, still_right(queries, part)))
    return [*asked, QuerySet("corridor", "strangers", whole, [Query(path, frozenset()) for path in lund])]


def _others(data: Path, quick: bool) -> List[QuerySet]:
    """Photos that are not of a walk."""
    if quick:
        return place_domains.campus(data)[:1]
    return [*place_domains.campus(data), *place_domains.lund(data), place_domains.tower(data)]


def _streets(folder: Path, quick: bool) -> List[QuerySet]:
    size, count = (SMALL, FEW) if quick else (SIZE, None)
    asked, strangers = [], {}
    for seed in STREETS:
        place_map = walk(folder / f"map{seed}", "summer", MAP_STEP, size, count, seed)
        for season in SEASONS[: 1 if quick else None]:
            walked = walk(folder / f"walk{seed}", season, QUERY_STEP, size, count, seed)
            queries = queries_of_map(place_map, walked, default_tolerance(place_map))
            asked.append(QuerySet(f"street{seed}", f"{season}{seed}", place_map, queries))
            strangers[seed] = [query._replace(true_places=frozenset()) for query in queries]
    for seed, other in (STREETS, STREETS[::-1]):
        place_map = next(each.place_map for each in asked if each.domain == f"street{seed}")
        asked.append(QuerySet(f"street{seed}", f"strangers{seed}", place_map, strangers[other]))
    return asked


def _hard(folder: Path, quick: bool) -> List[QuerySet]:
    """Walks in hard seasons."""
    size, count = (SMALL, FEW) if quick else (SIZE, None)
    asked = []
    for seed, (map_season, season) in list(product(STREETS, HARD_PAIRS))[: 1 if quick else None]:
        taken = folder / f"hard{seed}_{season}"
        taken.mkdir()
        place_map, queries = hard_walk(taken, (map_season, season), seed, size, count)
        asked.append(QuerySet("hard seasons", f"hard_{season}{seed}", place_map, queries))
    return asked


def _by_domain(asked: Iterable[QuerySet]) -> Dict[str, List[QuerySet]]:
    domains: Dict[str, List[QuerySet]] = {}
    for each in asked:
        domains.setdefault(each.domain, []).append(each)
    return domains


def _seen(folder: Path, asked: Sequence[QuerySet]) -> List[ImageEvidence]:
    """The evidence of one domain."""
    seen = [one for each in asked for one in _seen_once(folder, each)]
    return [one._replace(weight=1 / len(seen)) for one in seen]


def _seen_once(folder: Path, asked: QuerySet) -> List[ImageEvidence]:
    index = PlaceIndexer(folder / f"{asked.name}.txt", asked.place_map, IndexParams()).index()
    recognizer, seen = PlaceRecognizer(asked.place_map, index), []
    positions = [(photos[0].x, photos[0].y) for photos in asked.place_map.places() for _ in photos]
    for query in asked.queries:
        found = recognizer.scores(decode_photo(index.params, query.path.read_bytes(), query.path))
        scores, kinds = found.total, len(found.logs)
        right = np.array([position in query.true_places for position in positions])
        seen.append(_one(recognizer, scores, kinds, right))
        others = np.flatnonzero(~recognizer.near(right))
        if right.any() and len(others) > 1:
            seen.append(_one(recognizer, scores, kinds, np.zeros_like(right), others))
    return seen


def _one(
    recognizer: PlaceRecognizer,
    scores: np.ndarray,
    kinds: int,
    right: np.ndarray,
    numbers: Optional[np.ndarray] = None,
) -> ImageEvidence:
    """:param numbers: of the photos, as if the map had no other; None: all of them"""
    used = np.arange(len(scores)) if numbers is None else numbers
    best = np.arange(len(scores)) == used[scores[used].argmax()]
    features = recognizer.features(scores, kinds, numbers)
    return ImageEvidence(scores[used].astype(float), features, right[used], recognizer.near(best)[used], 1.0)


def _log_probabilities(weights: np.ndarray, seen: ImageEvidence) -> np.ndarray:
    """Log probabilities (photos + 1,) of the photos and of an unknown place; its prior is 0.5."""
    slope, margin, excess, offset = weights
    photos = slope * seen.scores
    odds = seen.features @ (margin, excess) - offset
    both = np.append(odds + photos - logsumexp(photos), 0.0)
    return both - logsumexp(both)


def _fitted(seen: Sequence[ImageEvidence]) -> np.ndarray:
    """Maximum likelihood estimate (4,) of the weights of EvidenceParams, with regularization."""

    def loss(weights: np.ndarray) -> float:
        total = REGULAR * float(weights @ weights)
        for each in seen:
            true = np.append(each.right, not each.right.any())
            total -= each.weight * logsumexp(_log_probabilities(weights, each)[true])
        return total

    return minimize(loss, astuple(EvidenceParams())[:4], method="L-BFGS-B", bounds=BOUNDS).x


class DomainAnswers(NamedTuple):
    """Answers to the images of one domain."""

    predicted: np.ndarray  # (n,) probabilities of the best answers
    is_right: np.ndarray  # bool (n,)
    known: np.ndarray  # (n,) probabilities that the image is of the map
    is_known: np.ndarray  # bool (n,)

    def row(self, name: str, right: Optional[float], error: Optional[float], area: Optional[float]) -> Row:
        """Row of the table of domains.

        :param right: minimum % of the sure answers that are right
        :param error: maximum calibration error
        :param area: minimum area under the ROC curve
        """
        sure = self.predicted > SURE
        known, unknown = self.known[self.is_known], self.known[~self.is_known]
        found = roc_area(known, unknown)
        return name, [
            Value(len(known), 0),
            Value(100 * float(self.is_right[self.is_known].mean()), 1),
            Value(100 * float(sure[self.is_known].mean()), 1),
            Value(100 * float(self.is_right[sure].mean()), 1, at_least=right) if sure.any() else "-",
            Value(calibration_error(self.predicted, self.is_right), 3, at_most=error),
            Value(float(found), 3, at_least=area),
        ]


def _tried(weights: np.ndarray, seen: Sequence[ImageEvidence]) -> DomainAnswers:
    answers = []
    for each in seen:
        probabilities = np.exp(_log_probabilities(weights, each))
        best = probabilities[:-1].argmax()
        answers.append(
            (probabilities[:-1][each.around].sum(), each.right[best], 1 - probabilities[-1], each.right.any())
        )
    return DomainAnswers(*(np.array(column) for column in zip(*answers)))


def _domains_table(seen: Dict[str, List[ImageEvidence]], quick: bool) -> Table:
    """Each domain with weights that are fitted to the others."""
    tried = {}
    for domain, images in seen.items():
        others = [each for name, all_of in seen.items() if name != domain for each in all_of]
        tried[domain] = _tried(_fitted(others), images)
    every = DomainAnswers(*map(np.concatenate, zip(*tried.values())))
    bars, bars_of_all = (RIGHT, None, AREA), (ALL_RIGHT, MAX_ERROR, None)
    if quick:
        bars = bars_of_all = (None, None, None)
    rows = [each.row(domain, *bars) for domain, each in tried.items()]
    rows.append(every.row("all", *bars_of_all))
    columns = [
        "images of the map", "recall@1, %", "sure, %", "sure and right, %",
        "calibration error", "area: in the map or not",
    ]  # fmt: skip
    title = f"Single images, fitted to the other domains; sure: a probability above {SURE:g}"
    return Table(title, columns, rows)


def _shipped(folder: Path, asked: Sequence[QuerySet], mode: str, area: Optional[float]) -> Row:
    """Row of a mode with the weights as they are.

    :param area: minimum area under the ROC curve
    """
    found = [measured(folder, each.name, each.place_map, each.queries, mode) for each in asked]
    probabilities, right = (np.concatenate(part) for part in zip(*(each.predictions for each in found)))
    results = [result for each in found for result in each.results]
    known = np.array([1 - result.found.unknown_probability for result in results])
    is_known = np.array([bool(result.query.true_places) for result in results])
    cells = [
        Value(len(probabilities), 0),
        Value(100 * float(np.mean(right)), 1),
        Value(100 * float(np.mean(probabilities)), 1),
        Value(calibration_error(probabilities, right), 3),
        Value(perfect_calibration_error(probabilities), 3),
        Value(roc_area(known[is_known], known[~is_known]), 3, at_least=area),
    ]
    return mode, cells


def _modes_table(rows: List[Row]) -> Table:
    columns = [
        "queries", "right, %", "predicted, %", "calibration error", "of a perfect one",
        "area: in the map or not",
    ]  # fmt: skip
    return Table("As it is, in the corridor and on walks in three seasons, some elsewhere", columns, rows)


def _weights_table(weights: np.ndarray) -> Table:
    shipped = astuple(EvidenceParams())[:4]
    cells = [[Value(float(value), 3) for value in each] for each in (weights, shipped)]
    rows = [("fitted to all", cells[0]), ("as it is", cells[1])]
    return Table("Weights of the evidence", WEIGHTS, rows)
