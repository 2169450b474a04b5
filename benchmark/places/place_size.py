# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Time, memory and recall by the number of places, with random descriptors instead of photos.

A query simulates another photo of a place: its descriptors with noise, its keypoints shifted.
"""

import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import List, NamedTuple, Tuple

import numpy as np
from tables import Table, Value
from tqdm import tqdm

import sextant
from places.place_budget import CORES
from sextant.base.jobs import worker_environment
from sextant.place_maps.place_map import Overview, Photo, PlaceMap
from sextant.places.descriptor_codes import DescriptorCodes
from sextant.places.index_params import IndexParams
from sextant.places.photo_keypoints import UNIT, Keypoints, PhotoKeypoints
from sextant.places.place_evaluation import resident_bytes
from sextant.places.place_index import SAMPLES, SEARCHED, WIDTHS, IndexedPhoto, PlaceIndex, is_large
from sextant.places.place_recognition import PlaceRecognizer

PLACES, QUICK = (100, 800, 3200, 10_000, 100_000), (20, 200)  # numbers of places; 800 are compared with each
DESCRIPTORS, WIDTH, QUERIES = 250, 128, 20  # descriptors per place, their size; number of queries
KINDS, SHAPES = 8192, 65536  # of descriptors: basic histograms, and factors each differs by
NOISE, MOVED = 12.0, 0.05  # standard deviations of a query: descriptors; shift, part of the longer side
SIFT_UNIT = 512  # length of a RootSIFT descriptor as integers
COLUMNS = ["made in, s", "index, MB", "process, MB", "query, ms", "95 %, ms", "right, %", "of each photo, %"]
MEMORY, SLOWEST, LOSS = 2000.0, 150.0, 3.0  # maximum memory, MB; time of a query, ms; recall lost, percent


class Size(NamedTuple):
    """Cost and result with a number of places."""

    made: float  # time to build the index, seconds
    index_bytes: int
    resident_bytes: int
    query: np.ndarray  # (queries,) seconds
    right: float  # fraction of the queries
    of_each: float  # the same when the query is compared with each of the photos


class Drawn:
    """Random descriptors and keypoints of any place; the same at every call."""

    def __init__(self) -> None:
        rng = np.random.default_rng(1)
        self._kinds = rng.gamma(0.4, 1.0, (KINDS, WIDTH)).astype(np.float32)
        self._shapes = rng.gamma(2.0, 0.5, (SHAPES, WIDTH)).astype(np.float32)

    def descriptors(self, place: int) -> np.ndarray:
        """Descriptors like RootSIFT: float32 (DESCRIPTORS, WIDTH), integers up to 255."""
        rng = np.random.default_rng([2, place])
        kinds, shapes = rng.integers(KINDS, size=DESCRIPTORS), rng.integers(SHAPES, size=DESCRIPTORS)
        histograms = self._kinds[kinds] * self._shapes[shapes]
        parts = histograms / histograms.sum(axis=1, keepdims=True)
        return np.minimum(np.rint(SIFT_UNIT * np.sqrt(parts)), 255)

    def keypoints(self, place: int) -> np.ndarray:
        """Keypoints, uint16 (DESCRIPTORS, 2), as in PlaceIndex."""
        return np.random.default_rng([3, place]).integers(UNIT, size=(DESCRIPTORS, 2), dtype=np.uint16)


class DrawnExtractor:
    """Replaces sextant.places.photo_features.KeypointExtractor: the images are keypoints already."""

    @staticmethod
    def extract(image: Tuple[Keypoints]) -> Tuple[Keypoints]:
        """Returns the keypoints, without cost."""
        return image


def size_tables(quick: bool) -> List[Table]:
    """One table; a quick run has few places and no bars."""
    numbers = QUICK if quick else PLACES
    rows = []
    for places in numbers:
        size = _in_own_process(places)
        memory, slowest, loss = (MEMORY, SLOWEST, LOSS) if places == PLACES[-1] else (None, None, None)
        figures = [
            Value(size.made, 1),
            Value(size.index_bytes / 1e6, 1),
            Value(size.resident_bytes / 1e6, 0, at_most=memory),
            Value(1e3 * float(np.median(size.query)), 1, at_most=slowest),
            Value(1e3 * float(np.quantile(size.query, 0.95)), 1),
            Value(100 * size.right, 0, at_least=None if loss is None else 100 * size.of_each - loss),
            Value(100 * size.of_each, 0),
        ]
        rows.append((f"{places} places", figures))
    return [Table(f"Drawn places of {DESCRIPTORS} descriptors; search and comparison", COLUMNS, rows)]


def _in_own_process(places: int) -> Size:
    with ProcessPoolExecutor(1, get_context("spawn")) as executor:
        with worker_environment(CORES):
            future = executor.submit(_size, places)
        return future.result()


def _size(places: int) -> Size:
    drawn = Drawn()
    before, begin = resident_bytes(), time.perf_counter()
    index = _index(drawn, places)
    recognizer = PlaceRecognizer(_map(places), index, extractor=DrawnExtractor())
    made, resident = time.perf_counter() - begin, resident_bytes() - before
    asked = np.random.default_rng(5).integers(places, size=QUERIES)
    queries = [_seen_again(drawn, int(place)) for place in asked]
    seconds, right = [], []
    for place, features in zip(asked, queries):
        begin = time.perf_counter()
        found = recognizer.recognize(features)
        seconds.append(time.perf_counter() - begin)
        right.append(int(found.scores.argmax()) == place)
    used, index.descriptors = index.bytes, None
    of_each = [int(recognizer.scores(each).total.argmax()) == place for place, each in zip(asked, queries)]
    return Size(made, used, resident, np.array(seconds), float(np.mean(right)), float(np.mean(of_each)))


def _index(drawn: Drawn, places: int) -> PlaceIndex:
    """Builds the index place by place, so that the descriptors are never all in memory."""
    learned = np.unique(np.linspace(0, places - 1, SAMPLES // DESCRIPTORS).astype(int))
    samples = np.concatenate([drawn.descriptors(int(place)) for place in learned])
    coder = DescriptorCodes.learned(samples, WIDTHS[0])
    count = places * DESCRIPTORS
    positions, codes = np.empty((count, 2), np.uint16), np.empty((count, WIDTHS[0]), np.int8)
    descriptors = None
    if is_large(places):
        values = coder.encode(samples).astype(np.float32)
        descriptors = sextant.DescriptorIndex("faiss", values, places * SEARCHED)
    photos = []
    for place in tqdm(range(places), desc="places", disable=None):
        rows = slice(place * DESCRIPTORS, (place + 1) * DESCRIPTORS)
        positions[rows], codes[rows] = drawn.keypoints(place), coder.encode(drawn.descriptors(place))
        photos.append(IndexedPhoto(f"{place}.jpg", "", (0, 0, 0), place, DESCRIPTORS))
        if descriptors is not None:
            descriptors.add(place, codes[rows][:SEARCHED].astype(np.float32))
    kind = PhotoKeypoints(coder, positions, codes, [DESCRIPTORS] * places)
    return PlaceIndex(IndexParams(), photos, [kind], descriptors, places)


def _map(places: int) -> PlaceMap:
    photos = tuple(Photo(place, f"{place}.jpg", float(place), 1.0) for place in range(places))
    return PlaceMap(Path("."), Overview("none.png", places, 2), photos)


def _seen_again(drawn: Drawn, place: int) -> Tuple[Keypoints]:
    rng = np.random.default_rng([4, place])
    seen, positions = drawn.descriptors(place), drawn.keypoints(place) + UNIT * rng.normal(0, MOVED, 2)
    seen = np.clip(np.rint(seen + rng.normal(0, NOISE, seen.shape)), 0, 255).astype(np.float32)
    return (Keypoints(np.clip(positions, 0, UNIT).astype(np.uint16), seen),)
