# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Conversion of the simulated ball task to messages; the map's origin is the robot's initial pose."""

import sys
from typing import List

import numpy as np
from geometry_msgs.msg import Point
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Image
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

import sextant
from sextant.geometry.plane_poses import in_frame, relative
from sextant.msg import ObjectBox, Objects
from sextant.objects.object_kinds import BALL
from sextant.simulation.arena_looks import COLOURS
from sextant.simulation.ball_ground import BallGround
from sextant.simulation.ball_simulation import HEIGHT
from sextant.simulation.ball_world import BallWorld
from sextant.simulation.motion import Motion

WHITE = ColorRGBA(1.0, 1.0, 1.0, 1.0)
LINE = 0.02  # metres, width of the goal's line


def depth_to_message(depth: np.ndarray, encoding: str, header: Header) -> Image:
    """Convert a depth image (REP 118): 16UC1 in millimetres, 0: no depth; 32FC1 in metres, NaN: no depth.

    :param depth: float32 (height, width), metres, 0: no depth
    """
    if encoding == "16UC1":
        pixels = np.clip(np.rint(1000.0 * depth), 0, 65535).astype(np.uint16)
    else:
        pixels = np.where(depth > 0.0, depth, np.float32(np.nan))
    height, width = depth.shape
    step = width * pixels.itemsize
    return Image(header, height, width, encoding, sys.byteorder == "big", step, pixels.tobytes())


def seen_to_message(
    seen: List["sextant.VisibleObject"], class_names: List[str], size: List[int], header: Header
) -> Objects:
    """Convert the true boxes of an image.

    :param class_names: by object index. :param size: width and height, pixels
    """
    boxes = [ObjectBox(class_names[each.object], 1.0, *map(float, [*each.low, *each.high])) for each in seen]
    return Objects(header, *size, boxes)


def robot_motion(ground: BallGround, start: np.ndarray) -> Motion:
    """Motion of the robot in the map. :param start: (3,) its initial pose in the world"""
    robot = ground.robot
    x, y, yaw = relative(start, np.array([robot.x, robot.y, robot.yaw]))
    return Motion(x, y, 0.0, yaw, robot.speed, robot.turn_rate)


def ball_to_message(ground: BallGround, start: np.ndarray, header: Header) -> Odometry:
    """Position and velocity of the ball along the map's axes. :param start: as robot_motion()"""
    message = Odometry(header=header, child_frame_id=BALL)
    at, speed = message.pose.pose.position, message.twist.twist.linear
    at.x, at.y = in_frame(start, ground.ball)
    at.z, message.pose.pose.orientation.w = ground.ball_params.radius, 1.0
    speed.x, speed.y = in_frame(np.array([0.0, 0.0, start[2]]), ground.ball_velocity)
    return message


def world_to_visualization(world: BallWorld, ground: BallGround, header: Header) -> MarkerArray:
    """Markers of pillars, ball and goal line; the first one deletes earlier markers."""
    places = in_frame(world.robot, np.array([[pillar.x, pillar.y] for pillar in world.pillars]))
    drawn = [Marker(header=header, action=Marker.DELETEALL)]
    for number, (pillar, (x, y)) in enumerate(zip(world.pillars, places)):
        size = (2.0 * pillar.radius, 2.0 * pillar.radius, HEIGHT)
        drawn.append(_shape(header, "pillars", number, Marker.CYLINDER, size, pillar.class_name))
        drawn[-1].pose.position = Point(x, y, 0.5 * HEIGHT)
    radius = ground.ball_params.radius
    drawn.append(_shape(header, "ball", 0, Marker.SPHERE, 3 * [2.0 * radius], BALL))
    drawn[-1].pose.position = Point(*in_frame(world.robot, ground.ball), radius)
    drawn.append(_shape(header, "goal", 0, Marker.LINE_STRIP, (LINE, 0.0, 0.0), ""))
    drawn[-1].points = [Point(x, y, 0.5 * LINE) for x, y in places[:2]]
    return MarkerArray(drawn)


def _shape(header: Header, namespace: str, number: int, kind: int, size, class_name: str) -> Marker:
    marker = Marker(header=header, ns=namespace, id=number, type=kind, color=WHITE)
    if class_name:
        brightest = max(COLOURS[class_name])  # rviz applies the light
        marker.color = ColorRGBA(*(share / brightest for share in COLOURS[class_name]), 1.0)
    marker.pose.orientation.w = 1.0
    marker.scale.x, marker.scale.y, marker.scale.z = size
    return marker
