# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Time and memory of a map of very many places, whose descriptors are drawn, not photographed.

A query is another picture of a place: its descriptors with noise, its keypoints moved.
"""

import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import List, NamedTuple, Tuple

import cv2
import numpy as np
from tables import Table, Value
from tqdm import tqdm

import sextant
from sextant.base.jobs import as_children_need_it
from sextant.place_maps.place_map import Overview, Photo, PlaceMap
from sextant.places.place_evaluation import resident_bytes
from sextant.places.place_index import SAMPLES, UNIT, IndexedPhoto, IndexParams, PlaceIndex
from sextant.places.place_recognition import PlaceRecognizer

FEW, MANY = 1000, 100_000  # places
DESCRIPTORS, WIDTH, QUERIES = 250, 128, 20
KINDS, SHAPES = 8192, 65536  # of descriptors: what they look like, and how each differs from its kind
NOISE, MOVED = 12.0, 0.05  # of a query's descriptors; of its keypoints, in longer sides
SIFT_UNIT = 512  # of RootSIFT as whole numbers
COLUMNS = ["made in, s", "index, MB", "process, MB", "query, ms", "of few", "right, %"]
MEMORY, SLOWER = 2000.0, 10.0  # MB; times


class Size(NamedTuple):
    """What a number of places costs."""

    made: float  # seconds
    index_bytes: int
    resident_bytes: int
    query: float  # seconds, median
    right: float


class Drawn:
    """Descriptors and keypoints of any place, the same whenever they are asked for."""

    def __init__(self) -> None:
        rng = np.random.default_rng(1)
        self._kinds = rng.gamma(0.4, 1.0, (KINDS, WIDTH)).astype(np.float32)
        self._shapes = rng.gamma(2.0, 0.5, (SHAPES, WIDTH)).astype(np.float32)

    def descriptors(self, place: int) -> np.ndarray:
        """As RootSIFT's: float32 (DESCRIPTORS, WIDTH), whole numbers up to 255."""
        rng = np.random.default_rng([2, place])
        kinds, shapes = rng.integers(KINDS, size=DESCRIPTORS), rng.integers(SHAPES, size=DESCRIPTORS)
        histograms = self._kinds[kinds] * self._shapes[shapes]
        parts = histograms / histograms.sum(axis=1, keepdims=True)
        return np.minimum(np.rint(SIFT_UNIT * np.sqrt(parts)), 255)

    def keypoints(self, place: int) -> np.ndarray:
        """uint16 (DESCRIPTORS, 2), as the index has them."""
        return np.random.default_rng([3, place]).integers(UNIT, size=(DESCRIPTORS, 2), dtype=np.uint16)


class Features(NamedTuple):
    """Stands for sextant.LocalFeatures."""

    size: Tuple[int, int]
    keypoints: np.ndarray
    descriptors: np.ndarray


class DrawnRecognizer(PlaceRecognizer):
    """Its pictures are described already."""

    def __init__(self, place_map: PlaceMap, index: PlaceIndex):
        super().__init__(place_map, index)
        self._extractor = self

    @staticmethod
    def extract(picture: Features) -> Features:
        """Takes no time."""
        return picture


def size_tables(quick: bool) -> List[Table]:
    """One table; a quick run is of few places, without bars."""
    few, many = (20, 200) if quick else (FEW, MANY)
    sizes = {places: _in_own_process(places) for places in (few, many)}
    rows = []
    for places, size in sizes.items():
        barred = places == many and not quick
        figures = [
            Value(size.made, 1),
            Value(size.index_bytes / 1e6, 1),
            Value(size.resident_bytes / 1e6, 0, at_most=MEMORY if barred else None),
            Value(1e3 * size.query, 1),
            Value(size.query / sizes[few].query, 2, at_most=SLOWER if barred else None),
            Value(100 * size.right, 0),
        ]
        rows.append((f"{places} places", figures))
    return [Table(f"Drawn places of {DESCRIPTORS} descriptors; search, votes and arrangement", COLUMNS, rows)]


def _in_own_process(places: int) -> Size:
    with ProcessPoolExecutor(1, get_context("spawn")) as executor:
        with as_children_need_it():
            future = executor.submit(_size, places)
        return future.result()


def _size(places: int) -> Size:
    cv2.setNumThreads(1)
    drawn = Drawn()
    before, begin = resident_bytes(), time.perf_counter()
    index = _index(drawn, places)
    recognizer = DrawnRecognizer(_map(places), index)
    made, resident = time.perf_counter() - begin, resident_bytes() - before
    seconds, right = [], []
    for place in np.random.default_rng(5).integers(places, size=QUERIES):
        features = _seen_again(drawn, int(place))
        begin = time.perf_counter()
        found = recognizer.recognize(features)
        seconds.append(time.perf_counter() - begin)
        right.append(int(found.scores.argmax()) == place)
    return Size(made, index.bytes, resident, float(np.median(seconds)), float(np.mean(right)))


def _index(drawn: Drawn, places: int) -> PlaceIndex:
    """Place by place, so that the descriptors are nowhere all together."""
    learned = np.unique(np.linspace(0, places - 1, SAMPLES // DESCRIPTORS).astype(int))
    samples = np.concatenate([drawn.descriptors(int(place)) for place in learned])
    descriptors = sextant.DescriptorIndex("faiss", samples, places * DESCRIPTORS)
    keypoints = np.empty((places * DESCRIPTORS, 2), np.uint16)
    photos = []
    for place in tqdm(range(places), desc="places", disable=None):
        first = place * DESCRIPTORS
        keypoints[first : first + DESCRIPTORS] = drawn.keypoints(place)
        photos.append(IndexedPhoto(f"{place}.jpg", "", (0, 0, 0), place, first, DESCRIPTORS))
        descriptors.add(place, drawn.descriptors(place))
    return PlaceIndex(IndexParams(), photos, keypoints, descriptors, places)


def _map(places: int) -> PlaceMap:
    photos = tuple(Photo(place, f"{place}.jpg", float(place), 1.0) for place in range(places))
    return PlaceMap(Path("."), Overview("none.png", places, 2), photos)


def _seen_again(drawn: Drawn, place: int) -> Features:
    rng = np.random.default_rng([4, place])
    seen = drawn.descriptors(place)
    seen = np.clip(np.rint(seen + rng.normal(0, NOISE, seen.shape)), 0, 255).astype(np.float32)
    return Features((1, 1), drawn.keypoints(place) / UNIT + rng.normal(0, MOVED, 2), seen)
