# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The ball task's pipeline from images and odometry to commands, without ROS.

detector -> ObjectLocator -> LandmarkTimeline (pillars) and BallTracker (the ball) -> BallTask
"""

from collections import deque
from dataclasses import dataclass, field
from typing import Deque, List, NamedTuple, Optional, Tuple

import numpy as np

import sextant
from sextant.ball.ball_task import BallTask
from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.depth_points import DepthPoints
from sextant.ball.floor_grid import FloorGrid, FloorGridParams
from sextant.ball.task_view import Action, SeenBall, SeenPillar, TaskView
from sextant.geometry.plane_poses import composed, rotation
from sextant.objects.ball_observations import BallObservations
from sextant.objects.ball_tracker import BallTracker, BallTrackerParams
from sextant.objects.ball_visibility import BallVisibility
from sextant.objects.detections import Detector
from sextant.objects.object_kinds import BALL, KINDS
from sextant.objects.object_locator import LocatedObject, ObjectLocator, ObjectLocatorParams

MAX_READINGS = 100  # odometry messages


class RgbdMount(NamedTuple):
    """Calibration and mount of a colour and a depth camera."""

    colour: "sextant.CameraModel"  # lens of the colour camera
    depth: "sextant.CameraModel"  # lens of the depth camera
    T_base_colour: np.ndarray  # (4, 4)
    T_base_depth: np.ndarray  # (4, 4)


def _slam() -> "sextant.LandmarkSlamParams":
    params = sextant.LandmarkSlamParams()
    params.sensor.max_range, params.sensor.min_range, params.sensor.field_of_view = 2.5, 1.0, 0.75
    params.sensor.min_separation, params.sensor.landmark_width = 0.15, 0.1
    params.candidates.observations = 2  # of a pillar beside the robot there are few as it turns
    return params


@dataclass
class BallPlayerParams:
    """Parameters of all components."""

    locator: ObjectLocatorParams = field(default_factory=ObjectLocatorParams)  # of the pillars and the ball
    tracker: BallTrackerParams = field(default_factory=BallTrackerParams)  # of the ball
    slam: "sextant.LandmarkSlamParams" = field(default_factory=_slam)  # with the pillars as landmarks
    timeline: "sextant.LandmarkTimelineParams" = field(
        default_factory=sextant.LandmarkTimelineParams  # of the observations
    )
    grid: FloorGridParams = field(default_factory=FloorGridParams)  # of the known floor
    task: BallTaskParams = field(default_factory=BallTaskParams)  # of the states


class BallPlayer:
    """Processes odometry and images with their stamps, and computes actions."""

    def __init__(self, params: BallPlayerParams, mount: RgbdMount, detector: Detector):
        """:raises ValueError: a parameter out of range"""
        self._params, self._mount, self._detector = params, mount, detector
        T_colour_depth = np.linalg.inv(mount.T_base_colour) @ mount.T_base_depth
        self._locator = ObjectLocator(params.locator, mount.colour, mount.depth, T_colour_depth)
        self._points = DepthPoints(mount.depth, mount.T_base_depth, params.locator.depth_scale)
        self.tracker, self.task = BallTracker(params.tracker), BallTask(params.task)
        start = sextant.LandmarkSlam(params.slam, np.zeros(3), 1e-6 * np.eye(3))
        self.timeline = sextant.LandmarkTimeline(params.timeline, start)
        self.grid = FloorGrid(params.grid)
        self._readings: Deque[Tuple[float, np.ndarray]] = deque(maxlen=MAX_READINGS)
        self.found: List[Tuple[np.ndarray, str]] = []  # boxes in the last image and their classes
        near, far = params.locator.min_depth + 0.2, params.slam.sensor.max_range
        self._ball_visibility = BallVisibility(mount.colour, KINDS[BALL].radius, near, far)

    def odometry(self, stamp: float, T_odom_base: np.ndarray) -> None:
        """Add an odometry pose. :param T_odom_base: (3,) x, y, heading"""
        if self.timeline.odometry(stamp, T_odom_base):
            self._readings.append((stamp, np.asarray(T_odom_base)))

    def add_images(self, stamp: float, colour: np.ndarray, depth: np.ndarray) -> None:
        """Process the images of a time with odometry.

        :param colour: uint8 (height, width, 3), RGB. :param depth: float32 (height, width), metres, 0: none
        :raises ValueError: no odometry at the stamp, or an invalid image
        """
        T_odom_base = dict(self._readings).get(stamp)
        if T_odom_base is None:
            raise ValueError(f"no odometry at {stamp} s, the stamp of the images")
        found = self._detector.detect(colour)
        names = [self._detector.classes[each] for each in found.classes]
        self.found, kinds = list(zip(found.boxes, names)), [KINDS[name] for name in names]
        places = self._locator.locate(depth, found.boxes, kinds, self._mount.T_base_colour)
        seen = [(name, place) for name, place in zip(names, places) if place is not None]
        self._add_pillars(stamp, [each for each in seen if each[0] != BALL])
        located = [(KINDS[name], place) for name, place in seen]
        BallObservations.of(located, self._mount.T_base_colour, self._ball_visibility).update(
            self.tracker, stamp, T_odom_base
        )
        self.grid.update(self._points.of(depth), composed(self._T_map_odom(), T_odom_base))

    def step(self, stamp: float, is_bumped: bool) -> Action:
        """Compute the action at a time. :param is_bumped: since the last step"""
        T_map_odom, (_, T_odom_base) = self._T_map_odom(), self._readings[-1]
        slam = self.timeline.slam
        pillars = [
            SeenPillar(label.class_name, landmark.position)
            for label, landmark in zip(slam.labels, slam.filter.landmarks)
        ]
        pose, ball = composed(T_map_odom, T_odom_base), self._ball(stamp, T_map_odom)
        return self.task.step(TaskView(stamp, pose, pillars, ball, is_bumped, self.grid))

    def _add_pillars(self, stamp: float, seen: List[Tuple[str, LocatedObject]]) -> None:
        observations = [
            sextant.LabelledObservation(
                sextant.LandmarkLabel(name), sextant.Observation2D(place.position, place.covariance)
            )
            for name, place in seen
        ]
        self.timeline.observe(stamp, observations)

    def _ball(self, stamp: float, T_map_odom: np.ndarray) -> Optional[SeenBall]:
        ball = self.tracker.at(stamp)
        if ball is None:
            return None
        R = rotation(T_map_odom[2])
        return SeenBall(R @ ball.position + T_map_odom[:2], R @ ball.velocity, ball.seen)

    def _T_map_odom(self) -> np.ndarray:
        return self.timeline.now.T_map_odom
