# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
from std_msgs.msg import Header
from visualization_msgs.msg import Marker

from sextant.ball.floor_grid import FloorGrid, FloorGridParams
from sextant.ball.goal import goal_between
from sextant.ball.kick_plan import Kick
from sextant.ball.task_view import Action, SeenBall, TaskView
from sextant.nodes.ball.ball_task_messages import floor_message, path_message, task_markers

HEADER = Header(frame_id="map")


def cell_of(message, x, y):
    """Position of a cell by the definition of nav_msgs/OccupancyGrid."""
    origin, info = message.info.origin.position, message.info
    column, row = int((x - origin.x) / info.resolution), int((y - origin.y) / info.resolution)
    return message.data[row * info.width + column]


def test_the_floor_has_its_places_where_they_are():
    grid = FloorGrid(FloorGridParams())
    floor = np.array([[1.0, 0.4, 0.0]])
    pole = np.array([[1.5, -0.7, height] for height in (0.2, 0.3, 0.4)])
    for _ in range(3):
        grid.update(np.vstack([floor, pole]), np.zeros(3))
    message = floor_message(grid, np.zeros(2), HEADER)
    assert len(message.data) == message.info.width * message.info.height
    assert message.info.width != message.info.height  # else rows and columns could be swapped
    assert (cell_of(message, 1.01, 0.41), cell_of(message, 1.51, -0.69)) == (0, 100)
    assert (cell_of(message, 0.0, 0.0), cell_of(message, 0.4, 1.0)) == (-1, -1)
    assert (np.array(message.data) == 100).sum() == (np.array(message.data) == 0).sum() == 1


def test_a_path():
    message = path_message(np.array([[1.0, 2.0], [3.0, 4.0]]), HEADER)
    assert [(each.pose.position.x, each.pose.position.y) for each in message.poses] == [(1, 2), (3, 4)]
    assert message.poses[0].header.frame_id == "map" and message.poses[0].pose.orientation.w == 1.0


def drawn(goal=None, kick=None, ball=None):
    action = Action((0.0, 0.0), "aligning", "behind the ball", np.zeros((0, 2)), goal, kick, 0, False)
    view = TaskView(1.0, np.array([0.5, 0.25, 1.0]), [], ball, False, None)
    markers = task_markers(action, view, 0.177, 0.05, HEADER).markers
    assert markers[0].action == Marker.DELETEALL
    names = [each.ns for each in markers[1:]]
    assert len(set(names)) == len(names)
    return {each.ns: each for each in markers[1:]}


def test_what_is_not_known_is_not_drawn():
    markers = drawn()
    assert set(markers) == {"state", "robot"}
    assert markers["state"].text == "aligning\nbehind the ball"
    assert (markers["state"].pose.position.x, markers["state"].pose.position.y) == (0.5, 0.25)


def test_goal_kick_and_ball_are_where_they_are():
    posts, ball = np.array([[2.0, 1.0], [2.0, 0.0]]), np.array([1.0, 0.5])
    kick = Kick(ball, np.array([2.0, 0.5]), np.array([0.4, 0.5]), 1.4, 0.1, True)
    markers = drawn(goal_between(*posts, ball), kick, SeenBall(ball, np.zeros(2), 1.0))
    assert {(each.x, each.y) for each in markers["goal"].points} == {(2.0, 1.0), (2.0, 0.0)}
    assert [(each.x, each.y) for each in markers["kick"].points] == [(1.0, 0.5), (2.4, 0.5)]
    ring = np.array([[each.x, each.y] for each in markers["run-up place"].points])
    np.testing.assert_allclose(np.linalg.norm(ring - kick.start, axis=1), 0.177)
    assert (markers["ball"].pose.position.x, markers["ball"].scale.z) == (1.0, 0.1)
