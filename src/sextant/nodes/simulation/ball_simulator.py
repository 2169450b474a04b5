# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node ball_simulator: a simulated robot with a colour and a depth camera, a ball and a goal of pillars."""

from collections import deque
from dataclasses import dataclass, replace
from typing import Any, Deque, List, Tuple

import numpy as np
import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Bool, Header
from std_srvs.srv import Trigger, TriggerResponse
from visualization_msgs.msg import MarkerArray

import sextant
from sextant.base.strict_params import Check, nested, not_empty, one_of, param, within
from sextant.geometry.plane_poses import relative
from sextant.messages.camera_messages import calibration_to_message
from sextant.messages.image_messages import image_to_message
from sextant.msg import Objects
from sextant.nodes.base.params import read_params
from sextant.nodes.base.subscriber_wait import wait_for_subscriber
from sextant.nodes.simulation.ball_messages import (
    ball_to_message,
    depth_to_message,
    robot_motion,
    seen_to_message,
    world_to_visualization,
)
from sextant.nodes.simulation.simulated_clock import STEP, simulated_time
from sextant.nodes.simulation.simulated_robot import SimulatedRobot, SimulatedRobotParams
from sextant.simulation.ball_simulation import BallSimulation, BallSimulationParams
from sextant.simulation.ball_world import STRAYS, TASKS, random_world
from sextant.simulation.odometry import OdometryReading, SteppedOdometry

START = 10_000_000_000  # first stamp, nanoseconds: still positive for a clock that is 10 s behind
QUEUE = 30  # messages; a slow subscriber loses none
WORLD_PARAMS = (
    *"seed width height noise_sigma depth_noise depth_scale holes bleeding flicker slip hard".split(),
    *("ball_deceleration", "ball_restitution"),
)


@dataclass(frozen=True)
class BallSimulatorParams(SimulatedRobotParams):
    """Parameters of the robot, the task and the world."""

    task: int = param(
        2,
        "task whose rules apply; 2: the ball lies in front of the goal; 3: it lies farther off the "
        "goal's axis, and pillars may stand in front of the goal",
        one_of(*TASKS),
    )
    obstacles: int = param(
        -1,
        "number of pillars in front of the goal, up to 2 in task 3; -1: random",
        Check("-1, 0 to 2 in `task: 3`, else 0", within(-1, 2)),
    )
    image_rate: float = param(
        10.0, "rate of the images; stamps are multiples of 10 ms", within(0.1, 100.0), "Hz"
    )
    odometry_rate: float = param(20.0, "rate of odometry", within(1.0, 100.0), "Hz")
    latency: float = param(0.05, "delay from an image's stamp to its publication", within(0.0, 5.0), "s")
    depth_encoding: str = param("16UC1", "encoding of `depth/image`", one_of("16UC1", "32FC1"))
    world: BallSimulationParams = nested(
        BallSimulationParams, only=WORLD_PARAMS
    )  # its seed: of the first world
    map_frame: str = param("map", "frame of the ground truth", not_empty)
    colour_frame: str = param("colour_optical_frame", "frame of the colour images", not_empty)
    depth_frame: str = param("depth_optical_frame", "frame of the depth images", not_empty)

    def __post_init__(self):
        """:raises ValueError: too many obstacles for the task"""
        super().__post_init__()
        max_obstacles = TASKS[self.task].obstacles
        if self.obstacles > max_obstacles:
            raise ValueError(
                f"obstacles is {self.obstacles}, allowed is [-1, {max_obstacles}] in task {self.task}"
            )


class PeriodicTrigger:
    """Triggers at a constant rate."""

    def __init__(self, rate: float, start: int):
        """:param start: nanoseconds, first trigger"""
        self._period, self._start, self._number = 1e9 / rate, start, 0

    def is_due(self, now: int) -> bool:
        """Whether a trigger is due; each call consumes at most one. :param now: nanoseconds"""
        due = now >= self._start + round(self._number * self._period)
        self._number += due
        return due


