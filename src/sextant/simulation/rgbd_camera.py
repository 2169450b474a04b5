# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulation of a colour and a depth camera in one housing, such as a RealSense D435."""

from dataclasses import dataclass
from typing import List, NamedTuple

import numpy as np

import sextant
from sextant.base.strict_params import StrictParams, param, within
from sextant.simulation.camera import camera_calibration, camera_mount


@dataclass(frozen=True)
class RgbdParams(StrictParams):
    """Calibration, mount and noise; both images have the same size. Defaults: a D435 on a Kobuki."""

    width: int = param(640, within(16, 4096))  # image width, pixels
    height: int = param(480, within(16, 4096))  # image height, pixels
    colour_fov: float = param(0.96, within(0.1, 3))  # horizontal field of view, radians
    depth_fov: float = param(1.387, within(0.1, 3))  # horizontal field of view, radians
    x: float = param(0.10, within(-10, 10))  # of the colour camera in the robot frame, metres
    y: float = param(0.0, within(-10, 10))  # of the colour camera in the robot frame, metres
    z: float = param(0.30, within(-10, 10))  # of the colour camera in the robot frame, metres
    pitch: float = param(0.25, within(-1.5, 1.5))  # of both cameras, downward, radians
    baseline: float = param(0.015, within(-1, 1))  # colour camera left of depth camera, metres
    depth_yaw: float = param(0.005, within(-0.5, 0.5))  # relative to the colour camera, radians
    noise_sigma: float = param(4.0, within(0, 100))  # standard deviation in the colour image, levels
    depth_noise: float = param(0.004, within(0, 1))  # sigma at 1 m, metres; grows with depth squared
    depth_scale: float = param(1.0 / 1.04, within(0.5, 2))  # ratio of measured to true depth
    holes: float = param(0.01, within(0, 1))  # fraction of the pixels that have no depth


class RgbdImages(NamedTuple):
    """Both images taken at one time, and the objects visible in the colour image."""

    colour: np.ndarray  # uint8 (height, width, 3), RGB
    depth: np.ndarray  # float32 (height, width), metres along the optical axis, 0: none
    seen: List["sextant.VisibleObject"]


class RgbdCamera:
    """Renders images of an arena. Not thread-safe."""

    def __init__(self, params: RgbdParams, seed: int = 0):
        """:param seed: of all noise, [0, 2^31 - 1]"""
        self.colour = camera_calibration(params.width, params.height, params.colour_fov)
        self.depth = camera_calibration(params.width, params.height, params.depth_fov)
        self.T_base_colour = camera_mount([params.x, params.y, params.z], [0.0, params.pitch, 0.0])
        depth_at = [params.x, params.y - params.baseline, params.z]
        self.T_base_depth = camera_mount(depth_at, [0.0, params.pitch, params.depth_yaw])
        colour, depth = sextant.ArenaCameraParams(), sextant.DepthCameraParams()
        colour.noise_sigma, colour.seed, depth.seed = params.noise_sigma, seed, seed
        depth.noise, depth.scale, depth.holes = params.depth_noise, params.depth_scale, params.holes
        self._colour = sextant.ArenaCamera(colour, sextant.CameraModel(self.colour))
        self._depth = sextant.DepthCamera(depth, sextant.CameraModel(self.depth))

    def take(self, scene: "sextant.ArenaScene", T_map_base: np.ndarray, frame: int) -> RgbdImages:
        """Renders both images.

        :param frame: number that selects the noise
        :raises ValueError: the camera is outside the arena
        """
        colour, seen = self._colour.take(scene, T_map_base @ self.T_base_colour, frame)
        return RgbdImages(colour, self._depth.take(scene, T_map_base @ self.T_base_depth, frame), seen)
