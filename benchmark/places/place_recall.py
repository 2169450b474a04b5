# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Recall, time and rate of unknown places on the external test data."""

import tempfile
from pathlib import Path
from typing import Dict, List, Optional, Sequence

import numpy as np
from tables import Row, Table, Value

from places.place_domains import NEAR, campus, corridor, lund_map, part_of, still_right, tower
from places.place_method import METHODS
from sextant.images.photo_file import find_photos
from sextant.place_maps.place_map import PlaceMap
from sextant.places.place_evaluation import PlaceEvaluation, evaluate, evaluate_leave_one_out
from sextant.places.place_index_update import PlaceIndexer
from sextant.places.place_localizer import VOTES, PlaceLocalizationParams
from sextant.places.place_queries import Query

PLAIN, OURS = METHODS
MODES = ("single", "filter", "sequence")
COLUMNS = ["recall@1", "@5", "area", "calibration error", "of a perfect one", "wrongly unknown, %"]
RECALL, AREA = {"single": 0.95, "filter": 0.99}, 0.92  # of the corridor: minimum recall@1; area, mode single
CAMPUS, TOWER = 0.985, 0.93  # minimum recall@1 in mode single
INDEX, QUERY = 10.0, 100.0  # of the tower: maximum size of the index, MB, and median time of a query, ms
OF_VOTES = (0.36, 0.42)  # minimum and maximum recall@1 of mode votes, which reproduces the original work
LEFT_OUT = 0.9  # minimum recall@1 of the photos that have a neighbour
ELSEWHERE, OUT = 95.0, 80.0  # minimum % reported unknown in mode filter: other city; half left out
FEW = 8  # number of photos of a quick run


def recall_tables(data: Path, quick: bool) -> List[Table]:
    """Four tables: the corridor, unknown places, campus and tower, and Lund.

    :raises OSError: the data is missing
    """
    lund = find_photos(data / "lund")
    if not lund:
        raise FileNotFoundError(2, "there is no photo", str(data / "lund"))
    _, _, place_map, queries = corridor(data)
    if quick:
        place_map, queries, lund = part_of(place_map, 0, FEW), queries[:FEW], lund[:FEW]
    with tempfile.TemporaryDirectory() as folder:
        return [
            _corridor(Path(folder), place_map, queries, quick),
            _unknown(Path(folder), place_map, queries, lund, quick),
            _look_alikes(Path(folder), data, quick),
            _lund(Path(folder), lund, quick),
        ]


def measured(
    folder: Path, name: str, place_map: PlaceMap, queries: Sequence[Query], mode: str
) -> PlaceEvaluation:
    """Evaluates a mode; mode votes with plain SIFT, the others with the default profile.

    :param folder: folder of the caches
    """
    indexer = PlaceIndexer(folder / f"{name}.txt", place_map, METHODS[PLAIN if mode == VOTES else OURS])
    return evaluate(indexer, PlaceLocalizationParams(mode=mode), queries)


def row_of(name: str, found: PlaceEvaluation, recall: Dict[str, float], area: Optional[float] = None) -> Row:
    """Row of COLUMNS.

    :param recall: bars of recall@1
    :param area: minimum area
    """
    return name, [
        Value(found.recall(1), 3, **recall),
        Value(found.recall(5), 3),
        Value(found.curve.area, 3, at_least=area),
        Value(found.calibration_error, 3),
        Value(found.perfect_calibration_error, 3),
        Value(100 * found.unknown_rate(True), 1),
    ]


def _corridor(folder: Path, place_map: PlaceMap, queries: Sequence[Query], quick: bool) -> Table:
    found = {mode: measured(folder, "whole", place_map, queries, mode) for mode in (*MODES, VOTES)}
    bars = {
        **{mode: {"at_least": bar} for mode, bar in RECALL.items()},
        VOTES: dict(zip(("at_least", "at_most"), OF_VOTES)),
    }
    rows = []
    for mode, each in found.items():
        bar = {} if quick else bars.get(mode, {})
        rows.append(row_of(mode, each, bar, AREA if mode == "single" and not quick else None))
    title = f"Corridor, {len(queries)} queries; mode votes with plain SIFT and FlannBased"
    samples = {mode: np.array(each.predictions, float) for mode, each in found.items()}
    return Table(title, COLUMNS, rows, samples)


