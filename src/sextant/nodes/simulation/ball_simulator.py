# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A simulated robot with a colour and a depth camera, a ball and a goal of pillars."""

import math
import threading
from collections import deque
from dataclasses import dataclass
from typing import Any, Deque, List, Tuple

import numpy as np
import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped, Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Bool, Header
from std_srvs.srv import Trigger, TriggerResponse
from visualization_msgs.msg import MarkerArray

import sextant
from sextant.base.strict_params import not_empty, one_of, param, within
from sextant.geometry.plane_poses import relative
from sextant.msg import Objects
from sextant.nodes.base.conversions import image_to_message
from sextant.nodes.base.listeners import wait_for_listener
from sextant.nodes.base.params import read_params
from sextant.nodes.simulation.ball_messages import (
    ball_to_message,
    depth_to_message,
    robot_motion,
    seen_to_message,
    world_to_visualization,
)
from sextant.nodes.simulation.simulated_clock import STEP, SimulatedClock, simulated_time
from sextant.nodes.simulation.simulator_messages import (
    calibration_to_message,
    pose_to_transform,
    reading_to_message,
    truth_to_message,
)
from sextant.simulation.ball_ground import BallParams, RobotParams
from sextant.simulation.ball_simulation import BallSimulation, BallSimulationParams
from sextant.simulation.ball_world import TASKS, drawn_world
from sextant.simulation.odometry import OdometryReading, SteppedOdometry
from sextant.simulation.rgbd_camera import RgbdParams

START = 10_000_000_000  # first stamp, nanoseconds: a clock that is 10 s behind tells a time, too
QUEUE = 30  # messages; a listener that stumbles loses none
CAMERA, DRIVE, BALL = RgbdParams(), RobotParams(), BallParams()
WORLD = BallSimulationParams()


@dataclass(frozen=True)
class BallSimulatorParams:
    """What of the world is chosen, and how it is told to ROS."""

    task: int = param(2, one_of(*TASKS))
    seed: int = param(0, within(0, 2**31 - 1))  # of the world, its look and all noise
    obstacles: int = param(-1, within(-1, 2))  # pillars before the goal; -1: as many as come
    picture_rate: float = param(10.0, within(0.1, 100.0))  # Hz
    odometry_rate: float = param(20.0, within(1.0, 100.0))  # Hz
    latency: float = param(0.05, within(0.0, 5.0))  # seconds from a picture's stamp until it is told
    depth_encoding: str = param("16UC1", one_of("16UC1", "32FC1"))  # millimetres or metres
    width: int = param(CAMERA.width, within(16, 4096))  # pixels, of both pictures
    height: int = param(CAMERA.height, within(16, 4096))
    noise_sigma: float = param(CAMERA.noise_sigma, within(0.0, 100.0))  # levels of colour
    depth_noise: float = param(CAMERA.depth_noise, within(0.0, 1.0))  # metres at 1 m
    depth_scale: float = param(CAMERA.depth_scale, within(0.5, 2.0))  # what the camera says of a metre
    holes: float = param(CAMERA.holes, within(0.0, 1.0))  # share of depths that are not there
    flicker: float = param(WORLD.flicker, within(0.0, 1.0))  # share by which the light changes
    slip: float = param(DRIVE.slip, within(0.0, 1.0))  # share of way and turn that wheels lose, at most
    rolling: float = param(BALL.rolling, within(0.0, 10.0))  # m/s^2 by which the ball slows down
    bounce: float = param(BALL.bounce, within(0.0, 1.0))  # share of its speed that the ball keeps
    cmd_vel_timeout: float = param(0.5, within(0.01, 1e6))  # simulated seconds after which a command is void
    real_time_factor: float = param(1.0, within(0.01, 100.0))  # simulated seconds in a second, at most
    wait_for_listener: float = param(
        0.0, within(0.0, 3600.0)
    )  # seconds that it waits for one of the colour image
    publish_tf: bool = param(True)  # odom -> base_link; the cameras' mounts are always published
    map_frame: str = param("map", not_empty)  # of the truth; begins where the robot does
    odom_frame: str = param("odom", not_empty)
    base_frame: str = param("base_link", not_empty)
    colour_frame: str = param("colour_optical_frame", not_empty)
    depth_frame: str = param("depth_optical_frame", not_empty)

    def __post_init__(self):
        """:raises ValueError: there are not so many obstacles in the task"""
        most = TASKS[self.task].obstacles
        if self.obstacles > most:
            raise ValueError(f"obstacles is {self.obstacles}, allowed is [-1, {most}] in task {self.task}")

    def simulation(self, seed: int) -> BallSimulationParams:
        """Of a world of this seed."""
        camera = RgbdParams(
            width=self.width,
            height=self.height,
            noise_sigma=self.noise_sigma,
            depth_noise=self.depth_noise,
            depth_scale=self.depth_scale,
            holes=self.holes,
        )
        ball = BallParams(rolling=self.rolling, bounce=self.bounce)
        return BallSimulationParams(seed, self.flicker, ball, RobotParams(slip=self.slip), camera)


