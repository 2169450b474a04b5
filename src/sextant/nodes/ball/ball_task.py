# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Drives a robot that brings a ball through a goal of pillars."""

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

from sextant.ball.ball_task import ENDS, BallTask
from sextant.ball.floor_grid import FloorGrid
from sextant.ball.path_follower import HALT, Command
from sextant.ball.task_view import Action, TaskView
from sextant.msg import BallTaskState, LandmarkMapEntries, Objects
from sextant.nodes.ball.ball_senses import BallSenses
from sextant.nodes.ball.ball_task_messages import floor_message, path_message, task_markers
from sextant.nodes.ball.ball_task_node_params import BallTaskNodeParams
from sextant.nodes.ball.ball_task_report import BallTaskReport
from sextant.nodes.ball.floor_eye import FloorEye
from sextant.nodes.base.exits import until_shutdown
from sextant.nodes.base.params import read_params

LONGEST_SLEEP = 0.05  # seconds of the wall's clock; so often it is looked whether poses come
REPORT_EVERY = 1.0  # seconds of the wall's clock
LAST_WORD = 0.1  # seconds for the last command to be sent
BUFFER = 2**24  # bytes, of a connection


class BallTaskNode:
    """Callbacks keep what they hear, one loop acts on it."""

    def __init__(self, params: BallTaskNodeParams):
        self._params, self._report = params, BallTaskReport()
        self._task, self._grid = BallTask(params.task), FloorGrid(params.grid)
        self._senses = BallSenses(params.ball_timeout, params.task.kick.ball_deceleration)
        self._eye = FloorEye(params.depth_scale, params.depth_step)
        self._ears, self._hands = threading.Lock(), threading.Lock()  # what is heard; what is done
        self._last_word = threading.RLock()  # that nothing is commanded after the node has ended
        self._news, self._stop = threading.Event(), threading.Event()
        self._is_running, self._stamp, self._robot = False, -np.inf, np.zeros(2)  # of the last step
        self._reported, self._waits_since = 0.0, np.inf
        rospy.on_shutdown(self._end)
        self._advertise()
        if params.autostart:
            self._begin()
        else:
            self._rest("stopped", "nobody has started it")
        self._listen()
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
        self._updater.add("task", self._report.tell)

    def _listen(self) -> None:
        senses = self._senses
        for topic, kind, hear in (
            ("odom", Odometry, senses.hear_odometry),
            ("odometry/filtered", Odometry, senses.hear_pose),
            ("landmark_map/entries", LandmarkMapEntries, senses.hear_landmarks),
            ("ball", Odometry, senses.hear_ball),
            ("objects", Objects, senses.hear_objects),
            ("bumper", Bool, lambda bumper: senses.hear_bumper(bumper.data)),
        ):
            rospy.Subscriber(topic, kind, self._on_message, (topic, hear), queue_size=100)
        if self._params.use_depth:
            rospy.Subscriber("depth/camera_info", CameraInfo, self._on_info, queue_size=1)
            rospy.Subscriber("depth/image", Image, self._on_depth, queue_size=2, buff_size=BUFFER)

    def run(self) -> None:
        """Until the node ends; whatever ends it, the robot stops."""
        try:
            while not self._stop.is_set():
                self._news.wait(LONGEST_SLEEP)
                self._news.clear()
                with self._hands:
                    self._work()
                self._tell_now_and_then()
        finally:
            if not self._stop.is_set():
                self._end()

    def _end(self) -> None:
        with self._last_word:
            self._stop.set()
            self._command(HALT)
        self._news.set()
        time.sleep(LAST_WORD)

    def _on_message(self, message: Any, how: Tuple[str, Callable[[Any], None]]) -> None:
        topic, hear = how
        with self._ears:
            try:
                hear(message)
            except ValueError as error:
                self._report.refuse(topic, error)
        self._news.set()

    def _on_info(self, info: CameraInfo) -> None:
        with self._ears:
            self._eye.hear(info)

    def _on_depth(self, depth: Image) -> None:
        with self._ears:
            try:
                points = self._eye.look(depth, self._senses.base_frame)
                self._senses.hear_depth(depth.header.stamp.to_nsec(), points)
                self._report.depth_images += 1
            except ValueError as error:
                self._report.refuse("depth/image", error)

    def _on_start(self, _request: TriggerRequest) -> TriggerResponse:
        with self._hands:
            self._begin()
        return TriggerResponse(True, "the task begins")

    def _on_stop(self, _request: TriggerRequest) -> TriggerResponse:
        with self._hands:
            self._rest("stopped", "somebody has stopped it")
        return TriggerResponse(True, "the robot stops")

    def _begin(self) -> None:
        """From the beginning, with a floor that nobody has seen."""
        self._task.start()
        with self._ears:
            self._senses.forget_touches()
        self._grid = FloorGrid(self._params.grid)
        self._is_running, self._stamp, self._report.kicks = True, -np.inf, 0
        self._waits_since = np.inf
        self._say("waiting", "there is no pose yet")

    def _rest(self, state: str, reason: str) -> None:
        """Nothing more is done until it is started again."""
        self._is_running = False
        self._command(HALT)
        self._say(state, reason)

    def _work(self) -> None:
        if not self._is_running:
            return
        with self._ears:
            stamp, looks = self._senses.stamp, self._senses.looks()
        if stamp < self._stamp:
            self._begin()  # a clock was set back
        if looks and not np.isfinite(self._stamp) and not self._grid.seen.any():
            self._grid = FloorGrid(self._params.grid, looks[0][1][:2])  # it begins where the robot is
        for points, pose in looks:
            self._grid.look(points, pose)
        lacks = self._lacks(stamp)
        if lacks:
            self._wait(lacks)
        elif stamp > self._stamp:
            with self._ears:
                view = self._senses.view(self._grid)
            self._step(view)

    def _lacks(self, stamp: float) -> str:
        """What it cannot drive without, and was not told of for too long. Ahead of time: of another clock."""
        now, params, senses = rospy.get_time(), self._params, self._senses
        if abs(now - stamp) > params.pose_timeout:
            where = rospy.resolve_name("odometry/filtered")
            return f"no pose on {where} of the last {params.pose_timeout:g} s"
        for topic, newest in (
            ("objects", senses.pictures),  # NaN, that is fine: somebody else follows the ball
            ("depth/image", senses.depth if params.use_depth else np.nan),
        ):
            if abs(now - newest) > params.picture_timeout:
                return f"nothing on {rospy.resolve_name(topic)} of the last {params.picture_timeout:g} s"
        return ""

    def _wait(self, lacks: str) -> None:
        """Blind, it stands."""
        self._command(HALT)
        now = rospy.get_time()
        self._waits_since = min(self._waits_since, now or np.inf)  # 0: there is no clock yet
        if now - self._waits_since > self._params.patience:
            self._rest("failed", f"{lacks}, for {self._params.patience:g} s")
        elif (self._report.state, self._report.reason) != ("waiting", lacks):
            self._say("waiting", lacks)

    def _step(self, view: TaskView) -> None:
        begin = time.perf_counter()
        action = self._task.step(view)
        self._stamp, self._robot, self._waits_since = view.stamp, view.pose[:2], np.inf
        self._report.see(view)
        self._report.slowest = max(self._report.slowest, time.perf_counter() - begin)
        self._command(action.command)
        self._report.kicks = action.kicks
        self._say(action.state, action.reason)
        self._show(action, view)
        if action.is_ended:
            self._rest(action.state, action.reason)

    def _command(self, command: Command) -> None:
        """Within the limits, whatever was computed. :raises ValueError: it is not a number"""
        if not np.all(np.isfinite(command)):
            raise ValueError(f"the command {command} is not finite")
        kick, follower = self._params.task.kick, self._params.task.follower
        most = max(follower.speed, kick.most_speed), max(follower.turn_rate, follower.search_rate)
        with self._last_word:
            speed, turn_rate = HALT if self._stop.is_set() else np.clip(command, np.negative(most), most)
            self._commands.publish(Twist(Vector3(speed, 0.0, 0.0), Vector3(0.0, 0.0, turn_rate)))

    def _say(self, state: str, reason: str) -> None:
        report = self._report
        if (state, reason) != (report.state, report.reason):
            rospy.loginfo("%s: %s", state, reason)
        report.state, report.reason = state, reason
        self._states.publish(BallTaskState(self._header(), state, reason, report.kicks, state in ENDS))

    def _header(self) -> Header:
        stamp = rospy.Time.from_sec(self._stamp) if np.isfinite(self._stamp) else rospy.Time()
        return Header(stamp=stamp, frame_id=self._senses.map_frame)

    def _show(self, action: Action, view: TaskView) -> None:
        header = self._header()
        if self._plan.get_num_connections():
            self._plan.publish(path_message(action.path, header))
        if self._drawn.get_num_connections():
            kick = self._task.params.kick
            self._drawn.publish(task_markers(action, view, kick.robot_radius, kick.ball_radius, header))

    def _tell_now_and_then(self) -> None:
        if time.monotonic() - self._reported < REPORT_EVERY:
            return
        self._reported, self._report.without_pose = time.monotonic(), self._senses.without_pose
        self._updater.force_update()
        if self._floor.get_num_connections() and np.isfinite(self._stamp):
            self._floor.publish(floor_message(self._grid, self._robot, self._header()))


def main() -> None:
    """Runs the node; a parameter that cannot be taken ends it with status 1 and the reason."""
    rospy.init_node("ball_task")
    node = BallTaskNode(read_params(BallTaskNodeParams))
    with until_shutdown():
        node.run()
