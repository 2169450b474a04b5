# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps made of slow drives past many markers, against the exact ones: how long, and how honest."""

import time
from typing import List, NamedTuple, Tuple

import numpy as np
from simulated_observations import (
    FAMILY,
    MIN_COSINE,
    NEAREST,
    SIZE,
    T_BASE_CAMERA,
    SimulatedCamera,
    corners_in_map,
)
from tables import Row, Table, Value
from under_test import map_of

import sextant
from mapping.simulated_maps import MapErrors, errors_of

LENS, SIZE_OF_IMAGE = "plumb_bob 4", (1280, 960)
ROWS = 5  # of markers on a wall
WIDEST = 1.3  # tangent of the angle to the optical axis up to which the lens's polynomial holds
FEATURES = 200  # random Fourier features (Rahimi and Recht 2007) of the corner errors
# Corner errors of detections in rendered images of a slow drive change over about this much of the view.
VIEW_PIXELS, VIEW_LOG_DISTANCE = 100.0, 0.2
SMOOTH, WHITE = 0.1, 0.1  # standard deviations of the smooth and of the white part, pixels
# Standard deviations of a calibration from a few dozen images of a chessboard.
FOCAL, CENTRE, RADIAL = 0.001, 1.0, 0.002  # relative; pixels; of the first coefficient
WHOLE_ROUND = 1000  # images of one round, after which every marker was seen well
STEP = 2.0 * np.pi / WHOLE_ROUND
MOVED = 5  # id of a marker that is seen before and after the middle of a drive
NEES, SECONDS, MAX_TAGS = (0.8, 1.25), 120.0, 40  # bars, that of the time up to so many tags an image
COLUMNS = [
    "tags an image",
    "markers",
    "seen, not in it",
    "position RMSE, mm",
    "NEES / d.o.f.",
    "longest, s",
    "of it CPU",
]


class Drive(NamedTuple):
    """The extent of a drive."""

    markers: int
    images: int
    tags: int  # maximum number in an image
    moved: float = 0.0  # metres that marker MOVED is raised by in the middle of the drive


class Made(NamedTuple):
    """A map of a drive."""

    errors: MapErrors
    tags: float  # mean number in an image
    cpu_seconds: float


def large_map_tables(quick: bool) -> List[Table]:
    """Of simulated drives; a quick run is a small one, without bars."""
    if quick:
        drives = [(Drive(40, 100, 20), 1)]
    else:
        drives = [
            (Drive(200, 2000, 40), 20),
            (Drive(200, 1000, 40), 1),
            (Drive(560, 250, 200), 1),
            (Drive(200, 2000, 40, moved=0.3), 1),
        ]
    rows = [_row(drive, [make(drive, seed) for seed in range(count)], quick) for drive, count in drives]
    title = "Maps of slow drives: corner errors correlated between images, a lens not quite as calibrated"
    return [Table(title, COLUMNS, rows)]


def _row(drive: Drive, made: List[Made], quick: bool) -> Row:
    tags, cpu, missing, nees, seconds = np.array(
        [(tags, cpu, each.missing, each.nees, each.seconds) for each, tags, cpu in made]
    ).T
    position = np.concatenate([each.errors.position for each in made])
    cells = [
        Value(float(np.mean(tags)), 1),
        Value(len(position) / len(made) + 1.0, 1),
        _missing(drive, int(np.sum(missing)), len(made)),
        Value(1000.0 * float(np.sqrt(np.mean(position**2)))),
        _nees(nees),
        Value(float(np.max(seconds)), 1, at_most=None if quick or drive.tags > MAX_TAGS else SECONDS),
        Value(float(np.max(cpu)), 1),
    ]
    moved = f", one raised by {drive.moved} m halfway" if drive.moved else ""
    return f"{drive.markers} markers{moved}, {drive.images} images, drives: {len(made)}", cells


def _missing(drive: Drive, found: int, drives: int) -> Value:
    """The moved marker, and no other, after a whole round."""
    right = drives if drive.moved else 0
    whole = drive.images >= WHOLE_ROUND
    return Value(found, 0, at_least=right if whole else None, at_most=right if whole else None)


def _nees(found: np.ndarray) -> Value:
    """The mean, with bars if there are several."""
    least, most = NEES if len(found) > 1 else (None, None)
    return Value(float(np.mean(found)), at_least=least, at_most=most)


def make(drive: Drive, seed: int) -> Made:
    """Makes the map of a drive with this seed."""
    truth = hall_map(seed, drive.markers)
    instants = SlowDrive(drive, seed, truth).instants()
    begin = time.process_time()
    errors = errors_of(truth, instants)
    seconds = time.process_time() - begin
    return Made(errors, float(np.mean([len(each.views[0].detections) for each in instants])), seconds)


