# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A simulated robot among landmarks, with a sensor that sees some of them, late."""

import threading
from dataclasses import dataclass
from typing import List, Optional, Tuple

import numpy as np
import rospy
import tf2_ros
from geometry_msgs.msg import Point, Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import ColorRGBA, Header
from std_srvs.srv import Trigger, TriggerResponse
from visualization_msgs.msg import Marker, MarkerArray

from sextant.base.strict_params import not_empty, param, within
from sextant.geometry.plane_poses import in_frame, relative
from sextant.msg import LandmarkSighting, LandmarkSightings
from sextant.nodes.base.exits import fatal
from sextant.nodes.base.listeners import wait_for_listener
from sextant.nodes.base.params import read_params
from sextant.nodes.simulation.simulated_clock import SimulatedClock, simulated_time
from sextant.nodes.simulation.simulator_messages import (
    pose_to_transform,
    reading_to_message,
    truth_to_message,
)
from sextant.simulation.landmark_world import (
    LandmarkDrive,
    LandmarkWorld,
    LandmarkWorldParams,
    Look,
    SeenLandmark,
    WorldMoment,
)
from sextant.simulation.motion import Motion
from sextant.simulation.odometry import SteppedOdometry

START = 10_000_000_000  # first stamp, nanoseconds: a clock that is 10 s behind tells a time, too
QUEUE = 100  # messages; a listener that stumbles loses none
RADIUS = 0.08  # metres, of an outline: around what is drawn of a landmark that is known
GREY = ColorRGBA(0.7, 0.7, 0.7, 1.0)


def two_sigmas(values: List[float]) -> str:
    """For parse_params()."""
    is_fine = len(values) == 2 and all(0.0 <= value <= 10.0 for value in values)
    return "" if is_fine else "must be two numbers within [0, 10]"


@dataclass(frozen=True)
class LandmarkSimulatorParams(LandmarkWorldParams):
    """What LandmarkWorldParams has, and how it is told to ROS."""

    duration: float = param(1e6)  # simulated seconds of the drive
    range_noise: List[float] = param([0.02, 0.005], two_sigmas)  # as LandmarkWorldParams has it
    cmd_vel_timeout: float = param(0.5, within(0.01, 1e6))  # simulated seconds after which a command is void
    real_time_factor: float = param(1.0, within(0.01, 100.0))  # simulated seconds in a second, at most
    wait_for_listener: float = param(0.0, within(0.0, 3600.0))  # seconds that the drive waits for a listener
    publish_tf: bool = param(True)  # odom -> base_link
    map_frame: str = param("map", not_empty)  # of the truth; begins where the robot does
    odom_frame: str = param("odom", not_empty)
    base_frame: str = param("base_link", not_empty)


