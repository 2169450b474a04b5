# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A simulated drive: what the camera sees, what the wheels say, and the truth, frame by frame."""

from dataclasses import dataclass
from typing import Iterator, List, Optional

import numpy as np

import sextant
from sextant.base.strict_params import StrictParams, param, within
from sextant.simulation.camera import HORIZONTAL_FOV, camera_calibration, camera_mount
from sextant.simulation.motion import FigureEight, Motion, free_floor
from sextant.simulation.odometry import OdometryNoise, OdometryReading, WheelOdometry
from sextant.simulation.room import default_map, room_for

_CAMERA = sextant.RoomRendererParams()
_SCENE = sextant.RoomSceneParams()
_WHEELS = OdometryNoise()
_PATH = FigureEight()


def _three_numbers(value: List[float]) -> str:
    return "" if len(value) == 3 and np.all(np.isfinite(value)) else "must be three finite numbers"


@dataclass(frozen=True)
class DriveParams(StrictParams):
    """What is simulated. The core has the defaults of what it renders with."""

    seed: int = param(1, within(0, 2**31 - 1))  # of walls, image noise and wheel noise
    rate: float = param(30.0, within(0.1, 1000.0))  # frames a second
    # room
    obstacles: bool = True  # see room_for()
    quiet_zone: float = _SCENE.quiet_zone  # white margin of the prints, modules
    light_unevenness: float = _SCENE.light_unevenness  # 0: even light
    # camera
    width: int = param(640, within(16, 8192))  # pixels
    height: int = param(480, within(16, 8192))
    horizontal_fov: float = HORIZONTAL_FOV  # radians, of the lens without its distortion
    distortion_model: str = "plumb_bob"  # plumb_bob, rational_polynomial or equidistant
    distortion: List[float] = param([])  # OpenCV's order; empty: an ideal lens
    camera_xyz: List[float] = param([0.1, 0.0, 1.0], _three_numbers)  # mount on base_link, metres
    camera_rpy: List[float] = param([0.0, 0.0, 0.0], _three_numbers)  # radians; 0: looks ahead
    exposure_time: float = param(0.0, within(0.0, 1.0))  # seconds of blur; the stamp is their middle
    supersampling: int = _CAMERA.supersampling
    blur_sigma: float = _CAMERA.blur_sigma  # pixels
    noise_sigma: float = _CAMERA.noise_sigma  # grey levels
    vignette: float = _CAMERA.vignette  # share of light lost in the corners
    white_level: float = _CAMERA.white_level  # grey level of white paper
    # robot
    eight_half_length: float = param(_PATH.half_length, within(0.1, 500.0))  # metres
    eight_half_width: float = param(_PATH.half_width, within(0.05, 500.0))  # metres
    eight_period: float = param(_PATH.period, within(1.0, 1e5))  # seconds
    robot_radius: float = param(0.2, within(0.0, 10.0))  # metres, keeps off walls and obstacles
    odometry_distance_per_metre: float = param(_WHEELS.distance_per_metre, within(0.0, 1.0))  # m / sqrt(m)
    odometry_angle_per_metre: float = param(_WHEELS.angle_per_metre, within(0.0, 1.0))  # rad / sqrt(m)
    odometry_angle_per_radian: float = param(_WHEELS.angle_per_radian, within(0.0, 1.0))  # rad / sqrt(rad)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.scene_params(sextant.MarkerMap()).validate()
        self.renderer_params().validate()
        self.calibration()

    def calibration(self) -> "sextant.CameraCalibration":
        """Of the simulated camera."""
        return camera_calibration(
            self.width, self.height, self.horizontal_fov, self.distortion_model, self.distortion
        )

    def scene_params(self, marker_map: "sextant.MarkerMap") -> "sextant.RoomSceneParams":
        """Of a room that holds the map."""
        room = room_for(marker_map, self.seed, self.obstacles)
        room.quiet_zone, room.light_unevenness = self.quiet_zone, self.light_unevenness
        return room

    def renderer_params(self) -> "sextant.RoomRendererParams":
        """Of the camera's optics and sensor."""
        params = sextant.RoomRendererParams()
        for name in ("seed", "supersampling", "blur_sigma", "noise_sigma", "vignette", "white_level"):
            setattr(params, name, getattr(self, name))
        return params

    def odometry_noise(self) -> OdometryNoise:
        """Of the wheels."""
        return OdometryNoise(
            self.odometry_distance_per_metre, self.odometry_angle_per_metre, self.odometry_angle_per_radian
        )


@dataclass(frozen=True)
class Frame:
    """One instant of a drive."""

    index: int
    time: float  # seconds since the start
    image: np.ndarray  # (height, width) uint8, raw
    truth: Motion  # in map
    odometry: OdometryReading

    @property
    def T_map_base(self) -> np.ndarray:
        """The true pose (4, 4), metres."""
        return self.truth.pose

    @property
    def T_odom_base(self) -> np.ndarray:
        """The pose (4, 4) that the wheels say, metres."""
        return self.odometry.motion.pose


class SimulatedDrive:
    """A robot with one camera in a room with markers. Same parameters, same motions: same frames."""

    EXPOSURE_STEPS = 5  # pictures that a moving exposure is averaged from

    def __init__(self, params: DriveParams, marker_map: Optional["sextant.MarkerMap"] = None):
        """:param marker_map: default_map() if none
        :raises ValueError: an eight that does not fit into the room
        """
        self.params = params
        self.map = default_map() if marker_map is None else marker_map
        self.calibration = params.calibration()
        self.T_base_camera = camera_mount(params.camera_xyz, params.camera_rpy)
        self.room = params.scene_params(self.map)
        self.path = FigureEight(
            params.eight_half_length,
            params.eight_half_width,
            params.eight_period,
            tuple(self.room.floor_center),
        )
        self.is_free = free_floor(self.room, params.robot_radius)
        scene = sextant.RoomScene(self.room, self.map)
        self._renderer = sextant.RoomRenderer(
            params.renderer_params(), scene, sextant.CameraModel(self.calibration)
        )
        self._odometry = WheelOdometry(params.odometry_noise(), params.seed)
        self._next = 0

    def frames(self, count: int) -> Iterator[Frame]:
        """The next frames along the figure of eight.

        :raises ValueError: the eight leads through a wall or an obstacle
        """
        self.check_path()
        for _ in range(count):
            yield self.frame(self.path.at(self._next / self.params.rate))

    def check_path(self) -> None:
        """:raises ValueError: the eight leads through a wall or an obstacle"""
        for t in np.linspace(0.0, self.path.period, 400):
            motion = self.path.at(t)
            if not self.is_free(motion.x, motion.y):
                raise ValueError(
                    "eight_half_length, eight_half_width: the path leads through a wall or an obstacle "
                    f"near x = {motion.x:.2f}, y = {motion.y:.2f}"
                )

    def frame(self, motion: Motion) -> Frame:
        """The next frame, with the robot at this motion."""
        index, self._next = self._next, self._next + 1
        odometry = self._odometry.update(motion, 1.0 / self.params.rate)
        image = self._renderer.render(self._exposure(motion), index)
        return Frame(index, index / self.params.rate, image, motion, odometry)

    def _exposure(self, motion: Motion) -> List[np.ndarray]:
        """T_map_camera (4, 4) during the exposure."""
        steps = self.EXPOSURE_STEPS if self.params.exposure_time > 0 else 1
        moments = self.params.exposure_time * ((np.arange(steps) + 0.5) / steps - 0.5)
        return [motion.after(moment).pose @ self.T_base_camera for moment in moments]
