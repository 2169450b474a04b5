# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the reading of bags."""

from dataclasses import dataclass, field
from typing import Mapping, Sequence

import numpy as np

import sextant

NO_ODOMETRY = "none"


def _families() -> Sequence[str]:
    return tuple(sextant.DetectorParams().families)


@dataclass(frozen=True)
class BagParams:
    """What to read from a bag. Image topics may be given with or without `/compressed`.

    The topics in `images` and `markers` are read. If both are empty: all topics of sextant/MarkerArray. If
    there are none: one image topic for each camera_info, where raw is preferred to rectified, grey to colour,
    uncompressed to compressed. Depth images are never used.
    """

    images: Sequence[str] = ()  # topics of sensor_msgs/Image or CompressedImage
    markers: Sequence[str] = ()  # topics of sextant/MarkerArray
    families: Sequence[str] = field(default_factory=_families)  # marker families to detect in images
    # A calibration does not change recorded corners.
    calibrations: Mapping[str, str] = field(default_factory=dict)  # file by topic, instead of camera_info
    rectified: Sequence[str] = ()  # topics of rectified images; image_rect* always are
    camera_is_base: bool = False  # the only camera is the base; tf and odometry are not used
    base_frame: str = "base_link"  # frame of the robot; can also be the frame of a camera
    odometry: str = ""  # topic of nav_msgs/Odometry; empty: the only one, if any; "none": not read
    mounts: Mapping[str, np.ndarray] = field(
        default_factory=dict
    )  # T_base_camera by camera frame; overrides tf
    every: int = 1  # read every n-th image of a camera
    start: float = 0.0  # seconds after the first message of the bag, by the time of reception
    end: float = float("inf")  # likewise

    def __post_init__(self) -> None:
        """:raises ValueError: the first invalid field, its value and what is allowed"""
        for name in ("images", "markers", "families", "rectified"):
            _check_names(name, getattr(self, name))
        if not self.families:
            raise ValueError("families is empty: give at least one")
        for family in self.families:
            sextant.canonical_family(family)  # raises ValueError for an unknown family
        if not isinstance(self.every, int) or self.every < 1:
            raise ValueError(f"every is {self.every}, allowed is a whole number from 1 on")
        if not 0.0 <= self.start < self.end:
            raise ValueError(f"start is {self.start} and end {self.end}, allowed is 0 <= start < end")
        if not self.base_frame:
            raise ValueError("base_frame is empty: give the frame of the robot or of the camera")
        for frame, mount in self.mounts.items():
            _check_pose(f"mounts[{frame}]", np.asarray(mount, dtype=float))


def _check_names(name: str, values: Sequence[str]) -> None:
    if isinstance(values, str) or not all(isinstance(value, str) and value for value in values):
        raise ValueError(f"{name} is {values!r}, allowed is a list of names")
    repeated = sorted({value for value in values if list(values).count(value) > 1})
    if repeated:
        raise ValueError(f"{name} contains {', '.join(repeated)} more than once")


def _check_pose(name: str, T: np.ndarray) -> None:
    rigid = (
        T.shape == (4, 4)
        and bool(np.all(np.isfinite(T)))
        and np.allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-6)
        and np.linalg.det(T[:3, :3]) > 0.0
        and np.allclose(T[3], [0.0, 0.0, 0.0, 1.0])
    )
    if not rigid:
        raise ValueError(f"{name} is not a pose: allowed is a rigid 4x4 transform, translation in metres")