class LandmarkSimulator:
    """Tells a drive moment by moment: the clock first, then what the robot says at that stamp.

    :raises ValueError: as LandmarkWorld
    """

    def __init__(self, params: LandmarkSimulatorParams):
        self._params, self._world = params, LandmarkWorld(params)
        self._drive, self._wheels = LandmarkDrive(self._world), SteppedOdometry()
        self._command: Optional[Twist] = None  # the first is still to come
        self._command_end = 0
        self._lock, self._stop = threading.Lock(), threading.Event()
        rospy.on_shutdown(self._stop.set)
        if rospy.is_shutdown():  # already: the hook will not be called
            self._stop.set()
        self._clock = SimulatedClock(START, params.real_time_factor, self._stop)
        self._tf = tf2_ros.TransformBroadcaster()
        self._odometry = rospy.Publisher("odom", Odometry, queue_size=QUEUE)
        self._truth = rospy.Publisher("ground_truth", Odometry, queue_size=QUEUE)
        self._sightings = rospy.Publisher("landmarks", LandmarkSightings, queue_size=QUEUE)
        self._outlines = rospy.Publisher("ground_truth/landmarks", MarkerArray, queue_size=1, latch=True)
        self._outlines.publish(outlines(in_frame(self._world.start, self._world.positions), params.map_frame))
        rospy.Subscriber("cmd_vel", Twist, self._on_command, queue_size=1)
        rospy.Service("~kidnap", Trigger, self._kidnap)

    def run(self) -> None:
        """Drives until the end, then lets time go on until the node is ended."""
        wait_for_listener(self._sightings, self._params.wait_for_listener, self._stop, self._clock.tell)
        for _ in range(round(self._params.duration * self._params.odometry_rate)):
            with self._lock:
                command = self._told()
                moment = self._drive.advance(command)
            stamp = START + round(1e9 * moment.stamp)
            self._clock.advance(stamp)
            if self._stop.is_set():
                return
            self._tell(moment, rospy.Time(nsecs=stamp))
        while not self._stop.is_set():
            self._clock.advance(self._clock.now + START)

    def _on_command(self, command: Twist) -> None:
        with self._lock:
            self._command = command
            self._command_end = self._clock.now + int(1e9 * self._params.cmd_vel_timeout)

    def _told(self) -> Optional[Tuple[float, float]]:
        """Speed and turn rate; None as long as nobody has told any."""
        if self._command is None:
            return None
        command = self._command if self._clock.now <= self._command_end else Twist()
        return command.linear.x, command.angular.z

    def _tell(self, moment: WorldMoment, stamp: rospy.Time) -> None:
        """Odometry before sightings: whoever hears them knows how far the robot came."""
        params, seconds = self._params, 1.0 / self._params.odometry_rate
        reading = self._wheels.add(moment.step, moment.noise, seconds)
        odom = Header(stamp=stamp, frame_id=params.odom_frame)
        if params.publish_tf:
            self._tf.sendTransform(pose_to_transform(reading.motion.pose, odom, params.base_frame))
        self._odometry.publish(reading_to_message(reading, odom, params.base_frame))
        x, y, yaw = relative(self._world.start, moment.pose)
        truth = Motion(x, y, 0.0, yaw, moment.speed, moment.turn_rate)
        header = Header(stamp=stamp, frame_id=params.map_frame)
        self._truth.publish(truth_to_message(truth, header, params.base_frame))
        if moment.look is not None:
            self._sightings.publish(look_to_message(moment.look, params.base_frame))

    def _kidnap(self, _request) -> TriggerResponse:
        with self._lock:
            distance = self._drive.carry()
        return TriggerResponse(True, f"carried {distance:.1f} m away, the wheels do not know")


def look_to_message(look: Look, frame: str) -> LandmarkSightings:
    """Stamped as the sensor's clock says."""
    stamp = rospy.Time(nsecs=START + round(1e9 * look.stamp))
    sightings = [_sighting_to_message(each) for each in look.sightings]
    return LandmarkSightings(Header(stamp=stamp, frame_id=frame), sightings)


def _sighting_to_message(seen: SeenLandmark) -> LandmarkSighting:
    covariance = np.zeros((3, 3))
    covariance[:2, :2] = seen.covariance
    x, y = seen.position
    return LandmarkSighting(seen.class_name, -1, x, y, np.nan, list(np.ravel(covariance)))


def outlines(positions: np.ndarray, frame: str) -> MarkerArray:
    """Circles on the floor around positions (n, 2)."""
    angles = np.linspace(0.0, 2.0 * np.pi, 25)
    circle = RADIUS * np.column_stack([np.cos(angles), np.sin(angles)])
    lines = np.repeat(circle, 2, axis=0)[1:-1]  # from each point to the next
    marker = Marker(header=Header(frame_id=frame), ns="truth", type=Marker.LINE_LIST, color=GREY)
    marker.pose.orientation.w, marker.scale.x = 1.0, 0.015
    marker.points = [Point(x, y, 0.0) for position in positions for x, y in position + lines]
    return MarkerArray([marker])


def main() -> None:
    """Runs the node; a parameter that cannot be taken ends it with status 1 and the reason."""
    with simulated_time("landmark_simulator"):
        params = read_params(LandmarkSimulatorParams)
        with fatal(ValueError, separator="/"):
            simulator = LandmarkSimulator(params)
        simulator.run()
