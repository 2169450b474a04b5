# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps of the simulated building: its markers, the floor plan, and photos of an earlier day with their poses.

All are in the frame FRAME. The poses of the photos have small errors, as those of a recorded round do.
"""

from pathlib import Path
from typing import List, NamedTuple, Tuple

import cv2
import numpy as np

import sextant
from sextant.base.atomic_file import atomic_file
from sextant.buildings.building_looks import (
    MARKER_HEIGHT,
    MARKER_SIZE,
    PHOTO_DAY,
    PILLAR_RADIUS,
    BuildingLooks,
)
from sextant.buildings.building_view import BuildingCamera, building_view
from sextant.geometry.plane_poses import composed
from sextant.place_maps.photo_poses import PhotoCamera, PhotoPoses, PosedPhoto, poses_path, write_photo_poses
from sextant.place_maps.place_map import MetricFrame, Overview, PlaceMap
from sextant.place_maps.place_map_addition import NewPhoto, add_photos
from sextant.place_maps.place_map_file import write_place_map
from sextant.simulation.building import DEEP, FAMILY, HALF_WIDTH, LENGTH, LOWER, UPPER, Building

FRAME = "map"
MAP, PLAN, PLAN_FILE = "map.txt", "plan.png", "plan.yaml"
RESOLUTION, MARGIN = 0.05, 1.0  # of the plan: metres per pixel, metres around the building
FREE, OCCUPIED = 254, 40  # grey levels of the plan; map_server takes below 89 as occupied
SIGMAS = np.array([0.03, 0.03, 0.01])  # of mapped poses: metres, metres, radians
SEED = 7  # of these errors
SAME_PLACE = 0.3  # metres between photos of one place, in several directions
QUALITY = 90  # of the JPEG files


class _Shot(NamedTuple):
    image: str  # file name
    pose: np.ndarray  # (3,) true one of the robot
    mapped: np.ndarray  # (3,) the one in the map


def true_marker_map(building: Building) -> "sextant.MarkerMap":
    """The markers where they are."""
    found = sextant.MarkerMap(FRAME)
    for marker in building.markers:
        x, y, normal = marker.pose
        upright = [0.5 * np.pi, 0.0, normal + 0.5 * np.pi]
        T_map_marker = sextant.pose_from_xyz_rpy([x, y, MARKER_HEIGHT], upright)
        found.add(sextant.MappedMarker(FAMILY, marker.id, MARKER_SIZE, T_map_marker))
    return found


def has_building_map(folder: Path) -> bool:
    """Whether the folder contains the place map; it is written last."""
    return (folder / MAP).is_file()


def write_building_map(folder: Path, building: Building, camera: BuildingCamera, spacing: float) -> Path:
    """Writes the floor plan, the photos of an earlier day, their poses and the place map.

    :param spacing: distance between photos, metres
    :returns: the file of the place map
    :raises OSError: a file cannot be written
    """
    folder.mkdir(parents=True, exist_ok=True)
    frame, overview = _write_plan(folder, building)
    looks, shots = BuildingLooks(building, day=PHOTO_DAY), _shots(building, spacing)
    for number, shot in enumerate(shots):
        _write(folder / shot.image, building_view(building, looks, camera, shot.pose, number))
    taken_by = PhotoCamera(camera.calibration())
    posed = {shot.image: PosedPhoto(taken_by, camera.pose(shot.mapped)) for shot in shots}
    write_photo_poses(poses_path(folder / MAP), PhotoPoses(FRAME, posed))
    photos = [
        NewPhoto(shot.image, *frame.pixel(overview, *shot.mapped[:2]), frame.photo_yaw(shot.mapped[2]))
        for shot in shots
    ]
    place_map, _ = add_photos(PlaceMap(folder, overview, (), frame), photos, SAME_PLACE / RESOLUTION)
    write_place_map(folder / MAP, place_map)
    return folder / MAP


def _shots(building: Building, spacing: float) -> List[_Shot]:
    """Along every way of the building, in both directions."""
    rng, shots = np.random.default_rng(SEED), []
    for begin, neighbours in building.edges.items():
        for end in neighbours:
            way = building.nodes[end] - building.nodes[begin]
            count = max(1, round(np.linalg.norm(way) / spacing))
            for share in (np.arange(count) + 0.5) / count:
                pose = np.array([*(building.nodes[begin] + share * way), np.arctan2(way[1], way[0])])
                mapped = composed(pose, SIGMAS * rng.standard_normal(3))
                shots.append(_Shot(f"photo_{len(shots):04}.jpg", pose, mapped))
    return shots


def _write_plan(folder: Path, building: Building) -> Tuple[MetricFrame, Overview]:
    """The floor plan: an overview of the place map, and an occupancy grid for map_server."""
    low = np.array([0.0, LOWER - HALF_WIDTH - DEEP]) - MARGIN
    high = np.array([LENGTH, UPPER + HALF_WIDTH + DEEP]) + MARGIN
    columns, rows = np.rint((high - low) / RESOLUTION).astype(int)
    x = low[0] + RESOLUTION * (np.arange(columns) + 0.5)
    y = high[1] - RESOLUTION * (np.arange(rows) + 0.5)
    inside = building.is_inside(np.stack(np.meshgrid(x, y), axis=-1))
    plan = np.where(inside, FREE, OCCUPIED).astype(np.uint8)
    for pillar in building.pillars:
        column, row = np.rint((pillar - [low[0], high[1]]) / [RESOLUTION, -RESOLUTION]).astype(int).tolist()
        cv2.circle(plan, (column, row), round(PILLAR_RADIUS / RESOLUTION), OCCUPIED, -1)
    _write(folder / PLAN, plan)
    origin = (*low.tolist(), 0.0)
    with atomic_file(folder / PLAN_FILE) as file:
        file.write(
            f"image: {PLAN}\nresolution: {RESOLUTION}\norigin: {list(origin)}\n"
            "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
        )
    return MetricFrame(FRAME, RESOLUTION, origin), Overview(PLAN, int(columns), int(rows))


def _write(path: Path, image: np.ndarray) -> None:
    if not cv2.imwrite(str(path), image, [cv2.IMWRITE_JPEG_QUALITY, QUALITY]):
        raise OSError(f"{path}: cannot be written")
