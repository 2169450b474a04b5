# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Calibration of the probabilities of places, in the corridor and on simulated walks.

The evidence is fitted to single images of two of three domains (the corridor and two streets), and
tested on the third. EvidenceParams has the fit to all three.
"""

import tempfile
from dataclasses import astuple
from pathlib import Path
from typing import Dict, List, NamedTuple, Sequence, Tuple

import numpy as np
from scipy.optimize import minimize
from scipy.special import logsumexp
from tables import Row, Table, Value

from places.place_recall import corridor_map, measured, part_of, still_right
from places.place_seasons import FEW, MAP_STEP, QUERY_STEP, SIZE, SMALL, walk
from sextant.place_maps.photo_file import find_photos, read_grey
from sextant.place_maps.place_map import PlaceMap
from sextant.places.place_evidence import EvidenceParams, score_features
from sextant.places.place_index import IndexParams
from sextant.places.place_index_update import PlaceIndexer
from sextant.places.place_metrics import calibration_error, perfect_calibration_error
from sextant.places.place_queries import Query, default_tolerance, queries_of_map, queries_of_table
from sextant.places.place_recognition import PlaceRecognizer

STREETS, SEASONS = (1, 2), ("evening", "autumn", "winter")
BEYOND = 0.05  # maximum excess over the calibration error of perfectly calibrated probabilities
LIKELY = 500  # minimum number of queries
REGULAR = 1e-3  # factor of the L2 regularization of the weights
WEIGHTS = ("deviation", "score", "size", "offset")


class Asked(NamedTuple):
    """Queries to a map, in the order of a walk."""

    domain: str  # corridor or street
    name: str  # of the walk
    place_map: PlaceMap
    queries: Sequence[Query]


class Seen(NamedTuple):
    """Features of an image's evidence, and the correct places."""

    features: np.ndarray  # (places, 3), see score_features()
    right: np.ndarray  # bool (places,) correct places; none True: the query is not in the map
    weight: float  # of the image in the fit: all walks have the same total weight


