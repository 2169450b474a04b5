# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""State machine of the ball task: kick the ball through the goal, then stop in front of it."""

import math
from typing import Callable, Dict, Optional

import numpy as np

from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.goal import Goal, find_goal, goal_between, goes_through
from sextant.ball.kick_plan import Kick
from sextant.ball.kicking import Aligning, Kicking
from sextant.ball.path_follower import HALT, bearing_of, follow, turn_on_the_spot
from sextant.ball.searching import FullTurn, Searching
from sextant.ball.stopping import Stopping
from sextant.ball.task_planner import MIN_CLEARANCE, TaskPlanner, mark_bump
from sextant.ball.task_view import Action, SeenBall, Step, TaskView
from sextant.objects.object_kinds import GOAL

REPLAN = 0.5  # seconds
ARRIVAL_RADIUS, MIN_ARRIVAL_RADIUS = (
    0.05,
    0.015,
)  # metres to the start of a kick; halved after each failed alignment
BEHIND = 0.02  # metres behind the goal line where the ball counts as through
MAX_BALL_AGE = 0.5  # seconds since the last image with the ball in which a crossing is detected
MAX_POST_SHIFT = 0.4  # fraction of the goal's width by which a post may move between steps
MAX_WATCH, MIN_WATCH = 8.0, 0.6  # seconds, maximum and minimum time of watching
OUT_OF_VIEW = 0.3  # radians from the heading to the ball
BACK_OFF, BACK_SPEED = 0.25, 0.15  # metres and m/s after a bump
STUCK_TIME, MIN_MOTION = 2.5, 0.05  # seconds and m/s: the robot is stuck if slower despite its command
MAX_PAUSE = 0.5  # seconds between steps; after longer pauses the stuck check restarts
MIN_GAIN, MAX_GAIN = 0.5, 2.5  # limits of the adapted gain
BALL_CONTACT = 0.1  # metres beyond contact at which the ball may press the bumper
MAX_BLOCKED = 3  # retries without a path until the task fails
MAX_TRIES = 12  # alignments per kick
FINAL_STATES = ("done", "failed")


