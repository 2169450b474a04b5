# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Renders the drive that the chain is fed with, and measures one plain search of every frame."""

import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Dict, List, Tuple

import cv2
import numpy as np
import yaml
from under_test import detector, locator

import sextant
from markers.detector_speed import plain_search
from sextant.simulation.drive import DriveParams, SimulatedDrive
from sextant.simulation.room_markers import default_map

ROUND = 600  # frames of one eight at 30 Hz: its last one and its first follow each other
WARM_UP = 3  # plain searches before those that count


@dataclass
class PlayedDrive:
    """Frames that were written, what is true of them, and the plain library on the same ones."""

    T_base_camera: np.ndarray
    arguments: Dict[str, str]  # of chain.launch
    truth: List[np.ndarray] = field(default_factory=list)  # T_map_base by frame
    locatable: List[int] = field(default_factory=list)  # frames with a pose by the same search, without ROS
    plain_cpu: List[float] = field(default_factory=list)  # seconds by frame
    plain_wall: List[float] = field(default_factory=list)


def play_of(folder: Path, family: str, size: Tuple[int, int], count: int) -> PlayedDrive:
    """Writes the first frames of a drive with calibration, map and detector parameters."""
    drive = SimulatedDrive(DriveParams(width=size[0], height=size[1]), default_map(family))
    played = PlayedDrive(drive.T_base_camera, _write_files(folder, drive))
    find, joint, plain = detector(family, search="tracking"), locator("joint"), plain_search(family)
    camera = sextant.CameraModel(drive.calibration)
    for frame in drive.frames(count):
        cv2.imwrite(str(folder / f"frames/{frame.index:06d}.pgm"), frame.image)
        played.truth.append(frame.T_map_base)
        view = sextant.MarkerView(camera, drive.T_base_camera, find.detect(frame.image, camera))
        if joint.locate(drive.map, [view]).pose:
            played.locatable.append(frame.index)
        for _ in range(WARM_UP if frame.index == 0 else 0):
            plain(frame.image)
        cpu, wall = time.process_time(), time.perf_counter()
        plain(frame.image)
        played.plain_cpu.append(time.process_time() - cpu)
        played.plain_wall.append(time.perf_counter() - wall)
    return played


def _write_files(folder: Path, drive: SimulatedDrive) -> Dict[str, str]:
    """:return: the arguments of chain.launch that name what was written"""
    (folder / "frames").mkdir(parents=True)
    sextant.write_marker_map(drive.map, str(folder / "map.yaml"))
    (folder / "camera.yaml").write_text(yaml.safe_dump(_camera_info(drive.calibration)))
    (folder / "detector.yaml").write_text(yaml.safe_dump({"enabled": False}))
    return {
        "frames": str(folder / "frames"),
        "map": str(folder / "map.yaml"),
        "calibration": str(folder / "camera.yaml"),
        "detector_params": str(folder / "detector.yaml"),
    }


def _camera_info(calibration: "sextant.CameraCalibration") -> dict:
    """As camera_info_manager reads it."""
    matrices = {
        "camera_matrix": calibration.K,
        "distortion_coefficients": np.array([calibration.D]),
        "rectification_matrix": np.eye(3),
        "projection_matrix": calibration.P,
    }
    return {
        "image_width": calibration.width,
        "image_height": calibration.height,
        "camera_name": "camera",
        "distortion_model": calibration.distortion_model,
        **{name: _yaml_matrix(matrix) for name, matrix in matrices.items()},
    }


def _yaml_matrix(matrix: np.ndarray) -> dict:
    rows, cols = matrix.shape
    return {"rows": rows, "cols": cols, "data": np.asarray(matrix, dtype=float).ravel().tolist()}