def calibration_tables(data: Path, quick: bool) -> List[Table]:
    """Two tables: calibration by mode, and the fitted weights.

    :raises OSError: the external test data is missing
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        asked = [*_corridor(data, quick), *_streets(folder, quick)]
        seen = {each.domain: [] for each in asked}
        for each in asked:
            seen[each.domain] += _seen(folder, each)
        weights = _fitted([one for domain in seen.values() for one in domain])
        rows = [_tried(seen), *(_shipped(folder, asked, mode, quick) for mode in ("single", "filter"))]
        if not quick:
            rows[0] = _barred(rows[0])
    return [_table(rows), _weights_table(weights)]


def _corridor(data: Path, quick: bool) -> List[Asked]:
    folder, lund = data / "corridor", find_photos(data / "lund")
    whole = corridor_map(folder)
    queries = queries_of_table(whole, folder / "truth.csv", folder / "query")
    if quick:
        whole, queries, lund = part_of(whole, 0, 2 * FEW), queries[:FEW], lund[:FEW]
    half = len(whole.photos) // 2
    asked = [Asked("corridor", "corridor", whole, queries)]
    for name, part in (("first_out", part_of(whole, half, None)), ("second_out", part_of(whole, 0, half))):
        asked.append(Asked("corridor", name, part, still_right(queries, part)))
    return [*asked, Asked("corridor", "lund", whole, [Query(path, frozenset()) for path in lund])]


def _streets(folder: Path, quick: bool) -> List[Asked]:
    size, count = (SMALL, FEW) if quick else (SIZE, None)
    asked, strangers = [], {}
    for seed in STREETS:
        place_map = walk(folder / f"map{seed}", "summer", MAP_STEP, size, count, seed)
        for season in SEASONS[: 1 if quick else None]:
            walked = walk(folder / f"walk{seed}", season, QUERY_STEP, size, count, seed)
            queries = queries_of_map(place_map, walked, default_tolerance(place_map))
            asked.append(Asked(f"street{seed}", f"{season}{seed}", place_map, queries))
            strangers[seed] = [query._replace(true_places=frozenset()) for query in queries]
    for seed, other in (STREETS, STREETS[::-1]):
        place_map = next(each.place_map for each in asked if each.domain == f"street{seed}")
        asked.append(Asked(f"street{seed}", f"strangers{seed}", place_map, strangers[other]))
    return asked


def _seen(folder: Path, asked: Asked) -> List[Seen]:
    index = PlaceIndexer(folder / f"{asked.domain}_{asked.name}.txt", asked.place_map, IndexParams()).index()
    recognizer = PlaceRecognizer(asked.place_map, index)
    positions = [(photos[0].x, photos[0].y) for photos in asked.place_map.places()]
    return [
        Seen(
            score_features(recognizer.recognize(read_grey(query.path)).scores),
            np.array([position in query.true_places for position in positions]),
            1.0 / len(asked.queries),
        )
        for query in asked.queries
    ]


def _log_probabilities(weights: np.ndarray, seen: Seen) -> np.ndarray:
    """Log probabilities (places + 1,) of the places and of an unknown place; its prior is 0.5."""
    places = seen.features @ weights[:3] - weights[3] - np.log(len(seen.features))
    both = np.append(places, 0.0)
    return both - logsumexp(both)


def _fitted(seen: Sequence[Seen]) -> np.ndarray:
    """Maximum likelihood estimate (4,) of the weights of EvidenceParams, with regularization."""

    def loss(weights: np.ndarray) -> float:
        total = REGULAR * float(weights @ weights)
        for each in seen:
            true = np.append(each.right, not each.right.any())
            total -= each.weight * logsumexp(_log_probabilities(weights, each)[true])
        return total

    return minimize(loss, astuple(EvidenceParams())[:4], method="L-BFGS-B").x


def _tried(seen: Dict[str, List[Seen]]) -> Row:
    """Results of every domain with weights that are fitted to the others (cross-validation)."""
    predicted, right = [], []
    for domain, pictures in seen.items():
        others = [each for name, all_of in seen.items() if name != domain for each in all_of]
        weights = _fitted(others)
        for each in pictures:
            probabilities = np.exp(_log_probabilities(weights, each)[:-1])
            best = int(probabilities.argmax())
            around = _around(best, len(probabilities))
            predicted.append(probabilities[around].sum())
            right.append(each.right[best])
    return _row("single, fitted to the other domains", np.array(predicted), np.array(right))


def _around(place: int, count: int) -> np.ndarray:
    """Indices of a place and its neighbours on the walk, which PlaceBelief merges into one hypothesis."""
    return np.arange(max(place - 2, 0), min(place + 3, count))


def _shipped(folder: Path, asked: Sequence[Asked], mode: str, quick: bool) -> Row:
    predicted: List[Tuple[np.ndarray, np.ndarray]] = []
    for each in asked:
        name = f"{each.domain}_{each.name}"
        predicted.append(measured(folder, name, each.place_map, each.queries, mode).predictions)
    row = _row(f"{mode}, as it is", *(np.concatenate(part) for part in zip(*predicted)))
    return _barred(row) if mode == "filter" and not quick else row


def _row(name: str, predicted: np.ndarray, right: np.ndarray) -> Row:
    cells = [
        Value(len(predicted), 0),
        Value(100 * float(np.mean(right)), 1),
        Value(100 * float(np.mean(predicted)), 1),
        Value(calibration_error(predicted, right), 3),
        Value(perfect_calibration_error(predicted), 3),
    ]
    return name, cells


def _barred(row: Row) -> Row:
    name, (count, right, predicted, error, perfect) = row
    held = Value(error.value, 3, at_most=round(BEYOND + perfect.value, 4))
    return name, [Value(count.value, 0, at_least=LIKELY), right, predicted, held, perfect]


def _table(rows: List[Row]) -> Table:
    columns = ["queries", "right, %", "predicted, %", "calibration error", "of a perfect one"]
    return Table(
        "Probabilities in the corridor and on walks in three seasons, some of them elsewhere", columns, rows
    )


def _weights_table(weights: np.ndarray) -> Table:
    shipped = astuple(EvidenceParams())[:4]
    cells = [[Value(float(value), 3) for value in each] for each in (weights, shipped)]
    rows = [("fitted to all", cells[0]), ("as it is", cells[1])]
    return Table("Weights of the evidence", WEIGHTS, rows)
