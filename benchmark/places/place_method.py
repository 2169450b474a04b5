# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs one recognition method in its own process, to measure its memory."""

import os
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Callable, Dict, NamedTuple, Tuple

import cv2
import numpy as np

import sextant
from sextant.base.jobs import worker_environment
from sextant.place_maps.place_map import PlaceMap
from sextant.place_maps.place_map_file import read_place_map
from sextant.place_reports.place_comparison import method_params
from sextant.places.index_params import IndexParams
from sextant.places.place_evaluation import resident_bytes
from sextant.places.place_index_update import PlaceIndexer
from sextant.places.place_recognition import PlaceRecognizer
from sextant.places.place_votes import count_votes

METHODS: Dict[str, IndexParams] = {
    "votes, SIFT": method_params("sift", {}).index_params(),
    "default profile": IndexParams(),
}
MIN_MATCHES = 5  # minimum number of votes
Recognize = Callable[[np.ndarray], float]  # returns x of the place of an image; nan: not recognized

_recognize: Recognize  # method of this process, set by _build()


class Built(NamedTuple):
    """Cost of a map's index."""

    seconds: float  # until the first image can be recognized
    index_bytes: int  # descriptors and keypoints
    resident_bytes: int  # growth of the process's resident memory
    photo_keypoints: float  # mean number of keypoints per photo


class Method:
    """A method of METHODS in a child process on one core; a context manager."""

    def __init__(self, name: str):
        self._name = name

    def __enter__(self) -> "Method":
        self._executor = ProcessPoolExecutor(1, get_context("spawn"))
        with worker_environment():
            self._executor.submit(_use_one_core).result()
        return self

    def __exit__(self, *error: Any) -> None:
        self._executor.shutdown()

    def build(self, map_path: Path) -> Built:
        """Builds the index of a map from the photos, or reads it from the cache if there is one."""
        return self._executor.submit(_build, self._name, map_path).result()

    def query(self, photo: Path) -> Tuple[float, float]:
        """Recognizes a photo: seconds after decoding, and x of the recognized place."""
        return self._executor.submit(_query, photo).result()


def _use_one_core() -> None:
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    cv2.setNumThreads(1)


def _build(name: str, map_path: Path) -> Built:
    global _recognize
    params, place_map, before = METHODS[name], read_place_map(map_path), resident_bytes()
    begin = time.perf_counter()
    index = PlaceIndexer(map_path, place_map, params).index()
    _recognize = (_by_votes if params.matcher else _by_score)(place_map, index)
    _recognize(np.zeros((240, 320), np.uint8))
    if params.matcher:
        index.descriptors.search(np.zeros((1, 128), np.float32), 1)  # FLANN is trained by the first search
    seconds, keypoints = time.perf_counter() - begin, sum(photo.count for photo in index.photos)
    return Built(seconds, index.bytes, resident_bytes() - before, keypoints / len(index.photos))


def _query(photo: Path) -> Tuple[float, float]:
    image = cv2.imread(str(photo), cv2.IMREAD_GRAYSCALE)
    begin = time.perf_counter()
    x = _recognize(image)
    return time.perf_counter() - begin, x


def _by_score(place_map: PlaceMap, index: Any) -> Recognize:
    recognizer = PlaceRecognizer(place_map, index)
    return lambda image: recognizer.recognize(image).match.photo.x


def _by_votes(place_map: PlaceMap, index: Any) -> Recognize:
    extractor = sextant.FeatureExtractor(index.params.feature_params())
    photos = {photo.image: photo for photo in place_map.photos}

    def recognize(image: np.ndarray) -> float:
        distances, image_ids, _ = index.descriptors.search(extractor.extract(image).descriptors, 1)
        found, _ = count_votes(distances, image_ids, MIN_MATCHES, 1)
        return photos[index.photos[found[0]].image].x if len(found) else np.nan

    return recognize
