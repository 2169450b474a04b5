# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Features of photos and images: keypoints of one or two kinds, and a global descriptor."""

from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import List, NamedTuple, Sequence, Tuple

import numpy as np

import sextant
from sextant.base.jobs import JobError, run_jobs
from sextant.images.photo_file import decode_colour, decode_grey
from sextant.places.global_descriptor import cached_descriptor
from sextant.places.index_params import IndexParams, content_digest
from sextant.places.photo_keypoints import UNIT, Keypoints

MAX_KEYPOINTS = 65536  # per photo, a limit of sextant.DescriptorIndex
MAX_COMPARED = 500  # keypoints of an image that are compared with others, the strongest ones
MAX_NAMES = 5  # maximum number of photos named in a message
NO_VECTOR = np.zeros(0, np.float32)
FileState = Tuple[int, int, int]  # size in bytes, mtime and ctime in nanoseconds


class PhotoFeatures(NamedTuple):
    """Features of one photo."""

    digest: str  # of the file's content
    state: FileState  # of the file, to detect changes
    kinds: Tuple[Keypoints, ...]  # see KeypointExtractor
    vector: np.ndarray = NO_VECTOR  # float32 (d,) global descriptor; d is 0 without one

    @property
    def count(self) -> int:
        """Number of keypoints of all kinds."""
        return sum(len(each.positions) for each in self.kinds)


class KeypointExtractor:
    """Extracts the kinds of keypoints of an index: with its parameters and, in large images, fine ones."""

    def __init__(self, params: IndexParams):
        """:raises ValueError: invalid parameters"""
        coarse, fine = params.feature_params(), params.fine_params()
        self._most = None if params.matcher else MAX_COMPARED
        self._extractors = [sextant.FeatureExtractor(each) for each in (coarse, fine) if each]
        self._max_side = coarse.max_side

    def extract(self, image: np.ndarray) -> Tuple[Keypoints, ...]:
        """One or two kinds of keypoints; the second one has none if the image is not larger than max_side.

        :param image: uint8, (height, width) grey or (height, width, 3) BGR
        """
        first, *others = self._extractors
        if not others or max(image.shape[:2]) <= self._max_side:
            coarse = self._strongest(first, image)
            none = Keypoints(coarse.positions[:0], coarse.descriptors[:0])
            return (coarse, *(none for _ in others))
        with ThreadPoolExecutor(1) as threads:  # some steps of OpenCV's SIFT use one thread only
            coarse = threads.submit(self._strongest, first, image)
            fine = [self._strongest(each, image) for each in others]
            return (coarse.result(), *fine)

    def _strongest(self, extractor: sextant.FeatureExtractor, image: np.ndarray) -> Keypoints:
        found = extractor.extract(image)
        order = np.argsort(-found.keypoints[:, 4], kind="stable")[: self._most]
        scaled = found.keypoints[order, :2] * (UNIT / max(found.size))
        positions = np.clip(np.rint(scaled), 0, UNIT).astype(np.uint16)
        return Keypoints(positions, found.descriptors[order])


def file_state(path: Path) -> FileState:
    """State of a file; raises OSError if it does not exist."""
    status = path.stat()
    return status.st_size, status.st_mtime_ns, status.st_ctime_ns


def photo_features(params: IndexParams, path: Path) -> PhotoFeatures:
    """Reads a photo and extracts its features.

    :raises OSError: it cannot be read
    :raises ValueError: it is not an image, is damaged, or has too many keypoints
    """
    state, content = file_state(path), path.read_bytes()
    image, network = decode_photo(params, content, path), params.global_descriptor
    vector = cached_descriptor(network).describe(image) if network else NO_VECTOR
    kinds = KeypointExtractor(params).extract(image)
    count = max(len(each.positions) for each in kinds)
    if count > MAX_KEYPOINTS:
        raise ValueError(f"{count} keypoints, allowed are {MAX_KEYPOINTS}; set max_features")
    return PhotoFeatures(content_digest(content), state, kinds, vector)


def decode_photo(params: IndexParams, content: bytes, path: Path) -> np.ndarray:
    """Decodes a photo for description: grey, or BGR for a global descriptor; large photos are reduced.

    :raises: as decode_grey()
    """
    fine, side = params.fine_params(), params.feature_params().max_side
    side = fine.max_side if fine else side
    if not params.global_descriptor:
        return decode_grey(content, path, side)
    return decode_colour(content, path, side and max(side, *cached_descriptor(params.global_descriptor).size))


def extract_all(
    params: IndexParams, paths: Sequence[Path], jobs: int = 1, scheduler: str = ""
) -> List[PhotoFeatures]:
    """Extracts the features of photos, with a progress bar.

    :param jobs: scheduler: see sextant.base.jobs.run_jobs()
    :raises ValueError: names the photos that cannot be used
    """
    results = run_jobs(
        partial(photo_features, params), paths, jobs, scheduler, return_errors=True, progress="photos"
    )
    features = list(results)
    errors = [each for each in features if isinstance(each, JobError)]
    if errors:
        more = f"; and {len(errors) - MAX_NAMES} more" if len(errors) > MAX_NAMES else ""
        raise ValueError("; ".join(str(error) for error in errors[:MAX_NAMES]) + more)
    return features
