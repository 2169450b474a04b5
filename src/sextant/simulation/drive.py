# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A simulated drive in a room with markers: images, wheel odometry and ground truth by frame."""

from dataclasses import dataclass, replace
from typing import Iterator, List, Optional

import numpy as np

import sextant
from sextant.base.strict_params import Check, StrictParams, nested, param, struct_param, within
from sextant.simulation.camera import HORIZONTAL_FOV, camera_calibration, camera_mount
from sextant.simulation.motion import FigureEight, Motion, free_floor
from sextant.simulation.odometry import OdometryNoise, OdometryReading, WheelOdometry
from sextant.simulation.room_markers import default_map, room_for

_CAMERA = sextant.RoomRendererParams()
_SCENE = sextant.RoomSceneParams()
ROOM_SIZES = "must be empty or three numbers within (0, 1000]"


def _three_numbers(value: List[float]) -> str:
    """Check for param(): three finite numbers."""
    return "" if len(value) == 3 and np.all(np.isfinite(value)) else "must be three finite numbers"


def _room_size(value: List[float]) -> str:
    """Check for param(): empty, or three sizes."""
    return "" if not value or len(value) == 3 and all(0.0 < each <= 1000.0 for each in value) else ROOM_SIZES


@dataclass(frozen=True)
class DriveParams(StrictParams):
    """Parameters of room, camera and robot; the core defines the defaults of the rendering."""

    seed: int = param(
        1,
        "random seed of the walls' texture, the image noise and the odometry noise; the same seed "
        "gives the same images",
        within(0, 2**31 - 1),
    )
    rate: float = param(30.0, "frames per simulated second", within(0.1, 1000.0), "Hz")
    # room
    room_size: List[float] = param(
        [],
        "size of the room along x, y and z, larger if markers lie outside; empty: the default room",
        Check("empty or 3, each (0, 1000]", _room_size),
        "m",
    )
    obstacles: bool = param(True, "add posts, a crate and a cupboard to the default room")
    quiet_zone: float = struct_param(sextant.RoomSceneParams, "quiet_zone")
    light_unevenness: float = struct_param(sextant.RoomSceneParams, "light_unevenness")
    # camera
    width: int = param(640, "image width", within(16, 8192), "px")
    height: int = param(480, "image height", within(16, 8192), "px")
    horizontal_fov: float = param(
        HORIZONTAL_FOV,
        "horizontal field of view without distortion (62°)",
        Check("(0, π), equidistant (0, 2π)"),
        "rad",
    )
    distortion_model: str = param(
        "plumb_bob", "model of the lens distortion", Check("plumb_bob, rational_polynomial, equidistant")
    )
    distortion: List[float] = param(
        [], "coefficients in OpenCV's order; empty: an ideal lens", Check("as many as the model has")
    )
    camera_xyz: List[float] = param(
        [0.1, 0.0, 1.0], "position of the camera on the base", Check("3, each finite", _three_numbers), "m"
    )
    camera_rpy: List[float] = param(
        [0.0, 0.0, 0.0],
        "roll, pitch, yaw of the camera; 0: it faces forward",
        Check("3, each finite", _three_numbers),
        "rad",
    )
    exposure_time: float = param(
        0.0, "exposure time, for motion blur; the stamp is at its middle", within(0.0, 1.0), "s"
    )
    supersampling: int = struct_param(sextant.RoomRendererParams, "supersampling")
    blur_sigma: float = struct_param(sextant.RoomRendererParams, "blur_sigma")
    noise_sigma: float = struct_param(sextant.RoomRendererParams, "noise_sigma")
    vignette: float = struct_param(sextant.RoomRendererParams, "vignette")
    white_level: float = struct_param(sextant.RoomRendererParams, "white_level")
    # robot
    eight: FigureEight = nested(FigureEight, "eight_", ("half_length", "half_width", "period"))
    robot_radius: float = param(
        0.2, "radius of the robot, for collisions with walls and obstacles", within(0.0, 10.0), "m"
    )
    odometry: OdometryNoise = nested(OdometryNoise, "odometry_")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.scene_params(sextant.MarkerMap()).validate()
        self.renderer_params().validate()
        self.calibration()

    def calibration(self) -> "sextant.CameraCalibration":
        """Calibration of the simulated camera."""
        return camera_calibration(
            self.width, self.height, self.horizontal_fov, self.distortion_model, self.distortion
        )

    def scene_params(self, marker_map: "sextant.MarkerMap") -> "sextant.RoomSceneParams":
        """Parameters of a room that contains the markers of the map."""
        room = room_for(marker_map, self.seed, self.obstacles, self.room_size)
        room.quiet_zone, room.light_unevenness = self.quiet_zone, self.light_unevenness
        return room

    def renderer_params(self) -> "sextant.RoomRendererParams":
        """Parameters of the camera's optics and sensor."""
        params = sextant.RoomRendererParams()
        for name in ("seed", "supersampling", "blur_sigma", "noise_sigma", "vignette", "white_level"):
            setattr(params, name, getattr(self, name))
        return params


