# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot that brings a ball through a goal and stops before it: what it does when (a state machine)."""

import math
from typing import Callable, Dict, Optional

import numpy as np

from sextant.ball.ball_floor import TIGHT, BallFloor, mark_bump
from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.goal import Goal, find_goal, goal_between, goes_through
from sextant.ball.kick_plan import Kick
from sextant.ball.path_follower import HALT, PathFollower, bearing_of
from sextant.ball.searching import FullTurn, Searching
from sextant.ball.shooting import Aligning, Kicking
from sextant.ball.stopping import Stopping
from sextant.ball.task_view import Action, SeenBall, Step, TaskView
from sextant.objects.object_kinds import GOAL

REPLAN = 0.5  # seconds
ARRIVED, CLOSEST = 0.05, 0.015  # metres; each time that was not near enough it is half as much
BEHIND = 0.02  # metres behind the goal's line from which on a ball is through
FRESH = 0.5  # seconds; where a ball went that was not seen for longer nobody knows
POST_MOVED = 0.4  # share of the goal's width that a post may be corrected by in one moment
WATCH, FIRST_WATCH = 8.0, 0.6  # seconds at most, and at least
OUT_OF_VIEW = 0.3  # radians
BACK_OFF, BACK_SPEED = 0.25, 0.15  # metres and m/s after a bump
STUCK, MOVING = 2.5, 0.05  # seconds and m/s: a robot that is told to drive and does not
PAUSE = 0.5  # seconds without a view, in which it was told nothing
LEAST_GAIN, MOST_GAIN = 0.5, 2.5  # what may be learnt of a floor
TOUCHES = 0.1  # metres beyond contact at which a ball may press the bumper
BLOCKED = 3  # times that no way was found, until it gives up
MOST_TRIES = 12  # to come to stand behind the ball, for one kick
ENDS = ("done", "failed")