class BallSimulator(SimulatedRobot):
    """Publishes the clock, then odometry at that stamp, then images with their latency."""

    def __init__(self, params: BallSimulatorParams):
        super().__init__(params, START, QUEUE)
        self._image_trigger, self._odometry_trigger = (
            PeriodicTrigger(params.image_rate, START),
            PeriodicTrigger(params.odometry_rate, START),
        )
        self._delayed: Deque[Tuple[int, List[Tuple[rospy.Publisher, Any]]]] = (
            deque()
        )  # time of publication, messages
        self._start_world(params.world.seed)
        self._advertise()
        rospy.Subscriber("cmd_vel", Twist, self._on_command, queue_size=1)
        rospy.Service("~reset", Trigger, self._reset)

    def _start_world(self, seed: int) -> None:
        """Create a world with the robot at its start."""
        obstacles = None if self._params.obstacles < 0 else self._params.obstacles
        strays = STRAYS if self._params.world.hard else 0
        world = random_world(self._params.task, seed, obstacles, strays)
        self._seed, self._start = seed, world.robot
        self._simulation = BallSimulation(world, replace(self._params.world, seed=seed))
        self._wheels, self._last_wheels, self._last_reading = SteppedOdometry(), np.zeros(3), self._clock.now
        self._is_bumped = False
        self._delayed.clear()
        self._command = None  # what was messages before was not messages of this world

    def _advertise(self) -> None:
        self._colour = rospy.Publisher("colour/image", Image, queue_size=QUEUE)
        self._colour_info = rospy.Publisher("colour/camera_info", CameraInfo, queue_size=QUEUE)
        self._depth = rospy.Publisher("depth/image", Image, queue_size=QUEUE)
        self._depth_info = rospy.Publisher("depth/camera_info", CameraInfo, queue_size=QUEUE)
        self._ball = rospy.Publisher("ground_truth/ball", Odometry, queue_size=QUEUE)
        self._objects = rospy.Publisher("ground_truth/objects", Objects, queue_size=QUEUE)
        self._drawn = rospy.Publisher("ground_truth/visualization", MarkerArray, queue_size=1)
        self._bumper = rospy.Publisher("bumper", Bool, queue_size=QUEUE, latch=True)
        self._bumper.publish(False)
        params, camera = self._params, self._simulation.camera
        self._publish_mounts(
            {params.colour_frame: camera.T_base_colour, params.depth_frame: camera.T_base_depth}
        )

    def run(self) -> None:
        """Simulate until the node is shut down."""
        # other nodes may wait for the clock before they subscribe
        wait_for_subscriber(self._colour, self._params.wait_for_subscriber, self._stop, self._clock.publish)
        while not self._stop.is_set():
            with self._lock:
                self._publish_due(self._clock.now)
            self._clock.advance(self._clock.now + STEP)
            with self._lock:
                self._advance()

    def _reset(self, _request) -> TriggerResponse:
        with self._lock:
            self._start_world((self._seed + 1) % 2**31)
            self._bumper.publish(False)
        return TriggerResponse(True, f"the next world, seed {self._seed}; odometry and map restart")

    def _advance(self) -> None:
        ground = self._simulation.ground
        ground.command(*self._commanded())
        ground.advance(1e-9 * STEP)
        if ground.is_bumped != self._is_bumped:
            self._is_bumped = ground.is_bumped
            self._bumper.publish(self._is_bumped)

    def _publish_due(self, now: int) -> None:
        """Odometry before images, so that a subscriber can transform them."""
        stamp = rospy.Time(nsecs=now)
        if self._odometry_trigger.is_due(now):
            self._publish_robot(stamp)
        if self._image_trigger.is_due(now):
            self._delayed.append((now + int(1e9 * self._params.latency), self._image_messages(stamp)))
            self._publish_visualization(stamp)
        while self._delayed and self._delayed[0][0] <= now:
            for publisher, message in self._delayed.popleft()[1]:
                publisher.publish(message)

    def _publish_visualization(self, stamp: rospy.Time) -> None:
        if self._drawn.get_num_connections():
            in_map = Header(stamp=stamp, frame_id=self._params.map_frame)
            drawn = world_to_visualization(self._simulation.world, self._simulation.ground, in_map)
            self._drawn.publish(drawn)

    def _publish_robot(self, stamp: rospy.Time) -> None:
        ground, map_frame = self._simulation.ground, self._params.map_frame
        truth = robot_motion(ground, self._start)
        self._publish_motion(stamp, self._reading(stamp.to_nsec()), truth, map_frame)
        in_map = Header(stamp=stamp, frame_id=map_frame)
        self._ball.publish(ball_to_message(ground, self._start, in_map))

    def _reading(self, now: int) -> OdometryReading:
        """Odometry with the motion of the wheels since the last reading."""
        wheels = self._simulation.ground.rolled
        at = np.array([wheels.x, wheels.y, wheels.yaw])
        step, seconds = relative(self._last_wheels, at), 1e-9 * max(now - self._last_reading, STEP)
        self._last_wheels, self._last_reading = at, now
        noise = sextant.odometry_step_noise(step, sextant.OdometryNoiseParams())
        return self._wheels.add(step, noise, seconds)

    def _image_messages(self, stamp: rospy.Time) -> List[Tuple[rospy.Publisher, Any]]:
        """Messages of one pair of images; nothing is rendered without a subscriber."""
        params, simulation = self._params, self._simulation
        colour = Header(stamp=stamp, frame_id=params.colour_frame)
        depth = Header(stamp=stamp, frame_id=params.depth_frame)
        messages = [
            (self._colour_info, calibration_to_message(simulation.camera.colour, colour)),
            (self._depth_info, calibration_to_message(simulation.camera.depth, depth)),
        ]
        if not any(each.get_num_connections() for each in (self._colour, self._depth, self._objects)):
            return messages
        images, size = simulation.take_images(), [params.world.camera.width, params.world.camera.height]
        return [
            *messages,
            (self._colour, image_to_message(images.colour, colour)),
            (self._depth, depth_to_message(images.depth, params.depth_encoding, depth)),
            (self._objects, seen_to_message(images.seen, simulation.class_names, size, colour)),
        ]


def main() -> None:
    """Runs the node; exits with status 1 and the reason if a parameter is invalid."""
    with simulated_time("ball_simulator"):
        BallSimulator(read_params(BallSimulatorParams)).run()
