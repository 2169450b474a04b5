# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Time and memory of the default profile relative to mode `votes` with SIFT, on the same photos."""

import tempfile
from contextlib import ExitStack
from pathlib import Path
from typing import Dict, List, NamedTuple, Tuple

import numpy as np
from tables import Row, Table, Value

from places.place_method import METHODS, Built, Method
from places.place_walk import NEXT_DAY, Shot, Size, loop_errors, queries, walk_map

PHOTOS, QUERIES = 360, 24  # number of photos of the map, and of queries
NEAR = 600.0  # tolerance of a correct place, centimetres
PLAIN, OURS = METHODS
COLUMNS = [
    "keypoints a photo",
    "build, s",
    "of votes",
    "index, MB",
    "of votes ",
    "process, MB",
    "query, ms",
    "of votes  ",
    "right, %",
    "start from cache, s",
]


class Bars(NamedTuple):
    """Maximum build time, index size and query time relative to mode votes."""

    build: float
    index: float
    query: float


SIZES: Dict[Size, Bars] = {(2048, 1536): Bars(1 / 8, 1 / 50, 1 / 5), (640, 480): Bars(1 / 2, 1 / 25, 1 / 2)}
START = 1.0  # maximum time to load the cache, seconds


class Cost(NamedTuple):
    """Cost and results of one method."""

    built: Built
    query: float  # seconds, median
    right: float  # fraction of the queries
    start: float = np.nan  # time to start from the cache, seconds; nan: not measured


def speed_tables(quick: bool) -> List[Table]:
    """A table per image size; a quick run has few photos and no bars."""
    if quick:
        return [_table((320, 240), 12, 4, None)]
    return [_table(size, PHOTOS, QUERIES, bars) for size, bars in SIZES.items()]


def _table(size: Size, photos: int, asked: int, bars: Bars) -> Table:
    with tempfile.TemporaryDirectory() as folder:
        map_path = walk_map(Path(folder) / "map", photos, size)
        shots = queries(Path(folder) / "queries", asked, size, NEXT_DAY)
        costs = _costs(map_path, shots)
    title = f"{photos} photos of {size[0]}x{size[1]}, median of {asked} queries of the next day, one core"
    return Table(title, COLUMNS, [_row(name, cost, costs[PLAIN], bars) for name, cost in costs.items()])


def _costs(map_path: Path, shots: List[Shot]) -> Dict[str, Cost]:
    """Both methods get the same queries in turn, so that other load affects both."""
    with ExitStack() as stack:
        methods = {name: stack.enter_context(Method(name)) for name in METHODS}
        built = {name: method.build(map_path) for name, method in methods.items()}
        answers: Dict[str, List[Tuple[float, float]]] = {name: [] for name in METHODS}
        for shot in shots:
            for name, method in methods.items():
                answers[name].append(method.query(shot.path))
    costs = {name: Cost(built[name], *_summary(answers[name], shots, map_path)) for name in METHODS}
    with Method(OURS) as method:
        return {**costs, OURS: costs[OURS]._replace(start=method.build(map_path).seconds)}


def _summary(answers: List[Tuple[float, float]], shots: List[Shot], map_path: Path) -> Tuple[float, float]:
    """Median of the seconds, and fraction of the answers within NEAR of the true position."""
    seconds, x = np.array(answers).T
    return float(np.median(seconds)), float(np.mean(loop_errors(map_path, x, shots) < NEAR))


def _row(name: str, cost: Cost, plain: Cost, bars: Bars) -> Row:
    limits = bars if bars and name != PLAIN else Bars(None, None, None)
    built = cost.built
    return name, [
        Value(built.photo_keypoints, 0),
        Value(built.seconds, 1),
        Value(built.seconds / plain.built.seconds, 3, at_most=limits.build),
        Value(built.index_bytes / 1e6, 1),
        Value(built.index_bytes / plain.built.index_bytes, 4, at_most=limits.index),
        Value(built.resident_bytes / 1e6, 0),
        Value(1e3 * cost.query, 1),
        Value(cost.query / plain.query, 3, at_most=limits.query),
        Value(100 * cost.right, 0),
        "-" if name == PLAIN else Value(cost.start, 2, at_most=START if bars else None),
    ]
