# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Trust on tagslam's recordings: single markers against the reference, half the markers against the other."""

from dataclasses import replace
from pathlib import Path
from typing import List, NamedTuple, Tuple

import numpy as np
from real_data import Observation, TagslamRecording, read_tagslam
from tables import Table, Value
from under_test import map_of

import sextant

OUTSIDE = 14.2  # squared Mahalanobis distance in position that one of 400 exceeds
NOISE_IMAGES = 200  # one rule for both: the corner noise is estimated from the first images
MAP_SIGMAS = (0.001, 0.002, 0.003, 0.005, 0.007, 0.01, 0.015, 0.02)  # m
ARM = 0.5  # m; a map entry off by sigma is turned by sigma / ARM
HALF_BARS = {"tagslam_16": 1.0, "tagslam_2": 0.5}  # cm, median
NEES_BARS = {"tagslam_16": 2.0}  # in degrees of freedom; at least the inverse


class Halves(NamedTuple):
    """Poses from the even against those from the odd ids."""

    distances: np.ndarray  # cm
    nees: np.ndarray  # of the difference, 6 degrees
    nees_position: np.ndarray


def trust_tables(folder: Path, quick: bool) -> List[Table]:
    """One table a recording. :raises OSError: a recording is not there"""
    return [trust_table(name, read_tagslam(folder / name), quick) for name in HALF_BARS]


def trust_table(name: str, recording: TagslamRecording, quick: bool) -> Table:
    """Figures of one recording; a quick run takes a few images and holds no bar."""
    images = recording.referenced()[: 40 if quick else None]
    taught = taught_localization(recording, images, recording.map)
    sigma = sextant.LocatorParams().corner_sigma
    rows = [
        (f"usual corner noise of {camera}, px", [Value(sigma * taught.noise_scale(index), 3)])
        for index, camera in enumerate(recording.cameras)
    ]
    distances = single_marker_distances(recording, images, taught)
    outside, halves = distances > OUTSIDE, hold_out(recording, images, taught, recording.map)
    bar, half_bar = NEES_BARS.get(name), HALF_BARS[name]
    rows += [
        ("single markers, published poses", [Value(len(distances), 0)]),
        (f"  beyond {OUTSIDE}, %", [Value(100 * np.mean(outside), at_most=None if quick else 1.0)]),
        ("even against odd, images", [Value(len(halves.nees), 0)]),
        ("  median, cm", [Value(_median(halves.distances), 3, at_most=None if quick else half_bar)]),
    ]
    for title, nees, freedoms in (("6", halves.nees, 6), ("position", halves.nees_position, 3)):
        most, least = (None, None) if quick or not bar else (bar, 1 / bar)
        cell = Value(_mean(nees) / freedoms, 3, at_most=most, at_least=least)
        rows.append((f"  NEES / degrees of freedom, {title}", [cell]))
    if not bar:
        rows.append(("  ... under 2 with a map sigma of, mm", [_needed_sigma(recording, images)]))
    return Table(f"{name}: recorded corners", ["figure"], rows, {"single markers": distances})


def taught_localization(recording: TagslamRecording, images: List[Observation], marker_map):
    """One that has learnt the noise of the cameras: one rule for both, from the first images."""
    localization = sextant.MarkerLocalization()
    for image in images[:NOISE_IMAGES]:
        _locate(localization, recording, image, marker_map)
    return localization


def single_marker_distances(recording: TagslamRecording, images: List[Observation], taught) -> np.ndarray:
    """(N,) squared Mahalanobis distances in position to the reference, of every marker alone."""
    distances = []
    for image in images:
        for detection in image.detections:
            pose = _locate(taught, recording, replace(image, detections=[detection]), recording.map)
            if pose:
                error = pose.T_map_base[:3, 3] - recording.trajectory[image.stamp][:3, 3]
                distances.append(error @ np.linalg.solve(pose.covariance[:3, :3], error))
    return np.array(distances)


def hold_out(recording: TagslamRecording, images: List[Observation], taught, marker_map) -> Halves:
    """Of the images with at least two even and two odd ids."""
    found = []
    for image in images:
        halves = [[each for each in image.detections if each.id % 2 == odd] for odd in (0, 1)]
        if min(map(len, halves)) < 2:
            continue
        views = [replace(image, detections=half) for half in halves]
        even, odd = (_locate(taught, recording, view, marker_map) for view in views)
        if even and odd:
            found.append(_difference(even, odd))
    return Halves(*np.array(found).reshape(-1, 3).T)


def _locate(localization, recording: TagslamRecording, image: Observation, marker_map):
    view = recording.view(image)
    view.camera_index = list(recording.cameras).index(image.camera)
    return localization.locate(marker_map, [view]).pose


def _difference(even, odd) -> Tuple[float, float, float]:
    error = sextant.pose_error(even.T_map_base, odd.T_map_base)
    P = even.covariance + odd.covariance
    position = error[:3] @ np.linalg.solve(P[:3, :3], error[:3])
    return 100.0 * np.linalg.norm(error[:3]), error @ np.linalg.solve(P, error), position


def _needed_sigma(recording: TagslamRecording, images: List[Observation]) -> Value:
    for sigma in MAP_SIGMAS:
        marker_map = uncertain(recording.map, sigma)
        taught = taught_localization(recording, images, marker_map)
        if _mean(hold_out(recording, images, taught, marker_map).nees) <= 12.0:
            return Value(1000.0 * sigma, 1)
    return Value(float("nan"))


def uncertain(marker_map, sigma: float):
    """The map, every entry known to sigma metres and sigma / ARM radians."""
    covariance = np.diag([sigma**2] * 3 + [(sigma / ARM) ** 2] * 3)
    return map_of(
        sextant.MappedMarker(each.family, each.id, each.size, each.T_map_marker, each.name, covariance)
        for each in marker_map.markers
    )


def _median(values: np.ndarray) -> float:
    return float(np.median(values)) if len(values) else float("nan")


def _mean(values: np.ndarray) -> float:
    return float(np.mean(values)) if len(values) else float("nan")
