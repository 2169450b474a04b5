# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Detections published by apriltag_ros, aruco_ros and fiducials, as corners in the image.

Where only a pose is published, the corners are those that it projects to: the pose was fitted to four
corners, so they are the same but for the fit's residual. Conventions of the packages:
doc/how_to/migrating.md.
"""

from typing import Any, Callable, Dict, Iterator, NamedTuple, Tuple

import numpy as np

import sextant
from sextant.geometry.poses import pose_of_fields
from sextant.messages.damaged_message import DamagedMessage

HALF_TURN = np.diag([-1.0, -1.0, 1.0])  # the dictionaries DICT_APRILTAG_* of OpenCV, in fiducials
AXES = {  # rotation from Sextant's marker frame to theirs
    "as_sextant": np.eye(3),
    "aruco_library_1": np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]),
    "aruco_library_1_not_rotated": np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
}
APRILTAG_PIXEL = 0.5  # libapriltag's origin is the corner of the first pixel


class ForeignMarker(NamedTuple):
    """A marker that another package has detected."""

    id: int  # in its family
    corners: np.ndarray  # (4, 2) pixels, in Sextant's order and with its origin
    from_pose: bool  # the corners were computed from the pose


class Convention(NamedTuple):
    """How to read the messages of a type."""

    read: Callable[..., Iterator[ForeignMarker]]  # (message, projection)
    rectified: bool  # the image that is searched by default


class Projection(NamedTuple):
    """What is needed to compute corners from a pose."""

    camera: sextant.CameraModel  # of the image that the detector searches
    family: str  # canonical
    size_of: Callable[[int], float]  # edge length by id, metres; for messages without a size
    axes: np.ndarray  # (3, 3) one of AXES

    def corners(self, position: Any, orientation: Any, size: float, axes: np.ndarray) -> np.ndarray:
        """Corners (4, 2) of a marker with a pose in the optical frame; NaN if a corner has no projection.

        :param axes: (3, 3) rotation from Sextant's marker frame to that of the pose
        """
        try:
            T_camera_marker = pose_of_fields(position, orientation)
        except ValueError:
            return np.full((4, 2), np.nan)
        points = sextant.marker_corners(size) @ (T_camera_marker[:3, :3] @ axes).T + T_camera_marker[:3, 3]
        return self.camera.project_points(points)


def _apriltags(message: Any, projection: Projection) -> Iterator[ForeignMarker]:
    single = [detection for detection in message.detections if len(detection.id) == 1]
    if message.detections and not single:  # a bundle has one pose of several tags
        raise DamagedMessage("only bundles: list their tags in standalone_tags of apriltag_ros, too")
    for detection in single:
        pose = detection.pose.pose.pose
        corners = projection.corners(pose.position, pose.orientation, detection.size[0], projection.axes)
        yield ForeignMarker(detection.id[0], corners - APRILTAG_PIXEL, True)


def _aruco_markers(message: Any, projection: Projection) -> Iterator[ForeignMarker]:
    for marker in message.markers:
        pose = marker.pose.pose
        size = projection.size_of(marker.id)
        yield ForeignMarker(
            marker.id, projection.corners(pose.position, pose.orientation, size, projection.axes), True
        )


def _fiducial_vertices(message: Any, projection: Projection) -> Iterator[ForeignMarker]:
    first = 2 if _is_turned(projection) else 0
    for each in message.fiducials:
        corners = np.array([each.x0, each.y0, each.x1, each.y1, each.x2, each.y2, each.x3, each.y3])
        yield ForeignMarker(each.fiducial_id, np.roll(corners.reshape(4, 2), first, axis=0), False)


def _fiducial_transforms(message: Any, projection: Projection) -> Iterator[ForeignMarker]:
    axes = projection.axes @ (HALF_TURN if _is_turned(projection) else np.eye(3))
    for each in message.transforms:
        size = projection.size_of(each.fiducial_id)
        corners = projection.corners(each.transform.translation, each.transform.rotation, size, axes)
        yield ForeignMarker(each.fiducial_id, corners, True)


def _is_turned(projection: Projection) -> bool:
    return projection.family.startswith("tag")


CONVENTIONS: Dict[str, Convention] = {
    "apriltag_ros/AprilTagDetectionArray": Convention(_apriltags, True),
    "aruco_msgs/MarkerArray": Convention(_aruco_markers, True),
    "fiducial_msgs/FiducialArray": Convention(_fiducial_vertices, False),
    "fiducial_msgs/FiducialTransformArray": Convention(_fiducial_transforms, False),
}


def convention_of(message_type: str) -> Convention:
    """How to read messages of a type.

    :raises DamagedMessage: the type is not known
    """
    if message_type not in CONVENTIONS:
        raise DamagedMessage(f"{message_type} is not one of {', '.join(CONVENTIONS)}")
    return CONVENTIONS[message_type]


def foreign_markers(message: Any, projection: Projection) -> Tuple[ForeignMarker, ...]:
    """The markers of a message of a type in CONVENTIONS; those without four finite corners are left out.

    :raises DamagedMessage: the type is not known
    """
    found = convention_of(message._type).read(message, projection)
    return tuple(marker for marker in found if np.isfinite(marker.corners).all())