class BallTask:
    """Told what is known, it says what to do."""

    def __init__(self, params: BallTaskParams):
        """:raises ValueError: a parameter out of range"""
        self.params, self._follower = params, PathFollower(params.follower)
        self._states: Dict[str, Callable[[TaskView], Step]] = {
            "searching": self._search,
            "approaching": self._approach,
            "aligning": self._align,
            "kicking": self._kick_ball,
            "watching": self._watch,
            "stopping": self._stop,
            "recovering": self._back_off,
            "blocked": self._look_again,
            "done": lambda view: Step(HALT),
            "failed": lambda view: Step(HALT),
        }
        self.start()

    def start(self) -> None:
        """From the beginning; nothing is known of ball and goal."""
        self.state, self.reason = "searching", "the task begins"
        self.kicks, self._bumps, self._blocked, self._tries = 0, 0, 0, 0
        self._begin = self._entered = math.nan
        self.goal: Optional[Goal] = None
        self._kick: Optional[Kick] = None
        self._gain, self._arrived = 1.0, ARRIVED
        self._before: Optional[np.ndarray] = None  # (2,) where the ball was seen last before the goal's line
        self._is_through, self._is_learned = False, True
        self._searching = Searching(self.params)
        self._path, self._planned = None, -math.inf
        self._moved_at, self._moved_pose, self._stepped = math.nan, np.zeros(3), math.nan
        self._sense = 1.0  # -1: it was told to go back

    def step(self, view: TaskView) -> Action:
        """What to do now. Call it often: with each odometry.

        :raises ValueError: a place in the view is not finite; nothing is changed by that
        """
        view.validate()
        if math.isnan(self._begin):
            self._begin = self._entered = self._moved_at = view.stamp
        self._see(view)
        self._guard(view)
        step = self._states[self.state](view)
        if step.next:
            self._enter(step.next, step.reason, view)
        is_stuck = self._notice_stuck(view, step)
        ended = self.state in ENDS
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
            self.kicks, self._tries, self._arrived, self._is_learned = self.kicks + 1, 0, ARRIVED, False
            self._kicking = Kicking(
                self.params, self._kick, self.params.kick.speed(self._kick.way, self._gain)
            )
        elif state == "stopping":
            self._stopping = Stopping(self.params)
        elif state == "blocked":
            self._turn = FullTurn()
        elif state == "recovering":
            self._bumped_at, self._back = view.pose.copy(), -self._sense

    def _see(self, view: TaskView) -> None:
        """The goal, and whether the ball went through it. It is chosen anew until the first kick begins, but
        kept if the ball comes to where it lies before none."""
        blue = np.array([each.position for each in view.pillars if each.class_name == GOAL]).reshape(-1, 2)
        found = None
        if view.ball is not None and not self.kicks:
            found = find_goal(blue, view.ball.position, self.params.goal_width)
        if found is not None:
            self.goal = found
        elif self.goal is not None:
            self.goal = _corrected(self.goal, blue)
        if self.goal is not None and self.kicks and view.ball is not None:
            self._follow_ball(self.goal, view.ball, view.stamp - view.ball.stamp)

    def _follow_ball(self, goal: Goal, seen: SeenBall, age: float) -> None:
        """It is through when it was seen surely behind the line: one that lies on it may seem to cross it.

        :param age: seconds since the picture that showed it last: it counts where it was then
        """
        if age > FRESH:
            return
        ball = seen.position - age * seen.velocity
        if goal.before(ball) > 0.0:
            self._before = ball
        elif goal.before(ball) < -BEHIND and self._before is not None:
            self._is_through |= goes_through(goal, self._before, ball)
            self._before = None

    def _guard(self, view: TaskView) -> None:
        """Ends and recoveries that may come at any time."""
        if self.state in ENDS:
            return
        if view.stamp - self._begin > self.params.time_limit:
            self._enter("failed", f"not done after {self.params.time_limit:g} s, last: {self.state}", view)
        elif view.is_bumped and self.state != "recovering" and not self._touches_ball(view):
            self._bump("bumped", view)
        elif self._is_through and self.state in ("searching", "approaching", "aligning", "watching"):
            self._enter("stopping", "the ball went through the goal", view)

    def _touches_ball(self, view: TaskView) -> bool:
        """Whether it is the ball that presses the bumper as it is kicked."""
        kick = self.params.kick
        if self.state == "kicking":
            ball = self._kicking.kick.ball
        elif self.state == "watching" and view.stamp - self._entered < FIRST_WATCH:
            ball = self._kick.ball
        else:
            return False
        return np.linalg.norm(ball - view.pose[:2]) < kick.robot_radius + kick.ball_radius + TOUCHES

    def _bump(self, how: str, view: TaskView) -> None:
        self._bumps += 1
        if self._bumps > self.params.most_bumps:
            self._enter("failed", f"{how} {self._bumps} times", view)
            return
        mark_bump(self.params, view, self._sense)
        self._enter("recovering", how, view)

    def _notice_stuck(self, view: TaskView, step: Step) -> bool:
        """A robot that has no bumper, too, notices that it does not move."""
        was_told = view.stamp - self._stepped < PAUSE
        self._stepped = view.stamp
        if step.command[0]:
            self._sense = math.copysign(1.0, step.command[0])
        is_told = abs(step.command[0]) > MOVING and self.state not in ENDS
        moved = np.linalg.norm(view.pose[:2] - self._moved_pose[:2])
        if not (is_told and was_told) or moved > MOVING * STUCK:
            self._moved_at, self._moved_pose = view.stamp, view.pose
        elif view.stamp - self._moved_at > STUCK:
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
            return self._lack(view)
        if not view.ball.is_still and self.kicks:
            return Step(HALT, "watching", "the ball rolls")
        if self.kicks >= self.params.most_kicks:
            return Step(HALT, "failed", f"{self.kicks} kicks did not bring the ball through the goal")
        if view.stamp - self._planned > REPLAN:
            self._plan(view)
        if self._path is None:
            return Step(HALT, "blocked", "there is no way to where a kick is possible")
        self._blocked = 0
        if np.linalg.norm(view.pose[:2] - self._kick.start) < self._arrived:
            return Step(HALT, "aligning", "behind the ball")
        return Step(self._follower.follow(view.pose, self._path), path=self._path)

    def _plan(self, view: TaskView) -> None:
        """The kick, and the way to where it begins."""
        self._planned, self._path = view.stamp, None
        about = [view.ball.position, *self.goal.posts]
        for clearance in (self.params.clearance, TIGHT, 0.0):
            floor = BallFloor(self.params, view, about, clearance)
            kick = floor.kick(self.goal, self._kick)
            if kick is not None:
                self._kick, self._path = kick, floor.path(kick.start)
                return

    def _lack(self, view: TaskView) -> Step:
        return Step(HALT, "searching", "the ball is lost" if view.ball is None else "there is no goal")

    def _align(self, view: TaskView) -> Step:
        if view.ball is None or self.goal is None:
            return self._lack(view)
        step = self._aligning.step(view, self.goal)
        self._kick = self._aligning.kick
        if step.next == "approaching":
            self._arrived, self._tries = max(CLOSEST, 0.5 * self._arrived), self._tries + 1
            if self._tries >= MOST_TRIES:
                return Step(HALT, "failed", f"after {self._tries} tries: {step.reason}")
        return step

    def _kick_ball(self, view: TaskView) -> Step:
        step = self._kicking.step(view)
        self._kick = self._kicking.kick
        return step

    def _watch(self, view: TaskView) -> Step:
        """Until the ball lies."""
        since = view.stamp - self._entered
        if since < FIRST_WATCH:
            return Step(HALT)
        if view.ball is None or since > WATCH:
            return Step(HALT, "searching", "the ball is out of sight")
        if view.ball.is_still and view.stamp - view.ball.stamp < 0.5:
            self._learn(view.ball)
            return Step(HALT, "approaching", "the ball lies short of the goal")
        bearing = bearing_of(view.pose, view.ball.position)
        return Step((0.0, self._follower.turn(bearing)) if abs(bearing) > OUT_OF_VIEW else HALT)

    def _learn(self, ball: SeenBall) -> None:
        """How much harder this floor's balls want to be kicked."""
        if self._is_learned:
            return
        self._is_learned = True
        rolled = float((ball.position - self._kick.ball) @ self._kick.direction)
        kick = self.params.kick
        speed = kick.speed(self._kick.way, self._gain)
        if rolled > 0.1 and kick.least_speed < speed < kick.most_speed:
            learnt = self._gain * min(max(math.sqrt(self._kick.way / rolled), 0.7), 1.4)
            self._gain = min(max(learnt, LEAST_GAIN), MOST_GAIN)

    def _stop(self, view: TaskView) -> Step:
        return self._stopping.step(view, self.goal)

    def _back_off(self, view: TaskView) -> Step:
        gone = np.linalg.norm(view.pose[:2] - self._bumped_at[:2])
        if gone > BACK_OFF or view.stamp - self._entered > 2.0 * BACK_OFF / BACK_SPEED:
            return Step(
                HALT, "stopping" if self._is_through else "searching", "away from what was bumped into"
            )
        return Step((self._back * BACK_SPEED, 0.0))

    def _look_again(self, view: TaskView) -> Step:
        """No way: the map may be wrong, or somebody may go out of it; looks around, and tries again."""
        if self._blocked >= BLOCKED:
            return Step(HALT, "failed", self.reason)
        if not self._turn.is_done(view.pose[2]):
            return Step((0.0, self.params.follower.search_rate))
        self._blocked += 1
        return Step(HALT, "stopping" if self._is_through else "approaching", "tries once more")


def _corrected(goal: Goal, blue: np.ndarray) -> Goal:
    """With its posts where they are seen now."""
    posts = goal.posts.copy()
    for i in range(2):
        if len(blue):
            off = np.linalg.norm(blue - posts[i], axis=1)
            if off.min() < POST_MOVED * goal.width:
                posts[i] = blue[np.argmin(off)]
    return goal_between(posts[0], posts[1], posts.mean(axis=0) + goal.out)
