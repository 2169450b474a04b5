# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A colour and a depth camera in one housing, as Intel's RealSense D435, on a robot in an arena."""

from dataclasses import dataclass
from typing import List, NamedTuple

import numpy as np

import sextant
from sextant.base.ranges import check_ranges
from sextant.simulation.camera import camera_calibration, camera_mount


@dataclass(frozen=True)
class RgbdParams:
    """Both pictures are of one size. The figures are a D435's on a Kobuki."""

    width: int = 640  # [16, 4096] pixels
    height: int = 480  # [16, 4096]
    colour_fov: float = 0.96  # (0.1, 3) radians that the width spans
    depth_fov: float = 1.387  # (0.1, 3)
    x: float = 0.10  # [-10, 10] metres, of the colour camera in the robot frame
    y: float = 0.0
    z: float = 0.30
    pitch: float = 0.25  # [-1.5, 1.5] radians, downward
    apart: float = 0.015  # [-1, 1] metres from the depth camera to the colour camera, to the left
    depth_turn: float = 0.005  # [-0.5, 0.5] radians by which the depth camera looks farther to the left
    noise_sigma: float = 4.0  # [0, 100] levels of colour
    depth_noise: float = 0.004  # [0, 1] metres at 1 m, growing with the square of the depth
    depth_scale: float = 1.0 / 1.04  # [0.5, 2] what it says of a metre
    holes: float = 0.01  # [0, 1] share of depths that are not there

    def validate(self) -> None:
        """:raises ValueError: names the first field out of range"""
        check_ranges(self, width=(16, 4096), height=(16, 4096), colour_fov=(0.1, 3), depth_fov=(0.1, 3))
        check_ranges(self, x=(-10, 10), y=(-10, 10), z=(-10, 10), pitch=(-1.5, 1.5), apart=(-1, 1))
        check_ranges(self, depth_turn=(-0.5, 0.5), noise_sigma=(0, 100), depth_noise=(0, 1))
        check_ranges(self, depth_scale=(0.5, 2), holes=(0, 1))


class RgbdPicture(NamedTuple):
    """Both pictures of a moment, and what is in the first."""

    colour: np.ndarray  # uint8 (height, width, 3), red first
    depth: np.ndarray  # float32 (height, width), metres along the optical axis, 0: none
    seen: List["sextant.SeenObject"]


class RgbdCamera:
    """Takes pictures in an arena. Not thread-safe."""

    def __init__(self, params: RgbdParams, seed: int = 0):
        """:param seed: [0, 2^31 - 1] of all noise. :raises ValueError: as RgbdParams.validate()"""
        params.validate()
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
