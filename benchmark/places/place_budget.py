# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Time and memory of the node's default parameters on two cores: absolute bars, on an idle machine."""

import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from tables import Row, Table, Value

from places.place_speed import NEAR, QUERIES
from places.place_walk import NEXT_DAY, Size, loop_errors, queries, walk_map
from sextant.base.jobs import worker_environment
from sextant.place_maps.place_map_file import read_place_map
from sextant.places.index_params import IndexParams
from sextant.places.photo_features import decode_photo
from sextant.places.place_evaluation import WARM_UP_IMAGE, resident_bytes
from sextant.places.place_index_update import PlaceIndexer
from sextant.places.place_localizer import PlaceLocalizer

CORES = 2  # that the localizer uses, and the processes that describe photos
COLUMNS = ["build, s", "start from cache, s", "index, MB", "process, MB", "query, ms", "95 %, ms", "right, %"]


class Bars(NamedTuple):
    """Maximum times and memory; None: no bar."""

    build: Optional[float] = None  # until the first image can be localized, s
    start: Optional[float] = None  # from the cache, s
    resident: Optional[float] = None  # growth of the process's memory, MB
    query: Optional[float] = None  # median, ms


MAPS: Dict[Tuple[int, Size], Bars] = {
    (360, (640, 480)): Bars(20.0, 1.0, 30.0, 60.0),
    (2400, (1280, 720)): Bars(build=120.0, query=100.0),
}
QUICK: Dict[Tuple[int, Size], Bars] = {(12, (320, 240)): Bars()}


class Started(NamedTuple):
    """A localizer at its start, and its answers."""

    seconds: float  # until the first image can be localized
    index_bytes: int
    resident_bytes: int
    answers: List[Tuple[float, float]]  # seconds of a query after decoding, and x of the best place


def budget_tables(quick: bool) -> List[Table]:
    """One table; a quick run has few photos and no bars."""
    rows = [_row(count, size, bars) for (count, size), bars in (QUICK if quick else MAPS).items()]
    return [Table(f"{QUERIES} images of the next day, two cores", COLUMNS, rows)]


def _row(count: int, size: Size, bars: Bars) -> Row:
    with tempfile.TemporaryDirectory() as folder:
        map_path = walk_map(Path(folder) / "map", count, size)
        shots = queries(Path(folder) / "queries", QUERIES, size, NEXT_DAY)
        cold, warm = (_started(map_path, [shot.path for shot in shots]) for _ in range(2))
        seconds, x = np.array(warm.answers).T
        errors = loop_errors(map_path, x, shots)
    return f"{count} photos of {size[0]}x{size[1]}", [
        Value(cold.seconds, 1, at_most=bars.build),
        Value(warm.seconds, 2, at_most=bars.start),
        Value(warm.index_bytes / 1e6, 1),
        Value(warm.resident_bytes / 1e6, 0, at_most=bars.resident),
        Value(1e3 * float(np.median(seconds)), 1, at_most=bars.query),
        Value(1e3 * float(np.quantile(seconds, 0.95)), 1),
        Value(100 * float(np.mean(errors < NEAR)), 0),
    ]


def _started(map_path: Path, photos: Sequence[Path]) -> Started:
    """Starts a localizer in a process of its own, as the node does."""
    with ProcessPoolExecutor(1, get_context("spawn")) as executor:
        with worker_environment(CORES):
            future = executor.submit(_start, map_path, photos)
        return future.result()


def _start(map_path: Path, photos: Sequence[Path]) -> Started:
    place_map, before, begin = read_place_map(map_path), resident_bytes(), time.perf_counter()
    index = PlaceIndexer(map_path, place_map, IndexParams(), CORES).index()
    localizer = PlaceLocalizer(place_map, index)
    seconds = time.perf_counter() - begin
    localizer.localize(WARM_UP_IMAGE)
    localizer.reset()
    answers = [_asked(localizer, decode_photo(index.params, path.read_bytes(), path)) for path in photos]
    return Started(seconds, index.bytes, resident_bytes() - before, answers)


def _asked(localizer: PlaceLocalizer, image: np.ndarray) -> Tuple[float, float]:
    """Localizes an image without regard to the images before it."""
    localizer.reset()
    begin = time.perf_counter()
    found = localizer.localize(image)
    return time.perf_counter() - begin, found.match.photo.x
