# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Detection of the goal among the pillars of its colour."""

from itertools import combinations
from typing import NamedTuple, Optional

import numpy as np

MAX_WIDTH = 2.5  # metres between the posts
TOLERANCE = 0.06  # metres, error of the mapped posts
DUPLICATE_RADIUS = 0.15  # metres around a post in which another pillar is a duplicate in the map
BESIDE = 0.25  # metres that the ball may lie outside the posts


class Goal(NamedTuple):
    """The goal's posts and orientation."""

    posts: np.ndarray  # (2, 2) metres, map: left and right as seen from the ball
    normal: np.ndarray  # (2,) unit vector perpendicular to the goal line, toward the ball

    @property
    def middle(self) -> np.ndarray:
        """Midpoint of the goal line (2,), metres, map."""
        return self.posts.mean(axis=0)

    @property
    def width(self) -> float:
        """Distance between the posts' axes, metres."""
        return float(np.linalg.norm(self.posts[0] - self.posts[1]))

    def distance_before(self, point: np.ndarray) -> float:
        """Distance of a point in front of the goal line, metres; negative behind it."""
        return float((np.asarray(point) - self.middle) @ self.normal)

    def lateral_offset(self, point: np.ndarray) -> float:
        """Offset of a point to the left of the goal's axis, seen from the front, metres."""
        left = np.array([self.normal[1], -self.normal[0]])
        return float((np.asarray(point) - self.middle) @ left)


def goal_between(first: np.ndarray, second: np.ndarray, ball: np.ndarray) -> Goal:
    """The goal of two posts with the ball in front."""
    along = (second - first) / np.linalg.norm(second - first)
    normal = np.array([along[1], -along[0]])
    if (ball - first) @ normal < 0.0:
        return Goal(np.array([second, first]), -normal)
    return Goal(np.array([first, second]), normal)


def find_goal(pillars: np.ndarray, ball: np.ndarray, width: float) -> Optional[Goal]:
    """Find the nearest pair of pillars with the ball in front and no pillar of its colour in between.

    :param pillars: (n, 2) of the goal's colour, metres, map
    :param ball: (2,) metres, map
    :param width: minimum distance between the posts, metres
    """
    goals = []
    for i, j in combinations(range(len(pillars)), 2):
        if not width - TOLERANCE <= np.linalg.norm(pillars[i] - pillars[j]) <= MAX_WIDTH:
            continue
        goal, others = goal_between(pillars[i], pillars[j], ball), np.delete(pillars, [i, j], axis=0)
        if _is_in_front(goal, ball) and _is_open(goal, others):
            goals.append(goal)
    return min(goals, key=lambda goal: np.linalg.norm(goal.middle - ball), default=None)


def _is_in_front(goal: Goal, ball: np.ndarray) -> bool:
    return goal.distance_before(ball) > 0.0 and abs(goal.lateral_offset(ball)) <= 0.5 * goal.width + BESIDE


def _is_open(goal: Goal, others: np.ndarray) -> bool:
    """Whether no other pillar stands on or in front of the goal line: it would be a post of the goal."""
    return not any(
        goal.distance_before(each) > -TOLERANCE
        and abs(goal.lateral_offset(each)) < 0.5 * goal.width + TOLERANCE
        and np.linalg.norm(goal.posts - each, axis=1).min() > DUPLICATE_RADIUS
        for each in others
    )


def goes_through(goal: Goal, start: np.ndarray, end: np.ndarray) -> bool:
    """Whether a ball moving from start (2,) to end (2,) crosses the goal line from the front."""
    first, last = goal.distance_before(start), goal.distance_before(end)
    if not first > 0.0 >= last:
        return False
    crossing = start + (end - start) * first / (first - last)
    return abs(goal.lateral_offset(crossing)) < 0.5 * goal.width