def hall_map(seed: int, count: int):
    """sextant.MarkerMap of the four walls of a hall of 12 x 8 m, markers not quite upright."""
    random, columns, markers = np.random.default_rng([seed, 17]), count // (4 * ROWS), []
    for id in range(count):
        wall, row, column = id % 4, id // 4 % ROWS, id // (4 * ROWS)
        away, half = (4.0, 6.0) if wall % 2 == 0 else (6.0, 4.0)
        side = ((column + 0.5) / columns * 2.0 - 1.0) * 0.9 * half + random.uniform(-0.1, 0.1)
        T_map_wall = sextant.pose_from_xyz_rpy([0.0, 0.0, 0.0], [0.0, 0.0, 0.5 * np.pi * wall])
        tilt = [0.5 * np.pi, 0.0, 0.0] + 0.03 * random.normal(size=3)
        height = 0.4 + 0.45 * row + random.uniform(-0.05, 0.05)
        T_wall_marker = sextant.pose_from_xyz_rpy([side, away + random.uniform(-0.1, 0.1), height], tilt)
        markers.append(sextant.MappedMarker(FAMILY, id, SIZE, T_map_wall @ T_wall_marker))
    return map_of(markers)


class SlowDrive:
    """A drive round and round in the hall, with views in all directions.

    The error of a corner depends on the view of its marker: it is nearly the same in successive images, and
    the same where the robot comes by again. The lens differs from its calibration.
    """

    def __init__(self, drive: Drive, seed: int, truth) -> None:
        self._drive, self._seed = drive, seed
        self._ids = [marker.id for marker in truth.markers]
        self._corners = np.array([corners_in_map(marker) for marker in truth.markers])
        self._normals = np.array([marker.T_map_marker[:3, 2] for marker in truth.markers])
        self._camera = SimulatedCamera(LENS, SIZE_OF_IMAGE, 0.0, seed)
        self._random = np.random.default_rng([seed, 23])
        shape = (len(self._ids), 4, 2, FEATURES)
        self._weights = SMOOTH * np.sqrt(2.0 / FEATURES) * self._random.normal(size=shape)
        self._phases = self._random.uniform(0.0, 2.0 * np.pi, FEATURES)
        self._waves = self._random.normal(size=(FEATURES, 3))
        self._lens = self._random.normal(size=5)

    def instants(self) -> list:
        """sextant.RecordedInstant by image."""
        return [sextant.RecordedInstant([self._view(T, i)]) for i, T in enumerate(self.poses())]

    def poses(self) -> List[np.ndarray]:
        """T_map_base (4, 4) by image; the first ones show marker 0, which is the known one."""
        angles = STEP * np.arange(self._drive.images)
        places = [[3.0 * np.cos(a), 1.8 * np.sin(a + 0.1 * self._seed), 0.0] for a in angles]
        return [sextant.pose_from_xyz_rpy(p, [0.0, 0.0, 2.6 + 1.5 * a]) for p, a in zip(places, angles)]

    def _view(self, T_map_base: np.ndarray, image: int):
        """sextant.MarkerView of a random choice of the markers in sight, as many as the drive allows."""
        T_map_camera, corners = T_map_base @ T_BASE_CAMERA, self._corners.copy()
        corners[self._ids.index(MOVED), :, 2] += self._drive.moved if 2 * image > self._drive.images else 0.0
        points = (corners - T_map_camera[:3, 3]) @ T_map_camera[:3, :3]
        seen, pixels = self._in_sight(points, self._normals @ T_map_camera[:3, :3])
        chosen = np.sort(self._random.permutation(len(seen))[: self._drive.tags])
        seen, pixels = seen[chosen], pixels[chosen]
        distances = np.linalg.norm(points[seen].mean(axis=1), axis=1)
        views = np.c_[pixels.mean(axis=1) / VIEW_PIXELS, np.log(distances) / VIEW_LOG_DISTANCE]
        corners = pixels + self._corner_errors(seen, views) + self._lens_errors(pixels)
        detections = [sextant.Detection(FAMILY, self._ids[i], each) for i, each in zip(seen, corners)]
        return sextant.MarkerView(self._camera.model, T_BASE_CAMERA, detections)

    def _in_sight(self, points: np.ndarray, normals: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Indices (M) and exact corners (M, 4, 2) of markers in the image, by corners in the camera frame."""
        centres = points.mean(axis=1)
        cosines = -np.sum(normals * centres, axis=1) / np.linalg.norm(centres, axis=1)
        rays = np.linalg.norm(points[..., :2], axis=2) / points[..., 2]
        front = np.all((points[..., 2] > NEAREST) & (rays < WIDEST), axis=1)
        seen = np.flatnonzero(front & (cosines > MIN_COSINE))
        pixels = self._camera.project(points[seen].reshape(-1, 3)).reshape(-1, 4, 2)
        inside = np.all((pixels > 0.0) & (pixels < np.array(SIZE_OF_IMAGE) - 1.0), axis=(1, 2))
        return seen[inside], pixels[inside]

    def _corner_errors(self, seen: np.ndarray, views: np.ndarray) -> np.ndarray:
        waves = np.cos(views @ self._waves.T + self._phases)
        smooth = np.einsum("mkif,mf->mki", self._weights[seen], waves)
        return smooth + WHITE * self._random.normal(size=smooth.shape)

    def _lens_errors(self, pixels: np.ndarray) -> np.ndarray:
        """Of a lens whose true parameters are a little off those calibrated."""
        f, centre = 0.5 * SIZE_OF_IMAGE[0], np.array(SIZE_OF_IMAGE) / 2 - 0.5
        ray = (pixels - centre) / f
        scale = FOCAL * self._lens[:2] + RADIAL * self._lens[4] * np.sum(ray**2, axis=-1, keepdims=True)
        return f * ray * scale + CENTRE * self._lens[2:4]
