# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Conversion of path, floor and plan to messages in the map frame."""

from typing import List, Sequence

import numpy as np
from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion, Vector3
from nav_msgs.msg import OccupancyGrid, Path
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

from sextant.ball.floor_grid import FloorGrid, known_box
from sextant.ball.goal import Goal
from sextant.ball.kick_plan import Kick
from sextant.ball.task_view import Action, TaskView
from sextant.landmarks.landmark_colours import NAMED

YELLOW, WHITE = ColorRGBA(*NAMED["yellow"], 1.0), ColorRGBA(1.0, 1.0, 1.0, 1.0)
GREEN, ORANGE = ColorRGBA(0.3, 0.9, 0.4, 1.0), ColorRGBA(*NAMED["orange"], 1.0)
ABOVE, LETTERS = 0.65, 0.14  # metres: height of the text above the floor, and of its letters
LINE = 0.02  # metres, width of lines
RING, RING_CORNERS = 0.012, 40  # metres, width of a ring's line; number of its corners
MARGIN = 1.0  # metres around the robot that are always published
OCCUPIED, FREE, UNSEEN = 100, 0, -1  # values of nav_msgs/OccupancyGrid


def path_message(path: np.ndarray, header: Header) -> Path:
    """Convert a path. :param path: (n, 2) metres"""
    upright = Quaternion(0.0, 0.0, 0.0, 1.0)
    return Path(header, [PoseStamped(header, Pose(Point(x, y, 0.0), upright)) for x, y in path])


def floor_message(grid: FloorGrid, robot: np.ndarray, header: Header) -> OccupancyGrid:
    """Convert the known part of the grid. :param robot: (2,) position that the part includes"""
    box = known_box(grid, robot[np.newaxis], MARGIN)
    cells = np.where(grid.seen[box], FREE, UNSEEN)
    cells[grid.occupied[box]] = OCCUPIED
    message = OccupancyGrid(header=header, data=cells.T.ravel().tolist())  # along x first
    info, half = message.info, 0.5 * grid.params.resolution
    info.map_load_time, info.resolution = header.stamp, grid.params.resolution
    info.width, info.height = cells.shape
    x, y = grid.centers(np.array([part.start for part in box])) - half
    info.origin = Pose(Point(x, y, 0.0), Quaternion(0.0, 0.0, 0.0, 1.0))
    return message


def task_markers(
    action: Action, view: TaskView, robot_radius: float, ball_radius: float, header: Header
) -> MarkerArray:
    """Markers of state, goal, kick, robot and ball; the first one deletes earlier markers."""
    x, y, _ = view.pose
    text = _marker(header, "state", Marker.TEXT_VIEW_FACING, (0.0, 0.0, LETTERS), WHITE)
    text.pose.position, text.text = Point(x, y, ABOVE), f"{action.state}\n{action.reason}"
    drawn = [Marker(header=header, action=Marker.DELETEALL), text]
    drawn.append(_ring(header, "robot", view.pose[:2], robot_radius, WHITE))
    if action.goal is not None:
        drawn += _goal_markers(action.goal, header)
    if action.kick is not None:
        drawn += _kick_markers(action.kick, robot_radius, header)
    if view.ball is not None:
        drawn.append(_marker(header, "ball", Marker.SPHERE, [2.0 * ball_radius] * 3, YELLOW))
        drawn[-1].pose.position = Point(*view.ball.position, ball_radius)
    return MarkerArray(drawn)


def _goal_markers(goal: Goal, header: Header) -> List[Marker]:
    line = _marker(header, "goal", Marker.LINE_STRIP, (LINE, 0.0, 0.0), GREEN)
    line.points = [Point(*post, LINE) for post in goal.posts]
    return [line, *(_ring(header, f"post {i}", post, 0.1, GREEN) for i, post in enumerate(goal.posts))]


def _kick_markers(kick: Kick, robot_radius: float, header: Header) -> List[Marker]:
    """The run-up, and an arrow as long as the ball is planned to roll."""
    arrow = _marker(header, "kick", Marker.ARROW, (0.02, 0.06, 0.08), ORANGE)
    end = kick.ball + kick.distance * kick.direction
    arrow.points = [Point(*kick.ball, LINE), Point(*end, LINE)]
    run_up = _marker(header, "run-up", Marker.LINE_STRIP, (0.5 * LINE, 0.0, 0.0), ORANGE)
    run_up.points = [Point(*kick.start, LINE), Point(*kick.ball, LINE)]
    return [arrow, run_up, _ring(header, "run-up place", kick.start, robot_radius, ORANGE)]


def _ring(header: Header, namespace: str, middle: np.ndarray, radius: float, colour: ColorRGBA) -> Marker:
    ring = _marker(header, namespace, Marker.LINE_STRIP, (RING, 0.0, 0.0), colour)
    x, y = middle
    turns = np.linspace(0.0, 2.0 * np.pi, RING_CORNERS + 1)
    ring.points = [Point(x + radius * np.cos(turn), y + radius * np.sin(turn), LINE) for turn in turns]
    return ring


def _marker(header: Header, namespace: str, kind: int, scale: Sequence[float], colour: ColorRGBA) -> Marker:
    marker = Marker(header=header, ns=namespace, type=kind, color=colour, scale=Vector3(*scale))
    marker.pose.orientation.w = 1.0
    return marker
