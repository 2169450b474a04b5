# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node simulator: a simulated robot with a camera in a room with markers."""

import sys
from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from concurrent.futures import TimeoutError as NotYet
from dataclasses import dataclass
from typing import Iterator

import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Bool, Header

import sextant
from sextant.base.strict_params import Check, not_empty, one_of, param, within
from sextant.messages.camera_messages import calibration_to_message
from sextant.messages.image_messages import image_to_message
from sextant.nodes.base.exits import fatal
from sextant.nodes.base.params import read_params
from sextant.nodes.base.subscriber_wait import wait_for_subscriber
from sextant.nodes.simulation.simulated_clock import simulated_time
from sextant.nodes.simulation.simulated_robot import SimulatedRobot, SimulatedRobotParams
from sextant.simulation.drive import DriveParams, Frame, SimulatedDrive
from sextant.simulation.motion import Motion, Unicycle
from sextant.simulation.room_markers import MARKER_SIZE, default_map

SECOND = 1_000_000_000  # nanoseconds
START = SECOND  # first stamp; zero is invalid in ROS
IMAGE_QUEUE = 60  # images that a subscriber may be late before it loses one


@dataclass(frozen=True)
class SimulatorParams(DriveParams, SimulatedRobotParams):
    """Parameters of the drive, the robot and the room's map."""

    map_file: str = param(
        "", "[marker map](marker_map.md) of the room; empty: eight markers in a room of 6 m × 6 m"
    )
    family: str = param(
        "tag36h11",
        "marker family of the default room, or of a map in the [plain text format](marker_map.md#plain-text)",
        Check("[families](#marker-families)"),
    )
    marker_size: float = param(
        MARKER_SIZE,
        "edge length of the markers of a map in the [plain text format](marker_map.md#plain-text)",
        within(0.001, 100.0),
        "m",
    )
    motion: str = param(
        "path", "path: a figure of eight; cmd_vel: as commanded on `cmd_vel`", one_of("path", "cmd_vel")
    )
    frames: int = param(0, "number of frames after which the drive ends; 0: never", within(0, 10**9))
    render_ahead: int = param(
        15, "frames rendered before the drive starts, with `motion: path`", within(1, 100000)
    )
    camera_frame: str = param("camera_optical_frame", "frame of the images", not_empty)

    def marker_map(self) -> "sextant.MarkerMap":
        """The marker map. :raises ValueError, RuntimeError: unknown family, or an unreadable map file"""
        if not self.map_file:
            return default_map(self.family)
        text = sextant.TextMapParams()
        text.family, text.size = self.family, self.marker_size
        return sextant.read_marker_map(self.map_file, text)


class Simulator(SimulatedRobot):
    """Publishes a drive frame by frame: the clock first, then odometry and image at that stamp.

    :raises ValueError, RuntimeError: an invalid parameter or map file
    """

    def __init__(self, params: SimulatorParams):
        self._drive = SimulatedDrive(params, params.marker_map())
        if params.motion == "path":
            self._drive.check_path()
        super().__init__(params, START, IMAGE_QUEUE)
        self._advertise()
        if params.motion == "cmd_vel":
            rospy.Subscriber("cmd_vel", Twist, self._on_command, queue_size=1)

    def _advertise(self) -> None:
        self._image = rospy.Publisher("camera/image_raw", Image, queue_size=IMAGE_QUEUE)
        self._camera_info = rospy.Publisher("camera/camera_info", CameraInfo, queue_size=IMAGE_QUEUE)
        self._finished = rospy.Publisher("finished", Bool, queue_size=1, latch=True)
        self._finished.publish(False)
        self._publish_mounts({self._params.camera_frame: self._drive.T_base_camera})

    def run(self) -> None:
        """Drives until the last frame; the clock continues until the node is shut down."""
        # other nodes may wait for the clock before they subscribe
        wait_for_subscriber(self._image, self._params.wait_for_subscriber, self._stop, self._clock.publish)
        frames = {"path": self._along_the_path, "cmd_vel": self._as_commanded}[self._params.motion]()
        for frame in frames:
            stamp = START + round(1e9 * frame.time)
            self._clock.advance(stamp)
            if self._stop.is_set():
                return
            self._publish(frame, rospy.Time(nsecs=stamp))
        self._finished.publish(True)
        while not self._stop.is_set():
            self._clock.advance(self._clock.now + SECOND)

    def _along_the_path(self) -> Iterator[Frame]:
        """Frames rendered ahead by a thread; the first is returned when render_ahead frames are ready."""
        frames = self._drive.frames(self._params.frames or sys.maxsize)
        with ThreadPoolExecutor(1) as thread:
            ahead = deque(thread.submit(next, frames, None) for _ in range(self._params.render_ahead))
            try:
                self._wait_for(ahead[-1])
                while self._wait_for(ahead[0]):
                    frame = ahead.popleft().result()
                    if frame is None:
                        return
                    yield frame
                    ahead.append(thread.submit(next, frames, None))
            finally:
                for render in ahead:
                    render.cancel()

    def _wait_for(self, render: Future) -> bool:
        """Waits until a frame is rendered; False: the node is shut down."""
        while not self._stop.is_set():
            try:
                render.result(timeout=0.1)
                return True
            except NotYet:
                pass
        return False

    def _as_commanded(self) -> Iterator[Frame]:
        """Frames of a robot that follows cmd_vel, each rendered when its command is known."""
        start = self._drive.path.at(0.0)
        robot = Unicycle(Motion(start.x, start.y, start.z, start.yaw), self._drive.is_free)
        for _ in range(self._params.frames or sys.maxsize):
            yield self._drive.frame(robot.drive(*self._commanded(), 1.0 / self._params.rate))

    def _publish(self, frame: Frame, stamp: rospy.Time) -> None:
        """Publishes the transform first, so that tf has it when the image is received."""
        self._publish_motion(stamp, frame.odometry, frame.truth, self._drive.map.frame)
        camera = Header(stamp=stamp, frame_id=self._params.camera_frame)
        self._camera_info.publish(calibration_to_message(self._drive.calibration, camera))
        self._image.publish(image_to_message(frame.image, camera))


def main() -> None:
    """Runs the node; exits with status 1 and the reason if a parameter or the map file is invalid."""
    with simulated_time("simulator"):
        with fatal(ValueError, RuntimeError):
            simulator = Simulator(read_params(SimulatorParams))
        simulator.run()
