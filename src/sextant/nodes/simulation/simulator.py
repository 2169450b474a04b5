# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A simulated robot with a camera in a room with markers."""

import sys
import threading
from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from concurrent.futures import TimeoutError as NotYet
from dataclasses import dataclass
from typing import Iterator

import rospy
import tf2_ros
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Bool, Header

import sextant
from sextant.base.strict_params import not_empty, one_of, param, within
from sextant.nodes.base.conversions import image_to_message
from sextant.nodes.base.exits import fatal
from sextant.nodes.base.listeners import wait_for_listener
from sextant.nodes.base.params import read_params
from sextant.nodes.simulation.simulated_clock import SimulatedClock, simulated_time
from sextant.nodes.simulation.simulator_messages import (
    calibration_to_message,
    pose_to_transform,
    reading_to_message,
    truth_to_message,
)
from sextant.simulation.drive import DriveParams, Frame, SimulatedDrive
from sextant.simulation.motion import Motion, Unicycle
from sextant.simulation.room import MARKER_SIZE, default_map

START = 1_000_000_000  # first stamp, nanoseconds: zero means "no time" to ROS
IMAGE_QUEUE = 60  # frames; a listener that stumbles loses none


@dataclass(frozen=True)
class SimulatorParams(DriveParams):
    """What DriveParams has, and how it is told to ROS."""

    map_file: str = param("")  # markers of the room; empty: the eight of the default room
    family: str = param("tag36h11")  # of the default room, or of a map file in the plain text format
    marker_size: float = param(
        MARKER_SIZE, within(0.001, 100.0)
    )  # of a map file in the plain text format, metres
    motion: str = param("path", one_of("path", "cmd_vel"))  # a figure of eight, or as it is told
    cmd_vel_timeout: float = param(
        0.5, within(0.01, 1e6)
    )  # seconds (simulated) after which a command is void
    frames: int = param(0, within(0, 10**9))  # the drive ends after so many; 0: never
    real_time_factor: float = param(1.0, within(0.01, 100.0))  # simulated seconds in a second, at most
    render_ahead: int = param(
        15, within(1, 100000)
    )  # frames of a path that are ready before the drive starts
    wait_for_listener: float = param(0.0, within(0.0, 3600.0))  # seconds that the drive waits for a listener
    publish_tf: bool = param(True)  # odom -> base_link; the camera's mount is always published
    odom_frame: str = param("odom", not_empty)
    base_frame: str = param("base_link", not_empty)
    camera_frame: str = param("camera_optical_frame", not_empty)

    def marker_map(self) -> "sextant.MarkerMap":
        """:raises ValueError, RuntimeError: unknown family; a map file that cannot be read"""
        if not self.map_file:
            return default_map(self.family)
        text = sextant.TextMapParams()
        text.family, text.size = self.family, self.marker_size
        return sextant.read_marker_map(self.map_file, text)