class Beat:
    """Tells when it is time again."""

    def __init__(self, rate: float, start: int):
        """:param start: nanoseconds, the first beat"""
        self._period, self._start, self._number = 1e9 / rate, start, 0

    def is_due(self, now: int) -> bool:
        """Once for every beat; the next one is not before the next call."""
        due = now >= self._start + round(self._number * self._period)
        self._number += due
        return due


class BallSimulator:
    """Tells the clock first, then what the robot says at that stamp, then pictures of a little earlier."""

    def __init__(self, params: BallSimulatorParams):
        self._params = params
        self._lock, self._stop = threading.Lock(), threading.Event()
        rospy.on_shutdown(self._stop.set)
        if rospy.is_shutdown():  # already: the hook will not be called
            self._stop.set()
        self._clock = SimulatedClock(START, params.real_time_factor, self._stop)
        self._pictures, self._readings = Beat(params.picture_rate, START), Beat(params.odometry_rate, START)
        self._late: Deque[Tuple[int, List[Tuple[rospy.Publisher, Any]]]] = deque()  # when to say what
        self._begin(params.seed)
        self._advertise()
        rospy.Subscriber("cmd_vel", Twist, self._on_command, queue_size=1)
        rospy.Service("~reset", Trigger, self._reset)

    def _begin(self, seed: int) -> None:
        """A world, with the robot at its start."""
        obstacles = None if self._params.obstacles < 0 else self._params.obstacles
        world = drawn_world(self._params.task, seed, obstacles)
        self._seed, self._start = seed, world.robot
        self._simulation = BallSimulation(world, self._params.simulation(seed))
        self._wheels, self._rolled, self._read_at = SteppedOdometry(), np.zeros(3), self._clock.now
        self._is_bumped = False
        self._late.clear()
        self._command, self._command_end = Twist(), 0  # what was said before was not said of this world

    def _advertise(self) -> None:
        self._colour = rospy.Publisher("colour/image", Image, queue_size=QUEUE)
        self._colour_info = rospy.Publisher("colour/camera_info", CameraInfo, queue_size=QUEUE)
        self._depth = rospy.Publisher("depth/image", Image, queue_size=QUEUE)
        self._depth_info = rospy.Publisher("depth/camera_info", CameraInfo, queue_size=QUEUE)
        self._odometry = rospy.Publisher("odom", Odometry, queue_size=QUEUE)
        self._truth = rospy.Publisher("ground_truth", Odometry, queue_size=QUEUE)
        self._ball = rospy.Publisher("ground_truth/ball", Odometry, queue_size=QUEUE)
        self._objects = rospy.Publisher("ground_truth/objects", Objects, queue_size=QUEUE)
        self._drawn = rospy.Publisher("ground_truth/visualization", MarkerArray, queue_size=1)
        self._bumper = rospy.Publisher("bumper", Bool, queue_size=QUEUE, latch=True)
        self._bumper.publish(False)
        self._tf, self._static_tf = tf2_ros.TransformBroadcaster(), tf2_ros.StaticTransformBroadcaster()
        self._static_tf.sendTransform(self._mounts())

    def _mounts(self) -> List[TransformStamped]:
        params, camera = self._params, self._simulation.camera
        base = Header(stamp=rospy.Time(nsecs=START), frame_id=params.base_frame)
        frames = {params.colour_frame: camera.T_base_colour, params.depth_frame: camera.T_base_depth}
        return [pose_to_transform(T, base, frame) for frame, T in frames.items()]

    def run(self) -> None:
        """Until the node ends."""
        # other nodes may wait for a time before they listen
        wait_for_listener(self._colour, self._params.wait_for_listener, self._stop, self._clock.tell)
        while not self._stop.is_set():
            with self._lock:
                self._tell(self._clock.now)
            self._clock.advance(self._clock.now + STEP)
            with self._lock:
                self._move()

    def _on_command(self, command: Twist) -> None:
        if not math.isfinite(command.linear.x + command.angular.z):
            rospy.logwarn_throttle(60.0, "cmd_vel is not a number: not obeyed")
            return
        with self._lock:
            self._command = command
            self._command_end = self._clock.now + int(1e9 * self._params.cmd_vel_timeout)

    def _reset(self, _request) -> TriggerResponse:
        with self._lock:
            self._begin((self._seed + 1) % 2**31)
            self._bumper.publish(False)
        return TriggerResponse(True, f"the next world, seed {self._seed}; odometry and map begin anew")

    def _move(self) -> None:
        command = self._command if self._clock.now <= self._command_end else Twist()
        ground = self._simulation.ground
        ground.command(command.linear.x, command.angular.z)
        ground.advance(1e-9 * STEP)
        if ground.is_bumped != self._is_bumped:
            self._is_bumped = ground.is_bumped
            self._bumper.publish(self._is_bumped)

    def _tell(self, now: int) -> None:
        """Motion before pictures: whoever sees one can place it."""
        stamp = rospy.Time(nsecs=now)
        if self._readings.is_due(now):
            self._tell_motion(stamp)
        if self._pictures.is_due(now):
            self._late.append((now + int(1e9 * self._params.latency), self._seen(stamp)))
            self._draw(stamp)
        while self._late and self._late[0][0] <= now:
            for publisher, message in self._late.popleft()[1]:
                publisher.publish(message)

    def _draw(self, stamp: rospy.Time) -> None:
        if self._drawn.get_num_connections():
            in_map = Header(stamp=stamp, frame_id=self._params.map_frame)
            drawn = world_to_visualization(self._simulation.world, self._simulation.ground, in_map)
            self._drawn.publish(drawn)

    def _tell_motion(self, stamp: rospy.Time) -> None:
        params, reading = self._params, self._reading(stamp.to_nsec())
        odom = Header(stamp=stamp, frame_id=params.odom_frame)
        if params.publish_tf:
            self._tf.sendTransform(pose_to_transform(reading.motion.pose, odom, params.base_frame))
        self._odometry.publish(reading_to_message(reading, odom, params.base_frame))
        ground, in_map = self._simulation.ground, Header(stamp=stamp, frame_id=params.map_frame)
        truth = robot_motion(ground, self._start)
        self._truth.publish(truth_to_message(truth, in_map, params.base_frame))
        self._ball.publish(ball_to_message(ground, self._start, in_map))

    def _reading(self, now: int) -> OdometryReading:
        """What the wheels did since the last one."""
        rolled = self._simulation.ground.rolled
        at = np.array([rolled.x, rolled.y, rolled.yaw])
        step, seconds = relative(self._rolled, at), 1e-9 * max(now - self._read_at, STEP)
        self._rolled, self._read_at = at, now
        noise = sextant.odometry_step_noise(step, sextant.OdometryNoiseParams())
        return self._wheels.add(step, noise, seconds)

    def _seen(self, stamp: rospy.Time) -> List[Tuple[rospy.Publisher, Any]]:
        """What there is to say of a picture; none is taken when nobody hears it."""
        params, simulation = self._params, self._simulation
        colour = Header(stamp=stamp, frame_id=params.colour_frame)
        depth = Header(stamp=stamp, frame_id=params.depth_frame)
        said = [
            (self._colour_info, calibration_to_message(simulation.camera.colour, colour)),
            (self._depth_info, calibration_to_message(simulation.camera.depth, depth)),
        ]
        if not any(each.get_num_connections() for each in (self._colour, self._depth, self._objects)):
            return said
        picture, size = simulation.take_picture(), [params.width, params.height]
        return [
            *said,
            (self._colour, image_to_message(picture.colour, colour)),
            (self._depth, depth_to_message(picture.depth, params.depth_encoding, depth)),
            (self._objects, seen_to_message(picture.seen, simulation.class_names, size, colour)),
        ]


def main() -> None:
    """Runs the node; a parameter that cannot be taken ends it with status 1 and the reason."""
    with simulated_time("ball_simulator"):
        BallSimulator(read_params(BallSimulatorParams)).run()
