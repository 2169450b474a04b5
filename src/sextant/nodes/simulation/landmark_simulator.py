# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node landmark_simulator: a simulated robot with odometry and a sensor of landmarks."""

from dataclasses import dataclass
from typing import List

import numpy as np
import rospy
from geometry_msgs.msg import Point, Twist
from std_msgs.msg import ColorRGBA, Header
from std_srvs.srv import Trigger, TriggerResponse
from visualization_msgs.msg import Marker, MarkerArray

from sextant.base.strict_params import Check, not_empty, param, within
from sextant.geometry.plane_poses import in_frame, relative
from sextant.msg import LandmarkObservation, LandmarkObservations
from sextant.nodes.base.exits import fatal
from sextant.nodes.base.params import read_params
from sextant.nodes.base.subscriber_wait import wait_for_subscriber
from sextant.nodes.simulation.simulated_clock import simulated_time
from sextant.nodes.simulation.simulated_robot import SimulatedRobot, SimulatedRobotParams
from sextant.simulation.landmark_world import (
    LandmarkDrive,
    LandmarkScan,
    LandmarkWorld,
    LandmarkWorldParams,
    SimulatedObservation,
    SimulationStep,
)
from sextant.simulation.motion import Motion
from sextant.simulation.odometry import SteppedOdometry

START = 10_000_000_000  # first stamp, nanoseconds; those of observations are positive with any clock_offset
IDLE_STEP = 10_000_000_000  # nanoseconds by which the clock advances at once after the drive
QUEUE = 100  # messages that a subscriber may be late before it loses one
RADIUS = 0.08  # metres, of an outline: larger than a mapped landmark in rviz
GREY = ColorRGBA(0.7, 0.7, 0.7, 1.0)


def range_noise_error(values: List[float]) -> str:
    """Why range_noise is invalid; empty if it is valid."""
    is_fine = len(values) == 2 and all(0.0 <= value <= 10.0 for value in values)
    return "" if is_fine else "must be two numbers within [0, 10]"


@dataclass(frozen=True)
class LandmarkSimulatorParams(LandmarkWorldParams, SimulatedRobotParams):
    """Parameters of the node landmark_simulator."""

    duration: float = param(
        1e6,
        "simulated duration of the drive; afterwards only the clock is published",
        Check("(0, 1e6]", within(1e-9, 1e6)),
        "s",
    )
    range_noise: List[float] = param(
        [0.02, 0.005],
        "standard deviation of the range: constant part, and factor of the squared range",
        Check("2, each [0, 10]", range_noise_error),
        "m, 1/m",
    )
    map_frame: str = param("map", "frame of the ground truth", not_empty)


class LandmarkSimulator(SimulatedRobot):
    """Publishes a simulated drive step by step: the clock first, then the messages of that stamp.

    :raises ValueError: as LandmarkWorld
    """

    def __init__(self, params: LandmarkSimulatorParams):
        self._world = LandmarkWorld(params)
        super().__init__(params, START, QUEUE)
        self._drive, self._wheels = LandmarkDrive(self._world), SteppedOdometry()
        self._observations = rospy.Publisher("landmarks", LandmarkObservations, queue_size=QUEUE)
        self._outlines = rospy.Publisher("ground_truth/landmarks", MarkerArray, queue_size=1, latch=True)
        self._outlines.publish(outlines(in_frame(self._world.start, self._world.positions), params.map_frame))
        rospy.Subscriber("cmd_vel", Twist, self._on_command, queue_size=1)
        rospy.Service("~kidnap", Trigger, self._kidnap)

    def run(self) -> None:
        """Simulates the drive, then publishes only the clock until shutdown."""
        timeout = self._params.wait_for_subscriber
        wait_for_subscriber(self._observations, timeout, self._stop, self._clock.publish)
        for _ in range(round(self._params.duration * self._params.odometry_rate)):
            with self._lock:
                command = self._commanded() if self._command else None  # random motion until the first one
                step = self._drive.advance(command)
            stamp = START + round(1e9 * step.stamp)
            self._clock.advance(stamp)
            if self._stop.is_set():
                return
            self._publish(step, rospy.Time(nsecs=stamp))
        while not self._stop.is_set():
            self._clock.advance(self._clock.now + IDLE_STEP)

    def _publish(self, step: SimulationStep, stamp: rospy.Time) -> None:
        """Odometry before observations, so that a subscriber knows the pose of the robot at their stamp."""
        params, seconds = self._params, 1.0 / self._params.odometry_rate
        reading = self._wheels.add(step.odometry_step, step.noise, seconds)
        x, y, yaw = relative(self._world.start, step.pose)
        truth = Motion(x, y, 0.0, yaw, step.speed, step.turn_rate)
        self._publish_motion(stamp, reading, truth, params.map_frame)
        if step.scan is not None:
            self._observations.publish(scan_to_message(step.scan, params.base_frame))

    def _kidnap(self, _request) -> TriggerResponse:
        with self._lock:
            distance = self._drive.kidnap()
        return TriggerResponse(True, f"carried {distance:.1f} m away, without odometry")


def scan_to_message(scan: LandmarkScan, frame: str) -> LandmarkObservations:
    """Converts a scan; the stamp is by the clock of the sensor."""
    stamp = rospy.Time(nsecs=START + round(1e9 * scan.stamp))
    observations = [_observation_to_message(each) for each in scan.observations]
    return LandmarkObservations(Header(stamp=stamp, frame_id=frame), observations)


def _observation_to_message(seen: SimulatedObservation) -> LandmarkObservation:
    covariance = np.zeros((3, 3))
    covariance[:2, :2] = seen.covariance
    x, y = seen.position
    return LandmarkObservation(seen.class_name, -1, x, y, np.nan, list(np.ravel(covariance)))


def outlines(positions: np.ndarray, frame: str) -> MarkerArray:
    """Circles on the floor at positions (n, 2)."""
    angles = np.linspace(0.0, 2.0 * np.pi, 25)
    circle = RADIUS * np.column_stack([np.cos(angles), np.sin(angles)])
    lines = np.repeat(circle, 2, axis=0)[1:-1]  # from each point to the next
    marker = Marker(header=Header(frame_id=frame), ns="truth", type=Marker.LINE_LIST, color=GREY)
    marker.pose.orientation.w, marker.scale.x = 1.0, 0.015
    marker.points = [Point(x, y, 0.0) for position in positions for x, y in position + lines]
    return MarkerArray([marker])


def main() -> None:
    """Runs the node; exits with status 1 and the reason if a parameter is invalid."""
    with simulated_time("landmark_simulator"):
        params = read_params(LandmarkSimulatorParams)
        with fatal(ValueError, separator="/"):
            simulator = LandmarkSimulator(params)
        simulator.run()