class Simulator:
    """Tells a drive frame by frame: the clock first, then what the robot says at that stamp.

    :raises ValueError, RuntimeError: a parameter or the map file cannot be taken
    """

    def __init__(self, params: SimulatorParams):
        self._params = params
        self._drive = SimulatedDrive(params, params.marker_map())
        if params.motion == "path":
            self._drive.check_path()
        self._stop = threading.Event()
        rospy.on_shutdown(self._stop.set)
        if rospy.is_shutdown():  # already: the hook will not be called
            self._stop.set()
        self._clock = SimulatedClock(START, params.real_time_factor, self._stop)
        self._advertise()
        self._command, self._command_end = Twist(), 0
        if params.motion == "cmd_vel":
            rospy.Subscriber("cmd_vel", Twist, self._on_command, queue_size=1)

    def _advertise(self) -> None:
        self._image = rospy.Publisher("camera/image_raw", Image, queue_size=IMAGE_QUEUE)
        self._camera_info = rospy.Publisher("camera/camera_info", CameraInfo, queue_size=IMAGE_QUEUE)
        self._odometry = rospy.Publisher("odom", Odometry, queue_size=IMAGE_QUEUE)
        self._truth = rospy.Publisher("ground_truth", Odometry, queue_size=IMAGE_QUEUE)
        self._finished = rospy.Publisher("finished", Bool, queue_size=1, latch=True)
        self._finished.publish(False)
        self._tf = tf2_ros.TransformBroadcaster()
        self._static_tf = tf2_ros.StaticTransformBroadcaster()
        mount = Header(stamp=rospy.Time(nsecs=START), frame_id=self._params.base_frame)
        self._static_tf.sendTransform(
            pose_to_transform(self._drive.T_base_camera, mount, self._params.camera_frame)
        )

    def _on_command(self, command: Twist) -> None:
        self._command = command
        self._command_end = self._clock.now + int(1e9 * self._params.cmd_vel_timeout)

    def run(self) -> None:
        """Drives until the last frame, then lets time go on until the node is ended."""
        # other nodes may wait for a time before they listen
        wait_for_listener(self._image, self._params.wait_for_listener, self._stop, self._clock.tell)
        frames = {"path": self._along_the_path, "cmd_vel": self._as_told}[self._params.motion]()
        for frame in frames:
            stamp = START + round(1e9 * frame.time)
            self._clock.advance(stamp)
            if self._stop.is_set():
                return
            self._tell(frame, rospy.Time(nsecs=stamp))
        self._finished.publish(True)
        while not self._stop.is_set():
            self._clock.advance(self._clock.now + START)

    def _along_the_path(self) -> Iterator[Frame]:
        """Frames that a thread renders ahead; the first comes when render_ahead frames are ready."""
        frames = self._drive.frames(self._params.frames or sys.maxsize)
        with ThreadPoolExecutor(1) as thread:
            ahead = deque(thread.submit(next, frames, None) for _ in range(self._params.render_ahead))
            try:
                self._is_ready(ahead[-1])
                while self._is_ready(ahead[0]):
                    frame = ahead.popleft().result()
                    if frame is None:
                        return
                    yield frame
                    ahead.append(thread.submit(next, frames, None))
            finally:
                for render in ahead:
                    render.cancel()

    def _is_ready(self, render: Future) -> bool:
        """Waits for a frame; False: the node ends."""
        while not self._stop.is_set():
            try:
                render.result(timeout=0.1)
                return True
            except NotYet:
                pass
        return False

    def _as_told(self) -> Iterator[Frame]:
        """Frames of a robot that obeys cmd_vel, each rendered when its command is known."""
        start = self._drive.path.at(0.0)
        robot = Unicycle(Motion(start.x, start.y, start.z, start.yaw), self._drive.is_free)
        for _ in range(self._params.frames or sys.maxsize):
            yield self._drive.frame(self._obey(robot))

    def _obey(self, robot: Unicycle) -> Motion:
        command = self._command if self._clock.now <= self._command_end else Twist()
        return robot.drive(command.linear.x, command.angular.z, 1.0 / self._params.rate)

    def _tell(self, frame: Frame, stamp: rospy.Time) -> None:
        """Transform before image: whoever hears the image can place it."""
        params = self._params
        odom, camera = (
            Header(stamp=stamp, frame_id=params.odom_frame),
            Header(stamp=stamp, frame_id=params.camera_frame),
        )
        if params.publish_tf:
            self._tf.sendTransform(pose_to_transform(frame.T_odom_base, odom, params.base_frame))
        self._odometry.publish(reading_to_message(frame.odometry, odom, params.base_frame))
        truth = Header(stamp=stamp, frame_id=self._drive.map.frame)
        self._truth.publish(truth_to_message(frame.truth, truth, params.base_frame))
        self._camera_info.publish(calibration_to_message(self._drive.calibration, camera))
        self._image.publish(image_to_message(frame.image, camera))


def main() -> None:
    """Runs the node; a parameter or a map file that cannot be taken ends it with status 1 and the reason."""
    with simulated_time("simulator"):
        with fatal(ValueError, RuntimeError):
            simulator = Simulator(read_params(SimulatorParams))
        simulator.run()
