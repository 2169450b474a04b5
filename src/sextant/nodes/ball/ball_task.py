# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node ball_task: drives a robot that kicks a ball through a goal of pillars."""

import threading
import time
from typing import Any, Callable, Tuple

import numpy as np
import rospy
from diagnostic_updater import Updater
from geometry_msgs.msg import Twist, Vector3
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Bool, Header
from std_srvs.srv import Trigger, TriggerRequest, TriggerResponse
from visualization_msgs.msg import MarkerArray

from sextant.ball.ball_task import FINAL_STATES, BallTask
from sextant.ball.floor_grid import FloorGrid
from sextant.ball.path_follower import HALT, Command
from sextant.ball.task_view import Action, TaskView
from sextant.msg import BallTaskState, LandmarkMapEntries, Objects
from sextant.nodes.ball.ball_task_inputs import BallTaskInputs
from sextant.nodes.ball.ball_task_messages import floor_message, path_message, task_markers
from sextant.nodes.ball.ball_task_node_params import BallTaskNodeParams
from sextant.nodes.ball.ball_task_report import BallTaskReport
from sextant.nodes.ball.floor_camera import FloorCamera
from sextant.nodes.base.exits import until_shutdown
from sextant.nodes.base.init_node import init_node
from sextant.nodes.base.params import read_params

MAX_SLEEP = 0.05  # seconds of wall time between checks for missing poses
REPORT_EVERY = 1.0  # seconds of wall time
SEND_TIME = 0.1  # seconds to wait until the last command has been sent
BUFFER = 2**24  # bytes, receive buffer of a subscription


