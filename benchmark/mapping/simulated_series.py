# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Series of one marker at 16 distances: published covariances against the scatter of the poses."""

from typing import Callable, Dict, List, NamedTuple, Optional, Tuple

import cv2
import numpy as np
from simulated_observations import SIZE
from tables import Table, Value
from under_test import detector, map_of

import sextant
from sextant.commands.located_bags import localization_params
from sextant.evaluation.corner_scatter import MIN_SIGMA, corner_noise
from sextant.evaluation.pose_series import GroundTruth, pose_series, series_statistics
from sextant.localization.drive_observations import DriveCamera, DriveObservations, ImageDetections
from sextant.localization.located_drive import locate_drive
from sextant.simulation.camera import camera_calibration
from sextant.simulation.room_markers import room_for

DISTANCES = (0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0, 6.5, 7.0)  # m
FAMILY, ID = "DICT_4X4_50", 0
ENOUGH = 100  # poses, from which a deviation is known to 7 %
WITHIN = 1.5
PLACED, TURNED = 0.02, 0.02  # m and rad: how exactly a camera is put where it should be
LENSES = {"62 degrees": np.deg2rad(62.0), "90 degrees": np.deg2rad(90.0)}
SIZES = ((640, 480), (1280, 720))
COLUMNS = [
    "distances",
    "corner sigma, px",
    *(f"{axis}: {end}" for axis in "xyz" for end in ("least", "largest")),
]
NO_TRUTH = GroundTruth(others=dict.fromkeys(("x", "y", "roll", "pitch", "yaw")))
STEP = 50_000_000  # ns between two images
MAP = map_of([sextant.MappedMarker(FAMILY, ID, SIZE, np.eye(4))])


class Ratios(NamedTuple):
    """Ratios of published deviations to those of the poses."""

    corner_sigma: float  # that the series themselves show, pixels
    published: Dict[float, np.ndarray]  # (3) x y z by distance, of those with enough poses


def series_tables(quick: bool) -> List[Table]:
    """Corners with noise of a camera that stands still; rendered images, the camera put anew for each."""
    count, distances = (ENOUGH, DISTANCES[::8]) if quick else (400, DISTANCES)
    rows = []
    for lens, field in LENSES.items():
        for size in SIZES:
            for sigma in (0.1, 0.3):
                found = still_ratios(size, field, sigma, count, distances)
                rows.append((f"corners, {sigma} px; {size[0]}, {lens}", _cells(found, bars=not quick)))
    for size in SIZES[:1] if quick else SIZES:
        found = rendered_ratios(size, ENOUGH if quick else 150, distances)
        rows.append((f"rendered images; {size[0]}, 62 degrees", _cells(found, bars=False)))
    title = f"One marker of {SIZE} m at {len(distances)} distances: published over actual deviation"
    return [Table(title, COLUMNS, rows)]


def _cells(found: Ratios, bars: bool) -> List[Value]:
    least, most = (round(1.0 / WITHIN, 3), WITHIN) if bars else (None, None)
    published = np.array(list(found.published.values())).reshape(-1, 3)
    if not len(published):
        published = np.full((1, 3), np.nan)
    pairs = zip(published.min(axis=0), published.max(axis=0))
    ends = [cell for low, high in pairs for cell in (Value(low, at_least=least), Value(high, at_most=most))]
    count = Value(len(found.published), 0, at_least=len(DISTANCES) if bars else None)
    return [count, Value(found.corner_sigma, 3), *ends]


def still_ratios(
    size: Tuple[int, int], field: float, sigma: float, count: int, distances: Tuple[float, ...]
) -> Ratios:
    """As accuracy_statistics finds them: the noise is what all series show.

    :param field: of view, radians
    :param sigma: noise of a corner coordinate, pixels
    """
    random, known = np.random.default_rng(3), camera_calibration(*size, field)
    drives = {}
    for distance in distances:
        exact = _exact_corners(known, _placed(distance, random))
        drives[distance] = _drive(known, exact + sigma * random.normal(size=(count, 4, 2)))
    found = corner_noise(list(drives.values()), {(FAMILY, ID)}).sigma
    published = {distance: _still_ratio(drive, found) for distance, drive in drives.items()}
    return Ratios(found, {distance: each for distance, each in published.items() if each is not None})