class BallTask:
    """Computes a command from each view of the world."""

    def __init__(self, params: BallTaskParams):
        self.params = params
        self._states: Dict[str, Callable[[TaskView], Step]] = {
            "searching": self._search,
            "approaching": self._approach,
            "aligning": self._align,
            "kicking": self._kick_ball,
            "watching": self._watch,
            "stopping": self._stop,
            "recovering": self._back_off,
            "blocked": self._retry,
            "done": lambda view: Step(HALT),
            "failed": lambda view: Step(HALT),
        }
        self.start()

    def start(self) -> None:
        """Start from the beginning, without a goal."""
        self.state, self.reason = "searching", "the task starts"
        self.kicks, self._bumps, self._blocked, self._tries = 0, 0, 0, 0
        self._begin = self._entered = math.nan
        self.goal: Optional[Goal] = None
        self._kick: Optional[Kick] = None
        self._gain, self._arrived = 1.0, ARRIVAL_RADIUS
        self._before: Optional[np.ndarray] = None  # (2,) last position of the ball in front of the goal line
        self._is_through, self._is_adapted = False, True
        self._searching = Searching(self.params)
        self._path, self._planned = None, -math.inf
        self._moved_at, self._moved_pose, self._stepped = math.nan, np.zeros(3), math.nan
        self._sense = 1.0  # of the last motion; -1: backward

    def step(self, view: TaskView) -> Action:
        """Compute the next action; call it with every odometry message.

        :raises ValueError: a position in the view is not finite; the state is unchanged
        """
        view.validate()
        if math.isnan(self._begin):
            self._begin = self._entered = self._moved_at = view.stamp
        self._update_goal(view)
        self._check_limits(view)
        step = self._states[self.state](view)
        if step.next:
            self._enter(step.next, step.reason, view)
        is_stuck = self._check_stuck(view, step)
        ended = self.state in FINAL_STATES
        command = HALT if ended or is_stuck else step.command
        return Action(command, self.state, self.reason, step.path, self.goal, self._kick, self.kicks, ended)

    def _enter(self, state: str, reason: str, view: TaskView) -> None:
        self.state, self.reason, self._entered = state, reason, view.stamp
        self._path, self._planned = None, -math.inf
        if state == "searching":
            self._searching = Searching(self.params)
        elif state == "aligning":
            self._aligning = Aligning(self.params, self._kick, self._tries)
        elif state == "kicking":
            self.kicks, self._tries, self._arrived, self._is_adapted = (
                self.kicks + 1,
                0,
                ARRIVAL_RADIUS,
                False,
            )
            self._kicking = Kicking(
                self.params, self._kick, self.params.kick.speed(self._kick.distance, self._gain)
            )
        elif state == "stopping":
            self._stopping = Stopping(self.params)
        elif state == "blocked":
            self._turn = FullTurn()
        elif state == "recovering":
            self._bumped_at, self._back = view.pose.copy(), -self._sense

    def _update_goal(self, view: TaskView) -> None:
        """Update the goal and whether the ball crossed it. Until the first kick the goal is selected in each
        step; without a valid one the last goal is kept."""
        blue = np.array([each.position for each in view.pillars if each.class_name == GOAL]).reshape(-1, 2)
        found = None
        if view.ball is not None and not self.kicks:
            found = find_goal(blue, view.ball.position, self.params.goal_width)
        if found is not None:
            self.goal = found
        elif self.goal is not None:
            self.goal = _corrected(self.goal, blue)
        if self.goal is not None and self.kicks and view.ball is not None:
            self._check_crossing(self.goal, view.ball, view.stamp - view.ball.stamp)

    def _check_crossing(self, goal: Goal, seen: SeenBall, age: float) -> None:
        """Detect a crossing once the ball is clearly behind the line: on the line, noise could look like one.

        :param age: seconds since the last image with the ball; its position is taken back to that time
        """
        if age > MAX_BALL_AGE:
            return
        ball = seen.position - age * seen.velocity
        if goal.distance_before(ball) > 0.0:
            self._before = ball
        elif goal.distance_before(ball) < -BEHIND and self._before is not None:
            self._is_through |= goes_through(goal, self._before, ball)
            self._before = None

    def _check_limits(self, view: TaskView) -> None:
        """Transitions that are possible in every state."""
        if self.state in FINAL_STATES:
            return
        if view.stamp - self._begin > self.params.time_limit:
            self._enter("failed", f"not done after {self.params.time_limit:g} s, last: {self.state}", view)
        elif view.is_bumped and self.state != "recovering" and not self._touches_ball(view):
            self._bump("bumped", view)
        elif self._is_through and self.state in ("searching", "approaching", "aligning", "watching"):
            self._enter("stopping", "the ball went through the goal", view)

    def _touches_ball(self, view: TaskView) -> bool:
        """Whether the kicked ball presses the bumper."""
        kick = self.params.kick
        if self.state == "kicking":
            ball = self._kicking.kick.ball
        elif self.state == "watching" and view.stamp - self._entered < MIN_WATCH:
            ball = self._kick.ball
        else:
            return False
        return np.linalg.norm(ball - view.pose[:2]) < kick.robot_radius + kick.ball_radius + BALL_CONTACT

    def _bump(self, how: str, view: TaskView) -> None:
        self._bumps += 1
        if self._bumps > self.params.max_bumps:
            self._enter("failed", f"{how} {self._bumps} times", view)
            return
        mark_bump(self.params, view, self._sense)
        self._enter("recovering", how, view)

    def _check_stuck(self, view: TaskView, step: Step) -> bool:
        """Detect a robot that does not move although commanded, for robots without a bumper."""
        was_commanded = view.stamp - self._stepped < MAX_PAUSE
        self._stepped = view.stamp
        if step.command[0]:
            self._sense = math.copysign(1.0, step.command[0])
        is_commanded = abs(step.command[0]) > MIN_MOTION and self.state not in FINAL_STATES
        moved = np.linalg.norm(view.pose[:2] - self._moved_pose[:2])
        if not (is_commanded and was_commanded) or moved > MIN_MOTION * STUCK_TIME:
            self._moved_at, self._moved_pose = view.stamp, view.pose
        elif view.stamp - self._moved_at > STUCK_TIME:
            self._moved_at = view.stamp
            self._bump("stuck", view)
            return True
        return False

    def _search(self, view: TaskView) -> Step:
        if view.ball is not None and self.goal is not None:
            return Step(HALT, "approaching", "ball and goal are seen")
        return self._searching.step(view, "ball" if view.ball is None else "goal")

    def _approach(self, view: TaskView) -> Step:
        if view.ball is None or self.goal is None:
            return self._missing(view)
        if not view.ball.is_still and self.kicks:
            return Step(HALT, "watching", "the ball rolls")
        if self.kicks >= self.params.max_kicks:
            return Step(HALT, "failed", f"{self.kicks} kicks did not bring the ball through the goal")
        if view.stamp - self._planned > REPLAN:
            self._plan(view)
        if self._path is None:
            return Step(HALT, "blocked", "no path to the start of a kick")
        self._blocked = 0
        if np.linalg.norm(view.pose[:2] - self._kick.start) < self._arrived:
            return Step(HALT, "aligning", "behind the ball")
        return Step(follow(self.params.follower, view.pose, self._path), path=self._path)

    def _plan(self, view: TaskView) -> None:
        """Plan the kick and the path to its start."""
        self._planned, self._path = view.stamp, None
        about = [view.ball.position, *self.goal.posts]
        for clearance in (self.params.clearance, MIN_CLEARANCE, 0.0):
            floor = TaskPlanner(self.params, view, about, clearance)
            kick = floor.kick(self.goal, self._kick)
            if kick is not None:
                self._kick, self._path = kick, floor.path(kick.start)
                return

    def _missing(self, view: TaskView) -> Step:
        return Step(HALT, "searching", "the ball is lost" if view.ball is None else "there is no goal")

    def _align(self, view: TaskView) -> Step:
        if view.ball is None or self.goal is None:
            return self._missing(view)
        step = self._aligning.step(view, self.goal)
        self._kick = self._aligning.kick
        if step.next == "approaching":
            self._arrived, self._tries = max(MIN_ARRIVAL_RADIUS, 0.5 * self._arrived), self._tries + 1
            if self._tries >= MAX_TRIES:
                return Step(HALT, "failed", f"after {self._tries} tries: {step.reason}")
        return step

    def _kick_ball(self, view: TaskView) -> Step:
        step = self._kicking.step(view)
        self._kick = self._kicking.kick
        return step

    def _watch(self, view: TaskView) -> Step:
        """Watch until the ball rests."""
        since = view.stamp - self._entered
        if since < MIN_WATCH:
            return Step(HALT)
        if view.ball is None or since > MAX_WATCH:
            return Step(HALT, "searching", "the ball is out of sight")
        if view.ball.is_still and view.stamp - view.ball.stamp < 0.5:
            self._adapt_gain(view.ball)
            return Step(HALT, "approaching", "the ball lies short of the goal")
        bearing = bearing_of(view.pose, view.ball.position)
        is_out = abs(bearing) > OUT_OF_VIEW
        return Step((0.0, turn_on_the_spot(self.params.follower, bearing)) if is_out else HALT)

    def _adapt_gain(self, ball: SeenBall) -> None:
        """Adapt the kick's gain to the distance that the ball rolled on this floor."""
        if self._is_adapted:
            return
        self._is_adapted = True
        rolled = float((ball.position - self._kick.ball) @ self._kick.direction)
        kick = self.params.kick
        speed = kick.speed(self._kick.distance, self._gain)
        if rolled > 0.1 and kick.min_kick_speed < speed < kick.max_kick_speed:
            adapted = self._gain * min(max(math.sqrt(self._kick.distance / rolled), 0.7), 1.4)
            self._gain = min(max(adapted, MIN_GAIN), MAX_GAIN)

    def _stop(self, view: TaskView) -> Step:
        return self._stopping.step(view, self.goal)

    def _back_off(self, view: TaskView) -> Step:
        driven = np.linalg.norm(view.pose[:2] - self._bumped_at[:2])
        if driven > BACK_OFF or view.stamp - self._entered > 2.0 * BACK_OFF / BACK_SPEED:
            return Step(HALT, "stopping" if self._is_through else "searching", "backed off from the obstacle")
        return Step((self._back * BACK_SPEED, 0.0))

    def _retry(self, view: TaskView) -> Step:
        """No path: the map may be wrong or an obstacle may move; turn once, then retry."""
        if self._blocked >= MAX_BLOCKED:
            return Step(HALT, "failed", self.reason)
        if not self._turn.is_done(view.pose[2]):
            return Step((0.0, self.params.follower.search_turn_rate))
        self._blocked += 1
        return Step(HALT, "stopping" if self._is_through else "approaching", "retrying")


def _corrected(goal: Goal, blue: np.ndarray) -> Goal:
    """The goal with its posts moved to the nearest mapped pillars."""
    posts = goal.posts.copy()
    for i in range(2):
        if len(blue):
            off = np.linalg.norm(blue - posts[i], axis=1)
            if off.min() < MAX_POST_SHIFT * goal.width:
                posts[i] = blue[np.argmin(off)]
    return goal_between(posts[0], posts[1], posts.mean(axis=0) + goal.normal)