class BallTaskNode:
    """Callbacks store messages; one loop runs the task."""

    def __init__(self, params: BallTaskNodeParams):
        self._params, self._report = params, BallTaskReport()
        self._task, self._grid = BallTask(params.task), FloorGrid(params.grid)
        self._inputs = BallTaskInputs(params.ball_timeout, params.task.kick.ball_deceleration)
        self._floor_camera = FloorCamera(params.depth_scale, params.depth_step)
        self._input_lock, self._task_lock = threading.Lock(), threading.Lock()  # of the inputs; of the task
        self._command_lock = threading.RLock()  # no command after the final stop
        self._is_updated, self._stop = threading.Event(), threading.Event()
        self._is_running, self._stamp, self._robot = False, -np.inf, np.zeros(2)  # at the last step
        self._reported, self._waiting_since = 0.0, np.inf
        rospy.on_shutdown(self._end)
        self._advertise()
        if params.autostart:
            self._start_task()
        else:
            self._stop_task("stopped", "waiting for ~start")
        self._subscribe()
        rospy.Service("~start", Trigger, self._on_start)
        rospy.Service("~stop", Trigger, self._on_stop)

    def _advertise(self) -> None:
        self._commands = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self._plan = rospy.Publisher("plan", Path, queue_size=1)
        self._states = rospy.Publisher("~state", BallTaskState, queue_size=10, latch=True)
        self._drawn = rospy.Publisher("visualization", MarkerArray, queue_size=1)
        self._floor = rospy.Publisher("floor", OccupancyGrid, queue_size=1, latch=True)
        self._updater = Updater()
        self._updater.setHardwareID("none")
        self._updater.add("task", self._report.fill_diagnostics)

    def _subscribe(self) -> None:
        inputs = self._inputs
        for topic, message_type, handler in (
            ("odom", Odometry, inputs.add_odometry),
            ("odometry/filtered", Odometry, inputs.add_pose),
            ("landmark_map/entries", LandmarkMapEntries, inputs.set_landmarks),
            ("ball", Odometry, inputs.set_ball),
            ("objects", Objects, inputs.set_objects),
            ("bumper", Bool, lambda bumper: inputs.set_bumper(bumper.data)),
        ):
            rospy.Subscriber(topic, message_type, self._on_message, (topic, handler), queue_size=100)
        if self._params.use_depth:
            rospy.Subscriber("depth/camera_info", CameraInfo, self._on_info, queue_size=1)
            rospy.Subscriber("depth/image", Image, self._on_depth, queue_size=2, buff_size=BUFFER)

    def run(self) -> None:
        """Run the task until the node is shut down; whatever ends it, the robot stops."""
        try:
            while not self._stop.is_set():
                self._is_updated.wait(MAX_SLEEP)
                self._is_updated.clear()
                with self._task_lock:
                    self._run_once()
                self._report_periodically()
        finally:
            if not self._stop.is_set():
                self._end()

    def _end(self) -> None:
        with self._command_lock:
            self._stop.set()
            self._command(HALT)
        self._is_updated.set()
        time.sleep(SEND_TIME)

    def _on_message(self, message: Any, topic_and_handler: Tuple[str, Callable[[Any], None]]) -> None:
        topic, handler = topic_and_handler
        with self._input_lock:
            try:
                handler(message)
            except ValueError as error:
                self._report.reject(topic, error)
        self._is_updated.set()

    def _on_info(self, info: CameraInfo) -> None:
        with self._input_lock:
            self._floor_camera.set_info(info)

    def _on_depth(self, depth: Image) -> None:
        with self._input_lock:
            try:
                points = self._floor_camera.points(depth, self._inputs.base_frame)
                self._inputs.add_depth_points(depth.header.stamp.to_nsec(), points)
                self._report.depth_images += 1
            except ValueError as error:
                self._report.reject("depth/image", error)

    def _on_start(self, _request: TriggerRequest) -> TriggerResponse:
        with self._task_lock:
            self._start_task()
        return TriggerResponse(True, "the task starts")

    def _on_stop(self, _request: TriggerRequest) -> TriggerResponse:
        with self._task_lock:
            self._stop_task("stopped", "stopped by ~stop")
        return TriggerResponse(True, "the robot stops")

    def _start_task(self) -> None:
        """Start the task from the beginning with an empty grid."""
        self._task.start()
        with self._input_lock:
            self._inputs.clear_touches()
        self._grid = FloorGrid(self._params.grid)
        self._is_running, self._stamp, self._report.kicks = True, -np.inf, 0
        self._waiting_since = np.inf
        self._publish_state("waiting", "no pose yet")

    def _stop_task(self, state: str, reason: str) -> None:
        """Stop the robot until the task is started again."""
        self._is_running = False
        self._command(HALT)
        self._publish_state(state, reason)

    def _run_once(self) -> None:
        if not self._is_running:
            return
        with self._input_lock:
            stamp, images = self._inputs.stamp, self._inputs.ready_points()
        if stamp < self._stamp:
            self._start_task()  # the clock was reset
        if images and not np.isfinite(self._stamp) and not self._grid.seen.any():
            self._grid = FloorGrid(self._params.grid, images[0][1][:2])  # centred on the robot
        for points, pose in images:
            self._grid.update(points, pose)
        missing = self._missing(stamp)
        if missing:
            self._wait(missing)
        elif stamp > self._stamp:
            with self._input_lock:
                view = self._inputs.task_view(self._grid)
            self._step(view)

    def _missing(self, stamp: float) -> str:
        """Which required input is too old, or stamped in the future (by another clock); empty: none."""
        now, params, inputs = rospy.get_time(), self._params, self._inputs
        if abs(now - stamp) > params.pose_timeout:
            where = rospy.resolve_name("odometry/filtered")
            return f"no pose on {where} in the last {params.pose_timeout:g} s"
        for topic, newest in (
            ("objects", inputs.newest_image),  # NaN: not required, another node tracks the ball
            ("depth/image", inputs.newest_depth if params.use_depth else np.nan),
        ):
            if abs(now - newest) > params.image_timeout:
                return f"no message on {rospy.resolve_name(topic)} in the last {params.image_timeout:g} s"
        return ""

    def _wait(self, missing: str) -> None:
        """Stop the robot while an input is missing."""
        self._command(HALT)
        now = rospy.get_time()
        self._waiting_since = min(self._waiting_since, now or np.inf)  # 0: no clock yet
        if now - self._waiting_since > self._params.patience:
            self._stop_task("failed", f"{missing}; gave up after {self._params.patience:g} s")
        elif (self._report.state, self._report.reason) != ("waiting", missing):
            self._publish_state("waiting", missing)

    def _step(self, view: TaskView) -> None:
        begin = time.perf_counter()
        action = self._task.step(view)
        self._stamp, self._robot, self._waiting_since = view.stamp, view.pose[:2], np.inf
        self._report.set_view(view)
        self._report.longest_step = max(self._report.longest_step, time.perf_counter() - begin)
        self._command(action.command)
        self._report.kicks = action.kicks
        self._publish_state(action.state, action.reason)
        self._publish_plan(action, view)
        if action.is_ended:
            self._stop_task(action.state, action.reason)

    def _command(self, command: Command) -> None:
        """Publish a command, clipped to the limits. :raises ValueError: it is not finite"""
        if not np.all(np.isfinite(command)):
            raise ValueError(f"the command {command} is not finite")
        kick, follower = self._params.task.kick, self._params.task.follower
        limits = max(follower.speed, kick.max_kick_speed), max(follower.turn_rate, follower.search_turn_rate)
        with self._command_lock:
            speed, turn_rate = HALT if self._stop.is_set() else np.clip(command, np.negative(limits), limits)
            self._commands.publish(Twist(Vector3(speed, 0.0, 0.0), Vector3(0.0, 0.0, turn_rate)))

    def _publish_state(self, state: str, reason: str) -> None:
        report = self._report
        if (state, reason) != (report.state, report.reason):
            rospy.loginfo("%s: %s", state, reason)
        report.state, report.reason = state, reason
        self._states.publish(
            BallTaskState(self._header(), state, reason, report.kicks, state in FINAL_STATES)
        )

    def _header(self) -> Header:
        stamp = rospy.Time.from_sec(self._stamp) if np.isfinite(self._stamp) else rospy.Time()
        return Header(stamp=stamp, frame_id=self._inputs.map_frame)

    def _publish_plan(self, action: Action, view: TaskView) -> None:
        header = self._header()
        if self._plan.get_num_connections():
            self._plan.publish(path_message(action.path, header))
        if self._drawn.get_num_connections():
            kick = self._task.params.kick
            self._drawn.publish(task_markers(action, view, kick.robot_radius, kick.ball_radius, header))

    def _report_periodically(self) -> None:
        if time.monotonic() - self._reported < REPORT_EVERY:
            return
        self._reported, self._report.without_pose = time.monotonic(), self._inputs.without_pose
        self._updater.force_update()
        if self._floor.get_num_connections() and np.isfinite(self._stamp):
            self._floor.publish(floor_message(self._grid, self._robot, self._header()))


def main() -> None:
    """Runs the node; exits with status 1 and the reason if a parameter is invalid."""
    init_node("ball_task")
    node = BallTaskNode(read_params(BallTaskNodeParams))
    with until_shutdown():
        node.run()