def _placed(distance: float, random: np.random.Generator) -> np.ndarray:
    """T_marker_camera (4, 4) of a camera that looks at the marker, about."""
    xyz = np.array([0.0, 0.0, distance]) + PLACED * random.normal(size=3)
    turned = sextant.pose_from_xyz_rpy([0.0, 0.0, 0.0], TURNED * random.normal(size=3))
    return sextant.pose_from_xyz_rpy(xyz, [np.pi, 0.0, 0.0]) @ turned


def _exact_corners(known, T_marker_camera: np.ndarray) -> np.ndarray:
    """(4, 2) pixels, by OpenCV's own projection."""
    points = np.c_[sextant.marker_corners(SIZE), np.ones(4)] @ np.linalg.inv(T_marker_camera).T
    points, none = np.ascontiguousarray(points[:, :3]), np.zeros(3)
    pixels, _ = cv2.projectPoints(points, none, none, np.array(known.K), np.array(known.D))
    return pixels.reshape(4, 2)


def _drive(known, corners: np.ndarray) -> DriveObservations:
    """What a bag of these corners (N, 4, 2) holds."""
    images = [
        ImageDetections(k * STEP, "camera", [sextant.Detection(FAMILY, ID, each)])
        for k, each in enumerate(corners)
    ]
    return DriveObservations("series", {"camera": DriveCamera(known)}, images)


def _still_ratio(drive: DriveObservations, corner_sigma: float) -> Optional[np.ndarray]:
    located = locate_drive(drive, MAP, localization_params(corner_sigma))
    if len(located.stamps) < ENOUGH:
        return None
    series = pose_series(1.0, "series", located.stamps, located.poses, located.covariances)
    of = series_statistics(series, NO_TRUTH)
    return (of.published / of.std)[:3]


def rendered_marker(known, family: str) -> Callable[[np.ndarray, int], np.ndarray]:
    """What renders the marker, in a room, by T_marker_camera and number of the image."""
    T_map_marker = sextant.pose_from_xyz_rpy([0.0, 4.5, 1.0], [0.5 * np.pi, 0.0, 0.0])
    room = map_of([sextant.MappedMarker(family, ID, SIZE, T_map_marker)])
    scene = sextant.RoomScene(room_for(room, obstacles=False), room)
    renderer = sextant.RoomRenderer(sextant.RoomRendererParams(), scene, sextant.CameraModel(known))
    return lambda T_marker_camera, number: renderer.render([T_map_marker @ T_marker_camera], number)


def rendered_ratios(size: Tuple[int, int], count: int, distances: Tuple[float, ...]) -> Ratios:
    """Deviations of the errors, since the camera is put anew for every image: what stays the same in those of
    a static camera (the marker's pixel position) is an error as well, and is in the published covariance.

    Without a bar: the reported corner noise has a floor of 0.02 px for print and lens, which a rendered
    marker does not need. So the published deviation of z up to 4 m is larger than the errors."""
    known, random = camera_calibration(*size), np.random.default_rng(3)
    camera, find, rendered = sextant.CameraModel(known), detector(FAMILY), rendered_marker(known, FAMILY)
    params, published = localization_params(MIN_SIGMA), {}
    for distance in distances:
        errors, variances = [], []
        for k in range(count):
            truth = _placed(distance, random)
            view = sextant.MarkerView(camera, np.eye(4), find.detect(rendered(truth, k), camera))
            pose = sextant.MarkerLocalization(params).locate(MAP, [view]).pose
            if pose is not None:
                errors.append((pose.T_map_base - truth)[:3, 3])
                variances.append(np.diag(pose.covariance)[:3])
        if len(errors) >= ENOUGH:
            published[distance] = np.sqrt(np.mean(variances, axis=0)) / np.std(errors, axis=0, ddof=1)
    return Ratios(MIN_SIGMA, published)
