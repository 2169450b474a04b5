# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whether the probabilities of places are true, in the corridor and on simulated walks together.

Evidence is fitted to pictures one by one, of every two of three domains (the corridor and two streets), and
tried on the third. The fit to all three is what EvidenceParams has.
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
from sextant.place_maps.exif_map import find_photos
from sextant.place_maps.photo_file import read_grey
from sextant.place_maps.place_map import PlaceMap
from sextant.places.place_evidence import EvidenceParams, score_features
from sextant.places.place_index import IndexParams
from sextant.places.place_library import Library
from sextant.places.place_metrics import calibration_error, perfect_calibration_error
from sextant.places.place_queries import Query, default_tolerance, queries_of_map, queries_of_table
from sextant.places.place_recognition import PlaceRecognizer

STREETS, SEASONS = (1, 2), ("evening", "autumn", "winter")
BEYOND = 0.05  # of a perfect forecaster's error
LIKELY = 500  # queries, at least
REGULAR = 1e-3  # weight of the weights' squares
WEIGHTS = ("deviation", "score", "size", "offset")


class Asked(NamedTuple):
    """Queries to a map, in the order of a walk."""

    domain: str
    name: str
    place_map: PlaceMap
    queries: Sequence[Query]


class Seen(NamedTuple):
    """What a picture says."""

    features: np.ndarray  # (places, 3)
    right: np.ndarray  # bool (places,); of none: it is nowhere
    weight: float  # of the picture, so that every walk weighs the same


def calibration_tables(data: Path, quick: bool) -> List[Table]:
    """:raises OSError: the external test data is not there"""
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
    half = len(whole.photos) // 2
    if quick:
        queries, lund = queries[:FEW], lund[:FEW]
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
            strangers[seed] = [query._replace(right=frozenset()) for query in queries]
    for seed, other in (STREETS, STREETS[::-1]):
        place_map = next(each.place_map for each in asked if each.domain == f"street{seed}")
        asked.append(Asked(f"street{seed}", f"strangers{seed}", place_map, strangers[other]))
    return asked


def _seen(folder: Path, asked: Asked) -> List[Seen]:
    index = Library(folder / f"{asked.domain}_{asked.name}.txt", asked.place_map, IndexParams()).index()
    recognizer = PlaceRecognizer(asked.place_map, index)
    positions = [(photos[0].x, photos[0].y) for photos in asked.place_map.places()]
    return [
        Seen(
            score_features(recognizer.recognize(read_grey(query.path)).scores),
            np.array([position in query.right for position in positions]),
            1.0 / len(asked.queries),
        )
        for query in asked.queries
    ]


def _log_probabilities(weights: np.ndarray, seen: Seen) -> np.ndarray:
    """(places + 1,) of the places and of nowhere, which is as likely as all places at first."""
    places = seen.features @ weights[:3] - weights[3] - np.log(len(seen.features))
    both = np.append(places, 0.0)
    return both - logsumexp(both)


def _fitted(seen: Sequence[Seen]) -> np.ndarray:
    """(4,) most likely weights of EvidenceParams, by the probability of what is true."""

    def loss(weights: np.ndarray) -> float:
        total = REGULAR * float(weights @ weights)
        for each in seen:
            true = np.append(each.right, not each.right.any())
            total -= each.weight * logsumexp(_log_probabilities(weights, each)[true])
        return total

    return minimize(loss, astuple(EvidenceParams())[:4], method="L-BFGS-B").x


def _tried(seen: Dict[str, List[Seen]]) -> Row:
    """Every domain with the weights of the others."""
    said, right = [], []
    for domain, pictures in seen.items():
        others = [each for name, all_of in seen.items() if name != domain for each in all_of]
        weights = _fitted(others)
        for each in pictures:
            probabilities = np.exp(_log_probabilities(weights, each)[:-1])
            best = int(probabilities.argmax())
            around = _around(best, len(probabilities))
            said.append(probabilities[around].sum())
            right.append(each.right[best])
    return _row("single, fitted to the other domains", np.array(said), np.array(right))


def _around(place: int, count: int) -> np.ndarray:
    """The neighbours of a place along the way, that PlaceBelief counts as one answer with it."""
    return np.arange(max(place - 2, 0), min(place + 3, count))


def _shipped(folder: Path, asked: Sequence[Asked], mode: str, quick: bool) -> Row:
    said: List[Tuple[np.ndarray, np.ndarray]] = []
    for each in asked:
        name = f"{each.domain}_{each.name}"
        said.append(measured(folder, name, each.place_map, each.queries, mode).said)
    row = _row(f"{mode}, as it is", *(np.concatenate(part) for part in zip(*said)))
    return _barred(row) if mode == "filter" and not quick else row


def _row(name: str, said: np.ndarray, right: np.ndarray) -> Row:
    cells = [
        Value(len(said), 0),
        Value(100 * float(np.mean(right)), 1),
        Value(100 * float(np.mean(said)), 1),
        Value(calibration_error(said, right), 3),
        Value(perfect_calibration_error(said), 3),
    ]
    return name, cells


def _barred(row: Row) -> Row:
    name, (count, right, said, error, perfect) = row
    held = Value(error.value, 3, at_most=round(BEYOND + perfect.value, 4))
    return name, [Value(count.value, 0, at_least=LIKELY), right, said, held, perfect]


def _table(rows: List[Row]) -> Table:
    columns = ["queries", "right, %", "said, %", "calibration error", "of a perfect one"]
    return Table(
        "Probabilities in the corridor and on walks in three seasons, some of them elsewhere", columns, rows
    )


def _weights_table(weights: np.ndarray) -> Table:
    shipped = astuple(EvidenceParams())[:4]
    cells = [[Value(float(value), 3) for value in each] for each in (weights, shipped)]
    rows = [("fitted to all", cells[0]), ("as it is", cells[1])]
    return Table("Weights of the evidence", WEIGHTS, rows)
