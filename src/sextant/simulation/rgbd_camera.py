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

    width: int = param(640, "width of both images", within(16, 4096), "px")
    height: int = param(480, "height of both images", within(16, 4096), "px")
    colour_fov: float = param(0.96, "horizontal field of view of the colour camera", within(0.1, 3), "rad")
    depth_fov: float = param(1.387, "horizontal field of view of the depth camera", within(0.1, 3), "rad")
    x: float = param(0.10, "position of the colour camera in the robot frame, forward", within(-10, 10), "m")
    y: float = param(0.0, "position of the colour camera in the robot frame, left", within(-10, 10), "m")
    z: float = param(0.30, "position of the colour camera in the robot frame, up", within(-10, 10), "m")
    pitch: float = param(0.25, "downward pitch of both cameras", within(-1.5, 1.5), "rad")
    baseline: float = param(
        0.015, "distance of the colour camera to the left of the depth camera", within(-1, 1), "m"
    )
    depth_yaw: float = param(
        0.005, "yaw of the depth camera relative to the colour camera", within(-0.5, 0.5), "rad"
    )
    noise_sigma: float = param(
        4.0, "standard deviation of the noise of the colour image", within(0, 100), "grey levels"
    )
    depth_noise: float = param(
        0.004, "standard deviation of a depth at 1 m; grows with the square of the depth", within(0, 1), "m"
    )
    depth_scale: float = param(1.0 / 1.04, "ratio of measured to true depth", within(0.5, 2))
    holes: float = param(0.01, "fraction of pixels without depth", within(0, 1))
    bleeding: int = param(0, "reach of the mixed depths at edges", within(0, 20), "px")


class RgbdImages(NamedTuple):
    """Both images taken at one time, and the objects visible in the colour image."""

    colour: np.ndarray  # uint8 (height, width, 3), RGB
    depth: np.ndarray  # float32 (height, width), metres along the optical axis, 0: none
    seen: List["sextant.VisibleObject"]  # with their boxes


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
        depth.bleeding = params.bleeding
        self._colour = sextant.ArenaCamera(colour, sextant.CameraModel(self.colour))
        self._depth = sextant.DepthCamera(depth, sextant.CameraModel(self.depth))

    def take(self, scene: "sextant.ArenaScene", T_map_base: np.ndarray, frame: int) -> RgbdImages:
        """Renders both images.

        :param frame: number that selects the noise
        :raises ValueError: the camera is outside the arena
        """
        colour, seen = self._colour.take(scene, T_map_base @ self.T_base_colour, frame)
        return RgbdImages(colour, self._depth.take(scene, T_map_base @ self.T_base_depth, frame), seen)
