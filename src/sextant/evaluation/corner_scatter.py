# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How noisy the corners are that a camera sees, from series during which nothing moved."""

from dataclasses import dataclass
from typing import Collection, Dict, Iterator, List, Sequence, Tuple

import numpy as np

import sextant
from sextant.evaluation.accuracy_yaml import CornerNoise
from sextant.localization.drive_sightings import DriveSightings

FEWEST = 20  # pairs of images, before which a scatter says little
DISTURBED = 25.0  # times the usual square: somebody walked through the picture, or against the table
LEAST = 0.01  # pixels: nothing that a camera sees is more exact
MOST = 3.0  # pixels: more is no noise

Key = Tuple[str, int]  # family, id of a marker
Track = List["sextant.Detection"]  # one marker, image after image


@dataclass(frozen=True)
class Scatter:
    """Of the corners of one marker in one series."""

    pairs: int  # of images in a row
    variance: float  # of a corner coordinate, pixels^2
    told: float  # the part of it that the corners tell of themselves (Detection.corner_sigmas), pixels^2


def corner_noise(drives: Sequence[DriveSightings], keys: Collection[Key]) -> CornerNoise:
    """The noise that all corners have in common: LocatorParams.corner_sigma, to which the locator adds what
    each corner tells of itself.

    From the differences of images in a row (von Neumann 1941): what drifts, such as a tripod or a warming
    camera, is no noise. Series count by their images.

    :param keys: (family, id) of the markers that were measured; others may be false detections
    :raises ValueError: too few images, or a camera that moved
    """
    scatters = [scatter for drive in drives for track in _tracks(drive, keys) for scatter in _scatter(track)]
    pairs = sum(each.pairs for each in scatters)
    if pairs < FEWEST:
        raise ValueError(f"the corners' noise needs {FEWEST} pairs of images of a marker, there are {pairs}")
    variance, told = (
        sum(each.pairs * getattr(each, name) for each in scatters) / pairs for name in ("variance", "told")
    )
    if np.sqrt(variance) > MOST:
        raise ValueError(
            f"corners move by {np.sqrt(variance):.3g} px from image to image: did the camera stand still?"
        )
    common = max(np.sqrt(max(variance - told, 0.0)), LEAST)
    return CornerNoise(
        float(common),
        f"Of {pairs} pairs of images in a row: corner coordinates scatter by {np.sqrt(variance):.3g} px, "
        f"{np.sqrt(told):.3g} px of which each corner tells of itself.",
    )


def _tracks(drive: DriveSightings, wanted: Collection[Key]) -> Iterator[Track]:
    tracks: Dict[Tuple[str, str, int], Track] = {}
    for image in drive.images:
        keys = [(image.camera, marker.family, marker.id) for marker in image.markers]
        for key, marker in zip(keys, image.markers):
            if keys.count(key) == 1 and key[1:] in wanted:
                tracks.setdefault(key, []).append(marker)
    yield from tracks.values()


def _scatter(track: Track) -> List[Scatter]:
    """Nothing of a single image."""
    if len(track) < 2:
        return []
    steps = np.diff([marker.corners for marker in track], axis=0)
    variances = np.square(steps).mean(axis=(1, 2)) / 2.0
    calm = variances <= DISTURBED * np.median(variances)
    told = np.square([np.maximum(marker.corner_sigmas, 0.0) for marker in track]).mean(axis=1)
    return [Scatter(int(calm.sum()), float(variances[calm].mean()), float(told.mean()))]
