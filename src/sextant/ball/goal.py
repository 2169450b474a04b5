# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the goal is among the pillars of its colour."""

from itertools import combinations
from typing import NamedTuple, Optional

import numpy as np

WIDEST = 2.5  # metres; pillars farther from one another are no goal
TOLERANCE = 0.06  # metres that a goal may seem narrower than it is
DOUBLE = 0.15  # metres about a post in which another one is the same, which a map holds twice
BESIDE = 0.25  # metres that a ball which belongs to a goal may lie outside of its posts


class Goal(NamedTuple):
    """Two posts, as seen from the ball."""

    posts: np.ndarray  # (2, 2) metres, map: left and right as seen from the ball
    out: np.ndarray  # (2,) unit vector across the goal's line toward the ball

    @property
    def middle(self) -> np.ndarray:
        """(2,) metres, map"""
        return self.posts.mean(axis=0)

    @property
    def width(self) -> float:
        """Metres from post to post, axes."""
        return float(np.linalg.norm(self.posts[0] - self.posts[1]))

    def before(self, point: np.ndarray) -> float:
        """Metres that a point is before the goal's line; behind it less than 0."""
        return float((np.asarray(point) - self.middle) @ self.out)

    def aside(self, point: np.ndarray) -> float:
        """Metres that a point is to the left of the goal's axis, as seen from before it."""
        left = np.array([self.out[1], -self.out[0]])
        return float((np.asarray(point) - self.middle) @ left)


def goal_between(first: np.ndarray, second: np.ndarray, ball: np.ndarray) -> Goal:
    """Of two posts, as seen from the ball."""
    along = (second - first) / np.linalg.norm(second - first)
    out = np.array([along[1], -along[0]])
    if (ball - first) @ out < 0.0:
        return Goal(np.array([second, first]), -out)
    return Goal(np.array([first, second]), out)


def find_goal(pillars: np.ndarray, ball: np.ndarray, width: float) -> Optional[Goal]:
    """The nearest pair with nothing of its colour between, before which the ball lies.

    :param pillars: (n, 2) of the goal's colour, metres, map
    :param ball: (2,)
    :param width: that two of them have at least, metres
    """
    goals = []
    for i, j in combinations(range(len(pillars)), 2):
        if not width - TOLERANCE <= np.linalg.norm(pillars[i] - pillars[j]) <= WIDEST:
            continue
        goal, others = goal_between(pillars[i], pillars[j], ball), np.delete(pillars, [i, j], axis=0)
        if _is_before(goal, ball) and _is_open(goal, others):
            goals.append(goal)
    return min(goals, key=lambda goal: np.linalg.norm(goal.middle - ball), default=None)


def _is_before(goal: Goal, ball: np.ndarray) -> bool:
    return goal.before(ball) > 0.0 and abs(goal.aside(ball)) <= 0.5 * goal.width + BESIDE


def _is_open(goal: Goal, others: np.ndarray) -> bool:
    """Whether no other pillar stands on its line or before it: that one would be a post of the goal."""
    return not any(
        goal.before(each) > -TOLERANCE
        and abs(goal.aside(each)) < 0.5 * goal.width + TOLERANCE
        and np.linalg.norm(goal.posts - each, axis=1).min() > DOUBLE
        for each in others
    )


def goes_through(goal: Goal, before: np.ndarray, now: np.ndarray) -> bool:
    """Whether something came from before the line to behind it, between the posts, (2,) and (2,) metres."""
    first, last = goal.before(before), goal.before(now)
    if not first > 0.0 >= last:
        return False
    crossing = before + (now - before) * first / (first - last)
    return abs(goal.aside(crossing)) < 0.5 * goal.width