def _unknown(
    folder: Path, place_map: PlaceMap, queries: Sequence[Query], lund: Sequence[Path], quick: bool
) -> Table:
    """Rates of unknown places, for queries whose places are not in the map."""
    half = (len(place_map.photos) + 1) // 2
    parts = {"first": part_of(place_map, half, None), "second": part_of(place_map, 0, half)}
    elsewhere = [Query(path, frozenset()) for path in lund]
    rows = []
    for mode in MODES[:2]:
        bars = (ELSEWHERE, OUT) if mode == "filter" and not quick else (None, None)
        found = measured(folder, "whole", place_map, elsewhere, mode)
        rows.append(_unknown_row(f"lund, {mode}", found, bars[0]))
        for name, part in parts.items():
            found = measured(folder, name, part, still_right(queries, part), mode)
            rows.append(_unknown_row(f"{name} half out, {mode}", found, bars[1]))
    columns = ["not in the map", "reported unknown, %", "in the map", "reported unknown, % ", "recall@1"]
    return Table("Queries to the corridor's map that it does not have", columns, rows)


def _unknown_row(name: str, found: PlaceEvaluation, bar: Optional[float]) -> Row:
    known = len(found.ranks)
    return name, [
        Value(len(found.results) - known, 0),
        Value(100 * found.unknown_rate(False), 1, at_least=bar),
        Value(known, 0),
        Value(100 * found.unknown_rate(True), 1) if known else "-",
        Value(found.recall(1), 3) if known else "-",
    ]


def _look_alikes(folder: Path, data: Path, quick: bool) -> Table:
    """Spots of a campus in other months, and floors of a tower that look alike; mode single."""
    months, floors = (campus(data)[:1], []) if quick else (campus(data), [tower(data)])
    rows = []
    for name, asked, recall in (
        ("campus, other months", months, CAMPUS),
        ("tower, right floor", floors, TOWER),
    ):
        if asked:
            found = [measured(folder, each.name, each.place_map, each.queries, "single") for each in asked]
            limits = (INDEX, QUERY) if asked is floors else (None, None)
            rows.append(_look_alike_row(name, found, None if quick else recall, *limits))
    columns = ["maps", "queries", "recall@1", "@5", "index, MB", "query, ms", "95 %, ms"]
    return Table("Single images of spots and floors", columns, rows)


def _look_alike_row(
    name: str,
    found: Sequence[PlaceEvaluation],
    recall: Optional[float],
    index: Optional[float],
    query: Optional[float],
) -> Row:
    """:param recall, index, query: bars"""
    ranks = np.concatenate([each.ranks for each in found])
    seconds = [result.seconds for each in found for result in each.results]
    return name, [
        Value(len(found), 0),
        Value(len(ranks), 0),
        Value(float(np.mean(ranks <= 1)), 3, at_least=recall),
        Value(float(np.mean(ranks <= 5)), 3),
        Value(max(each.cost.index_bytes for each in found) / 1e6, 1, at_most=index),
        Value(1e3 * float(np.median(seconds)), 1, at_most=query),
        Value(1e3 * float(np.quantile(seconds, 0.95)), 1),
    ]


def _lund(folder: Path, photos: Sequence[Path], quick: bool) -> Table:
    made = lund_map(photos)
    indexer = PlaceIndexer(folder / "lund.txt", made, METHODS[OURS])
    found = evaluate_leave_one_out(indexer, PlaceLocalizationParams(mode="single"), NEAR)
    errors = np.linalg.norm(found.position_errors, axis=1)
    row = [
        Value(len(made.photos), 0, at_least=None if quick else len(photos)),
        Value(len(found.ranks), 0),
        Value(found.recall(1), 3, at_least=None if quick else LEFT_OUT),
        Value(len(errors), 0),
        Value(np.median(errors) if len(errors) else np.nan, 1),
        Value(100 * found.ellipse_coverage, 0),
    ]
    columns = ["placed", "with a neighbour", "recall@1", "estimates", "median error, m", "in 95 % ellipse, %"]
    title = f"Lund, {len(photos)} photos, each recognized by the others; right within {NEAR:g} m"
    return Table(title, columns, [("single", row)])
