# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Photos and sightings recorded by others: the external test data, which is no part of this package."""

import csv
import gzip
import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Dict, List, Sequence, Tuple

import cv2
import numpy as np
import rosbag
import yaml

import sextant

EXTERNAL = Path(__file__).resolve().parents[2] / "shared/data"
DISTORTION_MODELS = {"radtan": "plumb_bob", "equidistant": "equidistant"}  # Kalibr's names

# tagslam counts the corners from the bottom left, counterclockwise.
TAGSLAM_CORNERS = [3, 2, 1, 0]

Pixels = np.ndarray  # (4, 2), corners in the order of sextant.Detection


def calibration(size: Sequence[int], K: Sequence[float], D: Sequence[float], model: str):
    """sextant.CameraCalibration of a raw image; size in pixels (width, height), K row by row."""
    result = sextant.CameraCalibration()
    result.width, result.height = size
    result.distortion_model, result.D = model, list(D)
    result.K = np.array(K, dtype=float).reshape(3, 3)
    return result


@dataclass(frozen=True)
class Photos:
    """The folder of photos, and what is known of them (from other detectors, not a truth)."""

    folder: Path

    @property
    def expected(self) -> dict:
        """expected.yaml: pixels, metres, radians."""
        return yaml.safe_load((self.folder / "expected.yaml").read_text())

    @property
    def calibration(self):
        """Of every photo of expected.yaml."""
        camera = self.expected["camera"]
        return calibration((1280, 960), camera["K"], camera["D"], camera["distortion_model"])

    @property
    def T_base_camera(self) -> np.ndarray:
        """Mount of the camera that took 403.jpg, 4 x 4."""
        mount = self.expected["403.jpg"]["T_base_camera"]
        return sextant.pose_from_xyz_rpy(mount["xyz"], mount["yaw_pitch_roll"][::-1])

    @property
    def T_map_marker(self) -> np.ndarray:
        """Pose of the marker of 403.jpg with the base at the map's origin, 4 x 4."""
        marker = self.expected["403.jpg"]["marker_403"]
        return sextant.pose_from_xyz_rpy(marker["xyz"], marker["roll_pitch_yaw"])

    def image(self, name: str) -> np.ndarray:
        """(height, width, 3) BGR."""
        image = cv2.imread(str(self.folder / name))
        if image is None:
            raise FileNotFoundError(f"{self.folder / name} is no image")
        return image

    def corners(self) -> Dict[str, Dict[int, Pixels]]:
        """Corners by photo and id."""
        photos = {name: known for name, known in self.expected.items() if name.startswith("tag_")}
        return {
            name: {id: np.array(corners) for id, corners in known.items()} for name, known in photos.items()
        }

    def outdoors(self) -> Dict[str, List[Tuple[int, Pixels]]]:
        """AprilTags (36h11) by photo; libapriltag's order of corners, good for their middle only."""
        lists = sorted(self.folder.glob("*_c.txt"))
        return {path.with_suffix(".jpg").name: _read_tags(path) for path in lists}

    def bag_image(self) -> np.ndarray:
        """The only image of aruco_images.bag, (height, width, 3) BGR."""
        with rosbag.Bag(str(self.folder / "aruco_images.bag")) as bag:
            _, message, _ = next(bag.read_messages("/raspicam_node/image/compressed"))
        return cv2.imdecode(np.frombuffer(message.data, np.uint8), cv2.IMREAD_COLOR)


def _read_tags(path: Path) -> List[Tuple[int, Pixels]]:
    lines = [re.findall(r"-?\d+(?:\.\d+)?", line) for line in path.read_text().splitlines()]
    return [(int(id), np.array(pixels, dtype=float).reshape(4, 2)) for id, *pixels in filter(None, lines)]


@dataclass(frozen=True)
class Sighting:
    """One image of a tagslam folder."""

    stamp: float  # seconds, as written
    camera: str
    detections: list  # sextant.Detection, raw pixels


@dataclass(frozen=True)
class TagslamRecording:
    """A recording, and the map and poses that tagslam made of it (a reference, not a truth)."""

    cameras: dict  # sextant.CameraModel by name
    mounts: Dict[str, np.ndarray]  # T_rig_camera (4 x 4) by name
    map: "sextant.MarkerMap"
    trajectory: Dict[float, np.ndarray]  # T_map_rig (4 x 4) by stamp
    sightings: List[Sighting]

    def view(self, sighting: Sighting):
        """sextant.MarkerView of a sighting."""
        camera = sighting.camera
        return sextant.MarkerView(self.cameras[camera], self.mounts[camera], sighting.detections)

    def referenced(self) -> List[Sighting]:
        """Those that saw a marker and whose stamp has a reference pose."""
        return [each for each in self.sightings if each.detections and each.stamp in self.trajectory]


def read_tagslam(folder: Path) -> TagslamRecording:
    """:raises OSError: a file is not there"""
    cameras, mounts = {}, {}
    for name, entry in yaml.safe_load((folder / "cameras.yaml").read_text()).items():
        fx, fy, cx, cy = entry["intrinsics_fx_fy_cx_cy"]
        model = DISTORTION_MODELS[entry["distortion_model"]]
        K = [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]
        cameras[name] = sextant.CameraModel(calibration(entry["resolution"], K, entry["distortion"], model))
        mounts[name] = _pose(entry["T_rig_camera_xyz_qxyzw"])
    (trajectory,) = folder.glob("trajectory_*.csv")
    poses = {float(row["stamp"]): _row_pose(row) for row in _rows(trajectory)}
    return TagslamRecording(
        cameras, mounts, _read_map(folder / "markers.csv"), poses, _read_sightings(folder)
    )


def _read_map(path: Path):
    marker_map = sextant.MarkerMap("map")
    for row in _rows(path):
        marker_map.add(sextant.MappedMarker("tag36h11", int(row["id"]), float(row["size"]), _row_pose(row)))
    return marker_map


def _read_sightings(folder: Path) -> List[Sighting]:
    with gzip.open(str(folder / "sightings.jsonl.gz"), "rt") as file:
        images = [json.loads(line) for line in file]
    return [
        Sighting(image["stamp"], image["camera"], list(map(_detection, image["markers"]))) for image in images
    ]


def _detection(marker: dict):
    return sextant.Detection("tag36h11", marker["id"], np.array(marker["corners"])[TAGSLAM_CORNERS])


def _rows(path: Path) -> List[dict]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def _row_pose(row: dict) -> np.ndarray:
    return _pose([float(row[name]) for name in ("x", "y", "z", "qx", "qy", "qz", "qw")])


def _pose(xyz_qxyzw: Sequence[float]) -> np.ndarray:
    """4 x 4 from metres and a quaternion, normalized here because the files have eight digits."""
    q = np.array(xyz_qxyzw[3:]) / np.linalg.norm(xyz_qxyzw[3:])
    axis_norm = np.linalg.norm(q[:3])
    angle = 2.0 * np.arctan2(axis_norm, q[3])
    T = np.eye(4)
    T[:3, :3] = sextant.exp_so3(q[:3] / axis_norm * angle if axis_norm > 0 else np.zeros(3))
    T[:3, 3] = xyz_qxyzw[:3]
    return T
