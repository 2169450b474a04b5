# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Objects on the floor, as messages."""

from typing import List, NamedTuple, Sequence, Tuple

import numpy as np
from geometry_msgs.msg import Point, Vector3
from nav_msgs.msg import Odometry
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker

from sextant.landmarks.landmark_colours import colour_of_class
from sextant.msg import LandmarkSighting, LandmarkSightings, ObjectBox, Objects
from sextant.objects.ball_tracker import BallEstimate
from sextant.objects.detection import Detections, names_of
from sextant.objects.object_kinds import ObjectKind
from sextant.objects.object_locator import LocatedObject

YELLOW = ColorRGBA(1.0, 0.8, 0.1, 1.0)
HEIGHT = 0.4  # of a pillar that is drawn, metres
LOOK_AHEAD = 0.5  # seconds of the ball's way that are drawn
UNKNOWN = 1e-6  # variance of what is not estimated: filters take no zero


class SeenObject(NamedTuple):
    """An object in the robot frame."""

    class_name: str
    kind: ObjectKind
    place: LocatedObject


def objects_message(
    found: Detections, classes: Sequence[str], size: Tuple[int, int], header: Header
) -> Objects:
    """Of what was found in a picture. :param classes: names. :param size: its width and height, pixels"""
    boxes = [
        ObjectBox(name, float(score), *map(float, box))
        for name, score, box in zip(names_of(found.classes, classes), found.scores, found.boxes)
    ]
    return Objects(header, *size, boxes)


def sightings_message(seen: List[SeenObject], header: Header) -> LandmarkSightings:
    """Of the pillars. :param header: of the robot frame"""
    return LandmarkSightings(header, [_sighting(each) for each in seen if each.kind.shape == "pillar"])


def _sighting(seen: SeenObject) -> LandmarkSighting:
    covariance = np.zeros((3, 3))
    covariance[:2, :2] = seen.place.covariance
    x, y = seen.place.position
    return LandmarkSighting(seen.class_name, -1, x, y, np.nan, list(np.ravel(covariance)))


def ball_message(ball: BallEstimate, radius: float, header: Header) -> Odometry:
    """The ball's frame is not turned. :param header: of odometry's frame"""
    message = Odometry(header=header, child_frame_id="ball")
    message.pose.pose.position = Point(*ball.position, radius)
    message.pose.pose.orientation.w = 1.0
    message.twist.twist.linear = Vector3(*ball.velocity, 0.0)
    for part, covariance in (
        (message.pose, ball.covariance[:2, :2]),
        (message.twist, ball.covariance[2:, 2:]),
    ):
        whole = UNKNOWN * np.eye(6)
        whole[:2, :2] = covariance
        part.covariance = list(np.ravel(whole))
    return message


def seen_markers(seen: List[SeenObject], header: Header) -> List[Marker]:
    """What was seen, in place of what was seen before."""
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
    """Where it is, and an arrow along its way."""
    here = Point(*ball.position, radius)
    sphere = Marker(header=header, ns="ball", id=0, type=Marker.SPHERE, color=YELLOW)
    sphere.pose.position, sphere.pose.orientation.w = here, 1.0
    sphere.scale = Vector3(2.0 * radius, 2.0 * radius, 2.0 * radius)
    arrow = Marker(header=header, ns="ball", id=1, type=Marker.ARROW, color=YELLOW)
    arrow.pose.orientation.w = 1.0
    arrow.points = [here, Point(*(ball.position + LOOK_AHEAD * ball.velocity), radius)]
    arrow.scale = Vector3(0.02, 0.05, 0.05)
    return [sphere, arrow]
