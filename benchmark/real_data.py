# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads the external test data, which is not part of this package: photos and recordings by others."""

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
from under_test import map_of

import sextant

EXTERNAL = Path(__file__).resolve().parents[2] / "shared/data"
DISTORTION_MODELS = {"radtan": "plumb_bob", "equidistant": "equidistant"}  # Kalibr's names

# Indices of tagslam's corners, which start at the bottom left, counterclockwise, in the order of Detection.
TAGSLAM_CORNERS = [3, 2, 1, 0]

Pixels = np.ndarray  # (4, 2), corners in the order of sextant.Detection


def calibration(size: Sequence[int], K: Sequence[float], D: Sequence[float], model: str):
    """Returns a sextant.CameraCalibration of raw images; size in pixels (width, height), K row by row."""
    result = sextant.CameraCalibration()
    result.width, result.height = size
    result.distortion_model, result.D = model, list(D)
    result.K = np.array(K, dtype=float).reshape(3, 3)
    return result


@dataclass(frozen=True)
class Photos:
    """The folder of photos, and the results of other detectors on them (not ground truth)."""

    folder: Path

    @property
    def expected(self) -> dict:
        """Content of expected.yaml: pixels, metres, radians."""
        return yaml.safe_load((self.folder / "expected.yaml").read_text())

    @property
    def calibration(self):
        """Calibration of all photos in expected.yaml."""
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
        """Reads a photo, uint8 (height, width, 3) BGR."""
        image = cv2.imread(str(self.folder / name))
        if image is None:
            raise FileNotFoundError(f"{self.folder / name} is no image")
        return image

    def corners(self) -> Dict[str, Dict[int, Pixels]]:
        """Known corners (4, 2) in pixels, by photo and id."""
        photos = {name: known for name, known in self.expected.items() if name.startswith("tag_")}
        return {
            name: {id: np.array(corners) for id, corners in known.items()} for name, known in photos.items()
        }

    def outdoors(self) -> Dict[str, List[Tuple[int, Pixels]]]:
        """AprilTags (36h11) by photo; corners in libapriltag's order, so only their mean is used."""
        lists = sorted(self.folder.glob("*_c.txt"))
        return {path.with_suffix(".jpg").name: _read_tags(path) for path in lists}

    def bag_image(self) -> np.ndarray:
        """The only image of aruco_images.bag, (height, width, 3) BGR."""
        with rosbag.Bag(str(self.folder / "aruco_images.bag")) as bag:
            _, message, _ = next(bag.read_messages("/raspicam_node/image/compressed"))
        return cv2.imdecode(np.frombuffer(message.data, np.uint8), cv2.IMREAD_COLOR)


def _read_tags(path: Path) -> List[Tuple[int, Pixels]]:
    """Reads a list of tags: an id and four corners per line."""
    lines = [re.findall(r"-?\d+(?:\.\d+)?", line) for line in path.read_text().splitlines()]
    return [(int(id), np.array(pixels, dtype=float).reshape(4, 2)) for id, *pixels in filter(None, lines)]


@dataclass(frozen=True)
class Observation:
    """The detections in one image of a tagslam recording."""

    stamp: float  # seconds, as in the file
    camera: str
    detections: list  # sextant.Detection, raw pixels


@dataclass(frozen=True)
class TagslamRecording:
    """A recording, and tagslam's map and poses (a reference, not ground truth)."""

    cameras: dict  # sextant.CameraModel by name
    mounts: Dict[str, np.ndarray]  # T_rig_camera (4 x 4) by name
    map: "sextant.MarkerMap"
    trajectory: Dict[float, np.ndarray]  # T_map_rig (4 x 4) by stamp
    observations: List[Observation]

    def view(self, observation: Observation):
        """sextant.MarkerView of an observation."""
        camera = observation.camera
        return sextant.MarkerView(self.cameras[camera], self.mounts[camera], observation.detections)

    def referenced(self) -> List[Observation]:
        """Observations that contain a marker and whose stamp has a reference pose."""
        return [each for each in self.observations if each.detections and each.stamp in self.trajectory]


def read_tagslam(folder: Path) -> TagslamRecording:
    """Reads a tagslam recording.

    :raises OSError: a file is missing
    """
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
        cameras, mounts, _read_map(folder / "markers.csv"), poses, _read_observations(folder)
    )


def _read_map(path: Path):
    return map_of(
        sextant.MappedMarker("tag36h11", int(row["id"]), float(row["size"]), _row_pose(row))
        for row in _rows(path)
    )


def _read_observations(folder: Path) -> List[Observation]:
    with gzip.open(str(folder / "sightings.jsonl.gz"), "rt") as file:
        images = [json.loads(line) for line in file]
    return [
        Observation(image["stamp"], image["camera"], list(map(_detection, image["markers"])))
        for image in images
    ]


def _detection(marker: dict):
    return sextant.Detection("tag36h11", marker["id"], np.array(marker["corners"])[TAGSLAM_CORNERS])


def _rows(path: Path) -> List[dict]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def _row_pose(row: dict) -> np.ndarray:
    return _pose([float(row[name]) for name in ("x", "y", "z", "qx", "qy", "qz", "qw")])


def _pose(xyz_qxyzw: Sequence[float]) -> np.ndarray:
    """Pose (4, 4) from metres and a quaternion, which is normalized because the files have eight digits."""
    q = np.array(xyz_qxyzw[3:]) / np.linalg.norm(xyz_qxyzw[3:])
    axis_norm = np.linalg.norm(q[:3])
    angle = 2.0 * np.arctan2(axis_norm, q[3])
    T = np.eye(4)
    T[:3, :3] = sextant.exp_so3(q[:3] / axis_norm * angle if axis_norm > 0 else np.zeros(3))
    T[:3, 3] = xyz_qxyzw[:3]
    return T
