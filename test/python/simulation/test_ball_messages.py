# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The world of the ball task as messages: depth images of REP 118, a map that begins where the robot does."""

import numpy as np
import pytest
from std_msgs.msg import Header

from sextant.nodes.simulation.ball_messages import (
    ball_to_message,
    depth_to_message,
    robot_motion,
    world_to_visualization,
)
from sextant.objects.depth_encodings import metres_of
from sextant.simulation.ball_ground import BallGround
from sextant.simulation.ball_world import random_world

DEPTH = np.array([[0.0, 0.3, 1.2344], [9.99, 70.0, 0.0]], np.float32)


@pytest.mark.parametrize("encoding, kind, most", [("16UC1", np.uint16, 65.535), ("32FC1", np.float32, 70.0)])
def test_depth_images_come_back_to_the_millimetre(encoding, kind, most):
    message = depth_to_message(DEPTH, encoding, Header())
    pixels = np.frombuffer(message.data, kind).reshape(message.height, message.width)
    assert (message.encoding, message.step) == (encoding, 3 * np.dtype(kind).itemsize)
    np.testing.assert_allclose(metres_of(pixels), np.minimum(DEPTH, most), atol=0.5e-3)
    no_depth = np.isnan(pixels) if encoding == "32FC1" else pixels == 0
    np.testing.assert_array_equal(no_depth, DEPTH == 0.0)


def test_places_and_speeds_are_seen_from_where_the_robot_began():
    """It began at (1, 2), looking along y: what lies at (1, 5) is 3 m ahead."""
    start = np.array([1.0, 2.0, 0.5 * np.pi])
    ground = BallGround((20.0, 20.0), [], (1.0, 5.0), start)
    ground.ball_velocity = np.array([-0.4, 0.3])
    message = ball_to_message(ground, start, Header())
    at, speed = message.pose.pose.position, message.twist.twist.linear
    np.testing.assert_allclose([at.x, at.y, at.z, speed.x, speed.y], [3.0, 0.0, 0.05, 0.3, 0.4], atol=1e-12)
    assert robot_motion(ground, start).pose == pytest.approx(np.eye(4))


def test_everything_is_drawn_in_its_colour():
    world = random_world(3, 1)
    ground = BallGround(world.size, world.pillars, world.ball, world.robot)
    _, *shapes = world_to_visualization(world, ground, Header()).markers
    assert len(shapes) == len(world.pillars) + 2
    for pillar, shape in zip(world.pillars, shapes):
        rgb = [shape.color.r, shape.color.g, shape.color.b]
        assert np.argmax(rgb) == ["red_pillar", "green_pillar", "blue_pillar"].index(pillar.class_name)
        assert max(rgb) == 1.0 and shape.color.a == 1.0
    assert len({(shape.ns, shape.id) for shape in shapes}) == len(shapes)
