# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Forty tags in every image: what tracking costs against a full search."""

from pathlib import Path
from typing import Iterator, List

import numpy as np
from real_data import calibration
from tables import Table, Value
from under_test import map_of

import sextant
from field.images import TAGS, KnownImage, known_inside
from field.tracking import Race
from sextant.simulation.marker_wall import wall_room

COLUMNS_OF_TAGS, ROWS_OF_TAGS = 8, 5
SIDE, SPACING = 0.12, 0.22  # metres
DISTANCE = 1.6  # metres
SIZE, FOCAL_LENGTH = (1280, 720), 900.0  # pixels
MOST_CPU, LEAST = 0.3, 0.99
FRAMES, QUICK_FRAMES = 120, 6
COLUMNS = ["tags an image", "full", "tracking", "over full's", "CPU over full's"]


def crowd_tables(_data: Path, quick: bool) -> List[Table]:
    """One table."""
    images = list(crowded(QUICK_FRAMES if quick else FRAMES))
    rows = []
    for changed in ({}, {"decimate": 2.0}):
        race = Race(changed).run(images)
        share = Value(race.share, 3, at_least=None if quick else LEAST)
        cost = Value(race.cost, 3, at_most=None if quick or changed else MOST_CPU)
        counts = (
            Value(race.known / len(images), 1),
            Value(race.found["full"], 0),
            Value(race.found["tracking"], 0),
        )
        rows.append((", ".join([TAGS, *(f"{k} {v:g}" for k, v in changed.items())]), [*counts, share, cost]))
    return [Table("A wall of forty tags, 1280 x 720, a moving camera", COLUMNS, rows)]


def crowded(count: int) -> Iterator[KnownImage]:
    """Images of a wall of tags from a camera that moves to and fro, up and down, and turns."""
    marker_map = map_of(
        sextant.MappedMarker(TAGS, k, SIDE, _on_wall(k)) for k in range(COLUMNS_OF_TAGS * ROWS_OF_TAGS)
    )
    scene = sextant.RoomScene(wall_room(marker_map, DISTANCE, 0.0), marker_map)
    camera = sextant.CameraModel(_calibration())
    renderer = sextant.RoomRenderer(sextant.RoomRendererParams(), scene, camera)
    for k in range(count):
        T_map_camera = _moving(k / 30.0)
        corners = {marker.id: _corners(camera, T_map_camera, marker) for marker in marker_map.markers}
        yield KnownImage(renderer.render([T_map_camera], k), known_inside(corners, SIZE), frozenset(corners))


def _on_wall(k: int) -> np.ndarray:
    row, column = divmod(k, COLUMNS_OF_TAGS)
    x, z = SPACING * (column - 0.5 * (COLUMNS_OF_TAGS - 1)), SPACING * (row - 0.5 * (ROWS_OF_TAGS - 1))
    return sextant.pose_from_xyz_rpy([x, 0.0, z], [0.5 * np.pi, 0.0, 0.0])


def _calibration() -> "sextant.CameraCalibration":
    K = [FOCAL_LENGTH, 0.0, 0.5 * SIZE[0], 0.0, FOCAL_LENGTH, 0.5 * SIZE[1], 0.0, 0.0, 1.0]
    return calibration(SIZE, K, [], "plumb_bob")


def _moving(t: float) -> np.ndarray:
    """T_map_camera (4, 4) at a time in seconds."""
    xyz = [0.1 * np.sin(2.0 * t), -DISTANCE + 0.05 * np.sin(1.3 * t), 0.05 * np.sin(1.7 * t)]
    T_mount_optical = sextant.pose_from_xyz_rpy([0.0, 0.0, 0.0], [-0.5 * np.pi, 0.0, 0.0])
    return sextant.pose_from_xyz_rpy(xyz, [0.0, 0.05 * np.sin(t), 0.03 * np.sin(1.5 * t)]) @ T_mount_optical


def _corners(camera, T_map_camera: np.ndarray, marker) -> np.ndarray:
    points = np.c_[sextant.marker_corners(marker.size), np.ones(4)] @ marker.T_map_marker.T
    in_camera = points @ np.linalg.inv(T_map_camera).T
    return np.array([camera.project(point[:3]) for point in in_camera])