@dataclass(frozen=True)
class Frame:
    """One frame of a drive."""

    index: int  # number, from 0
    time: float  # seconds since the start
    image: np.ndarray  # (height, width) uint8, raw
    truth: Motion  # in map
    odometry: OdometryReading  # at the time of the image

    @property
    def T_map_base(self) -> np.ndarray:
        """The true pose (4, 4), metres."""
        return self.truth.pose

    @property
    def T_odom_base(self) -> np.ndarray:
        """The pose (4, 4) from wheel odometry, metres."""
        return self.odometry.motion.pose


class SimulatedDrive:
    """A robot with one camera in a room with markers; deterministic for given parameters and motions."""

    EXPOSURE_STEPS = 5  # number of images averaged to simulate motion blur

    def __init__(
        self,
        params: DriveParams,
        marker_map: Optional["sextant.MarkerMap"] = None,
        calibration: Optional["sextant.CameraCalibration"] = None,
        first: int = 0,
    ):
        """:param marker_map: None: default_map()
        :param calibration: of a real camera; None: that of the parameters
        :param first: index of the first frame; frames with different indices have different image noise
        :raises ValueError: an invalid calibration or room
        """
        self.params = params
        self.map = default_map() if marker_map is None else marker_map
        self.calibration = calibration or params.calibration()
        self.T_base_camera = camera_mount(params.camera_xyz, params.camera_rpy)
        self.room = params.scene_params(self.map)
        self.path = replace(params.eight, center=tuple(self.room.floor_center))
        self.is_free = free_floor(self.room, params.robot_radius)
        self._scene = sextant.RoomScene(self.room, self.map)
        self._renderer = sextant.RoomRenderer(
            params.renderer_params(), self._scene, sextant.CameraModel(self.calibration)
        )
        self._odometry = WheelOdometry(params.odometry, params.seed)
        self._next = first

    def frames(self, count: int) -> Iterator[Frame]:
        """Renders the next frames along the figure of eight.

        :raises ValueError: the path leads through a wall or an obstacle
        """
        self.check_path()
        for _ in range(count):
            yield self.frame(self.path.at(self._next / self.params.rate))

    def check_path(self) -> None:
        """Checks the figure of eight.

        :raises ValueError: the path leads through a wall or an obstacle
        """
        for t in np.linspace(0.0, self.path.period, 400):
            motion = self.path.at(t)
            if not self.is_free(motion.x, motion.y):
                raise ValueError(
                    "eight_half_length, eight_half_width: the path leads through a wall or an obstacle "
                    f"near x = {motion.x:.2f}, y = {motion.y:.2f}"
                )

    def is_camera_inside(self, motion: Motion) -> bool:
        """Returns whether the camera of a robot with this motion is in the room."""
        return self._scene.contains((motion.pose @ self.T_base_camera)[:3, 3])

    def frame(self, motion: Motion) -> Frame:
        """Renders the next frame of a robot with this motion."""
        index, self._next = self._next, self._next + 1
        odometry = self._odometry.update(motion, 1.0 / self.params.rate)
        image = self._renderer.render(self._exposure(motion), index)
        return Frame(index, index / self.params.rate, image, motion, odometry)

    def _exposure(self, motion: Motion) -> List[np.ndarray]:
        """T_map_camera (4, 4) at equidistant times during the exposure."""
        steps = self.EXPOSURE_STEPS if self.params.exposure_time > 0 else 1
        moments = self.params.exposure_time * ((np.arange(steps) + 0.5) / steps - 0.5)
        return [motion.after(moment).pose @ self.T_base_camera for moment in moments]
