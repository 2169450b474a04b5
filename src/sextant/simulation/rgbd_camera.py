# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A colour and a depth camera in one housing, as Intel's RealSense D435, on a robot in an arena."""

from dataclasses import dataclass
from typing import List, NamedTuple

import numpy as np

import sextant
from sextant.base.strict_params import StrictParams, param, within
from sextant.simulation.camera import camera_calibration, camera_mount


@dataclass(frozen=True)
class RgbdParams(StrictParams):
    """Both pictures are of one size. The figures are a D435's on a Kobuki."""

    width: int = param(640, within(16, 4096))  # pixels
    height: int = param(480, within(16, 4096))
    colour_fov: float = param(0.96, within(0.1, 3))  # radians that the width spans
    depth_fov: float = param(1.387, within(0.1, 3))
    x: float = param(0.10, within(-10, 10))  # metres, of the colour camera in the robot frame
    y: float = param(0.0, within(-10, 10))
    z: float = param(0.30, within(-10, 10))
    pitch: float = param(0.25, within(-1.5, 1.5))  # radians, downward
    apart: float = param(0.015, within(-1, 1))  # metres from the depth to the colour camera, to the left
    depth_turn: float = param(0.005, within(-0.5, 0.5))  # radians that the depth camera is turned to the left
    noise_sigma: float = param(4.0, within(0, 100))  # levels of colour
    depth_noise: float = param(0.004, within(0, 1))  # metres at 1 m, growing with the square of the depth
    depth_scale: float = param(1.0 / 1.04, within(0.5, 2))  # what it says of a metre
    holes: float = param(0.01, within(0, 1))  # share of depths that are not there


class RgbdPicture(NamedTuple):
    """Both pictures of a moment, and what is in the first."""

    colour: np.ndarray  # uint8 (height, width, 3), red first
    depth: np.ndarray  # float32 (height, width), metres along the optical axis, 0: none
    seen: List["sextant.SeenObject"]


class RgbdCamera:
    """Takes pictures in an arena. Not thread-safe."""

    def __init__(self, params: RgbdParams, seed: int = 0):
        """:param seed: [0, 2^31 - 1] of all noise."""
        self.colour = camera_calibration(params.width, params.height, params.colour_fov)
        self.depth = camera_calibration(params.width, params.height, params.depth_fov)
        self.T_base_colour = camera_mount([params.x, params.y, params.z], [0.0, params.pitch, 0.0])
        depth_at = [params.x, params.y - params.apart, params.z]
        self.T_base_depth = camera_mount(depth_at, [0.0, params.pitch, params.depth_turn])
        colour, depth = sextant.ArenaCameraParams(), sextant.DepthCameraParams()
        colour.noise_sigma, colour.seed, depth.seed = params.noise_sigma, seed, seed
        depth.noise, depth.scale, depth.holes = params.depth_noise, params.depth_scale, params.holes
        self._colour = sextant.ArenaCamera(colour, sextant.CameraModel(self.colour))
        self._depth = sextant.DepthCamera(depth, sextant.CameraModel(self.depth))

    def take(self, scene: "sextant.ArenaScene", T_map_base: np.ndarray, frame: int) -> RgbdPicture:
        """:param frame: chooses the noise. :raises ValueError: the camera is outside of the arena"""
        colour, seen = self._colour.take(scene, T_map_base @ self.T_base_colour, frame)
        return RgbdPicture(colour, self._depth.take(scene, T_map_base @ self.T_base_depth, frame), seen)
