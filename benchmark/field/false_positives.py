# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Photos without markers: what is detected in them, by family, against the plain libraries.

The limits of the detector were chosen on every second photo of the list; only the others are counted.
"""

from pathlib import Path
from typing import Callable, List

import cv2
import numpy as np
from libapriltag import apriltag_detector
from opencv_aruco import opencv_detector
from tables import Row, Table, Value
from under_test import detector

import sextant

LARGE = {"tagCircle49h12": 1, "tagCustom48h12": 1, "tagStandard52h13": 0}  # bits that fit in the memory
MAX_HAMMING = 2
QUICK_FAMILIES = ("tag36h11", "DICT_4X4_50")
COLUMNS = ["library's", "ours, full", "ours, tracking"]


def false_positive_tables(places: Path, quick: bool) -> List[Table]:
    """One table. :raises OSError: a photo is not there"""
    images = photos_without_markers(places)
    families = QUICK_FAMILIES if quick else sextant.marker_families()
    rows = [_row(family, images[:10] if quick else images, quick) for family in families]
    return [Table(f"Detections in {len(images)} photos without markers", COLUMNS, rows)]


def photos_without_markers(places: Path) -> List[np.ndarray]:
    """Grey photos of a corridor and of streets: every second one."""
    paths = [*sorted(places.glob("corridor/*/*.jpg")), *sorted(places.glob("lund/*.jpg"))]
    if not paths:
        raise FileNotFoundError(f"{places} has no photos of a corridor or of Lund")
    return [cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) for path in paths[1::2]]


def _row(family: str, images: List[np.ndarray], quick: bool) -> Row:
    bits = LARGE.get(family, MAX_HAMMING)
    theirs = _count(_plain(family, bits), images)
    bar = None if quick else theirs
    ours = [
        _count(detector(family, search=name, max_hamming=bits).detect, images)
        for name in ("full", "tracking")
    ]
    return family, [Value(theirs, 0), *(Value(each, 0, at_most=bar) for each in ours)]


def _plain(family: str, bits: int) -> Callable[[np.ndarray], list]:
    if not family.startswith("DICT_"):
        return apriltag_detector(family, 1.0, bits)
    find = opencv_detector(family)
    return lambda image: list(find(image))


def _count(find: Callable[[np.ndarray], list], images: List[np.ndarray]) -> int:
    return sum(len(find(image)) for image in images)
