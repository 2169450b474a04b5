# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Renders the frames that the chain is fed with, and the files that belong to them."""

from pathlib import Path
from typing import Dict, Iterator

import cv2
import numpy as np
import yaml
from under_test import locator

import sextant
from sextant.simulation.drive import DriveParams, SimulatedDrive
from sextant.simulation.room import default_map

PLAYED_FRAMES_A_RENDERED_ONE = 6  # so that the rendered ones fit into memory, decoded


def drive_of(family: str) -> SimulatedDrive:
    """1280 x 720, an eight of 300 frames; played at 30 Hz the robot drives twice as fast, unseen."""
    return SimulatedDrive(DriveParams(width=1280, height=720, rate=15.0), default_map(family))


def write_drive(
    folder: Path, drive: SimulatedDrive, find: "sextant.MarkerDetector", count: int
) -> Dict[str, str]:
    """Writes frames, calibration, map and detector parameters of a drive.

    Only frames that give a pose are kept: of the others no chain, however fast, could tell one.

    :return: the arguments of chain.launch that name what was written
    """
    frames = folder / "frames"
    frames.mkdir(parents=True)
    images = _locatable(drive, find)
    for index in range(count):
        cv2.imwrite(str(frames / f"{index:06d}.png"), next(images), [cv2.IMWRITE_PNG_COMPRESSION, 1])
    sextant.write_marker_map(drive.map, str(folder / "map.yaml"))
    (folder / "camera.yaml").write_text(yaml.safe_dump(_camera_info(drive.calibration)))
    (folder / "detector.yaml").write_text(yaml.safe_dump({"enabled": False}))
    return {
        "frames": str(frames),
        "map": str(folder / "map.yaml"),
        "calibration": str(folder / "camera.yaml"),
        "detector_params": str(folder / "detector.yaml"),
    }


def _locatable(drive: SimulatedDrive, find: "sextant.MarkerDetector") -> Iterator[np.ndarray]:
    camera, joint = sextant.CameraModel(drive.calibration), locator("joint")
    for frame in drive.frames(1_000_000):
        view = sextant.MarkerView(camera, drive.T_base_camera, find.detect(frame.image))
        if joint.locate(drive.map, [view]).pose:
            yield frame.image


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
