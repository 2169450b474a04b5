# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Estimates the noise of detected corners from recordings of a static scene."""

from dataclasses import dataclass
from typing import Collection, Dict, Iterator, List, Sequence, Tuple

import numpy as np

import sextant
from sextant.evaluation.accuracy_yaml import CornerNoise
from sextant.localization.drive_observations import DriveObservations

MIN_PAIRS = 20  # minimum number of image pairs
MAX_RATIO = 25.0  # to the median variance; pairs above are disturbances
MIN_SIGMA = 0.01  # pixels, lower limit of the estimate
MAX_SIGMA = 3.0  # pixels; larger scatter is motion

Key = Tuple[str, int]  # family, id of a marker
Track = List["sextant.Detection"]  # detections of one marker in consecutive images


@dataclass(frozen=True)
class Scatter:
    """Scatter of the corners of one marker in one recording."""

    pairs: int  # number of pairs of consecutive images
    variance: float  # of a corner coordinate, pixels^2
    reported: float  # the part that Detection.corner_sigmas account for, pixels^2


def corner_noise(drives: Sequence[DriveObservations], keys: Collection[Key]) -> CornerNoise:
    """Estimates the common corner noise: LocatorParams.corner_sigma, to which the locator adds
    Detection.corner_sigmas.

    It is computed from differences of consecutive images (von Neumann 1941), so that slow drift, e.g. of a
    tripod or a warming camera, does not count as noise. Recordings are weighted by their number of images.

    :param keys: (family, id) of the measured markers; others may be false detections
    :raises ValueError: too few images, or a moving camera
    """
    scatters = [scatter for drive in drives for track in _tracks(drive, keys) for scatter in _scatter(track)]
    pairs = sum(each.pairs for each in scatters)
    if pairs < MIN_PAIRS:
        raise ValueError(f"the corner noise needs {MIN_PAIRS} pairs of images of a marker, there are {pairs}")
    variance, reported = (
        sum(each.pairs * getattr(each, name) for each in scatters) / pairs
        for name in ("variance", "reported")
    )
    if np.sqrt(variance) > MAX_SIGMA:
        raise ValueError(
            f"corners move by {np.sqrt(variance):.3g} px from image to image: did the camera stand still?"
        )
    common = max(np.sqrt(max(variance - reported, 0.0)), MIN_SIGMA)
    return CornerNoise(
        float(common),
        f"From {pairs} pairs of consecutive images: corner coordinates scatter by {np.sqrt(variance):.3g} px,"
        f" of which corner_sigmas account for {np.sqrt(reported):.3g} px.",
    )


def _tracks(drive: DriveObservations, wanted: Collection[Key]) -> Iterator[Track]:
    tracks: Dict[Tuple[str, str, int], Track] = {}
    for image in drive.images:
        keys = [(image.camera, marker.family, marker.id) for marker in image.markers]
        for key, marker in zip(keys, image.markers):
            if keys.count(key) == 1 and key[1:] in wanted:
                tracks.setdefault(key, []).append(marker)
    yield from tracks.values()


def _scatter(track: Track) -> List[Scatter]:
    """Computes the scatter of a track; empty for a single image."""
    if len(track) < 2:
        return []
    steps = np.diff([marker.corners for marker in track], axis=0)
    variances = np.square(steps).mean(axis=(1, 2)) / 2.0
    calm = variances <= MAX_RATIO * np.median(variances)
    reported = np.square([np.maximum(marker.corner_sigmas, 0.0) for marker in track]).mean(axis=1)
    return [Scatter(int(calm.sum()), float(variances[calm].mean()), float(reported.mean()))]
