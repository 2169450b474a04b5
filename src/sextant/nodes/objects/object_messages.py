# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Conversion of detections and located objects to messages."""

from typing import List, NamedTuple, Sequence, Tuple

import numpy as np
from geometry_msgs.msg import Point, Vector3
from nav_msgs.msg import Odometry
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker

from sextant.landmarks.landmark_colours import colour_of_class
from sextant.msg import LandmarkObservation, LandmarkObservations, ObjectBox, Objects
from sextant.objects.ball_tracker import BallEstimate
from sextant.objects.detections import Detections
from sextant.objects.object_kinds import ObjectKind
from sextant.objects.object_locator import LocatedObject

YELLOW = ColorRGBA(1.0, 0.8, 0.1, 1.0)
HEIGHT = 0.4  # of a drawn pillar, metres
PREDICTED = 0.5  # seconds of the ball's motion that are drawn
UNKNOWN_VARIANCE = 1e-6  # of what is not estimated: filters reject a variance of zero


class SeenObject(NamedTuple):
    """A located object in the robot frame."""

    class_name: str  # of the detector
    kind: ObjectKind  # shape and size
    place: LocatedObject  # position and covariance


def objects_message(
    found: Detections, classes: Sequence[str], size: Tuple[int, int], header: Header
) -> Objects:
    """Convert detections. :param classes: names by index. :param size: width and height, pixels"""
    boxes = [ObjectBox(classes[number], float(score), *map(float, box)) for box, score, number in zip(*found)]
    return Objects(header, *size, boxes)


def observations_message(seen: List[SeenObject], header: Header) -> LandmarkObservations:
    """Convert the pillars among located objects. :param header: with the robot frame"""
    return LandmarkObservations(header, [_observation(each) for each in seen if each.kind.shape == "pillar"])


def _observation(seen: SeenObject) -> LandmarkObservation:
    covariance = np.zeros((3, 3))
    covariance[:2, :2] = seen.place.covariance
    x, y = seen.place.position
    return LandmarkObservation(seen.class_name, -1, x, y, np.nan, list(np.ravel(covariance)))


def ball_message(ball: BallEstimate, radius: float, header: Header) -> Odometry:
    """Convert a ball; its frame has the axes of odometry. :param header: with the odometry frame"""
    message = Odometry(header=header, child_frame_id="ball")
    message.pose.pose.position = Point(*ball.position, radius)
    message.pose.pose.orientation.w = 1.0
    message.twist.twist.linear = Vector3(*ball.velocity, 0.0)
    for part, covariance in (
        (message.pose, ball.covariance[:2, :2]),
        (message.twist, ball.covariance[2:, 2:]),
    ):
        whole = UNKNOWN_VARIANCE * np.eye(6)
        whole[:2, :2] = covariance
        part.covariance = list(np.ravel(whole))
    return message


def seen_markers(seen: List[SeenObject], header: Header) -> List[Marker]:
    """Markers of the located objects; the first one deletes earlier markers."""
    markers = [Marker(header=header, ns="seen", action=Marker.DELETEALL)]
    for number, each in enumerate(seen):
        is_ball, radius = each.kind.shape == "ball", each.kind.radius
        height = 2.0 * radius if is_ball else HEIGHT
        marker = Marker(
            header=header, ns="seen", id=number, type=Marker.SPHERE if is_ball else Marker.CYLINDER
        )
        marker.pose.position = Point(*each.place.position, 0.5 * height)
        marker.pose.orientation.w = 1.0
        marker.scale = Vector3(2.0 * radius, 2.0 * radius, height)
        marker.color = YELLOW if is_ball else ColorRGBA(*colour_of_class(each.class_name), 1.0)
        markers.append(marker)
    return markers


def ball_markers(ball: BallEstimate, radius: float, header: Header) -> List[Marker]:
    """A sphere at the ball's position and an arrow along its predicted motion."""
    here = Point(*ball.position, radius)
    sphere = Marker(header=header, ns="ball", id=0, type=Marker.SPHERE, color=YELLOW)
    sphere.pose.position, sphere.pose.orientation.w = here, 1.0
    sphere.scale = Vector3(2.0 * radius, 2.0 * radius, 2.0 * radius)
    arrow = Marker(header=header, ns="ball", id=1, type=Marker.ARROW, color=YELLOW)
    arrow.pose.orientation.w = 1.0
    arrow.points = [here, Point(*(ball.position + PREDICTED * ball.velocity), radius)]
    arrow.scale = Vector3(0.02, 0.05, 0.05)
    return [sphere, arrow]
