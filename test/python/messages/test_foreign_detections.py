# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import cv2
import numpy as np
import pytest
from foreign_messages import classes_of
from geometry_msgs.msg import Quaternion, Vector3

import sextant
from sextant.geometry.poses import quaternion_of
from sextant.messages.damaged_message import DamagedMessage
from sextant.messages.foreign_detections import AXES, Projection, foreign_markers

SIZE = 0.16
K = np.array([[600.0, 0.0, 319.5], [0.0, 610.0, 239.5], [0.0, 0.0, 1.0]])
POSITION = np.array([0.2, -0.1, 1.5])
# Sextant's axes: z out of the print, so towards the camera
R = cv2.Rodrigues(np.array([np.pi, 0.0, 0.0]))[0] @ cv2.Rodrigues(np.array([0.3, -0.4, 0.5]))[0]


def camera():
    calibration = sextant.CameraCalibration()
    calibration.width, calibration.height, calibration.K = 640, 480, K
    calibration.distortion_model, calibration.D = "plumb_bob", [0.0] * 5
    calibration.R, calibration.P = np.eye(3), np.hstack([K, np.zeros((3, 1))])
    return sextant.CameraModel(calibration, False)


def expected(position=POSITION):
    """OpenCV's projection of the corners, top left first, clockwise."""
    h = SIZE / 2
    corners = np.array([[-h, h, 0], [h, h, 0], [h, -h, 0], [-h, -h, 0]])
    return cv2.projectPoints(corners, cv2.Rodrigues(R)[0], position, K, None)[0].reshape(4, 2)


def fill(pose, rotation=R, position=POSITION, names=("position", "orientation")):
    for name, values, cls in zip(names, (position, quaternion_of(rotation)), (Vector3, Quaternion)):
        for slot, value in zip(cls.__slots__, values):
            setattr(getattr(pose, name), slot, value)


def read(message, family="tag36h11", axes="as_sextant"):
    return foreign_markers(message, Projection(camera(), family, lambda id: SIZE, AXES[axes]))


def apriltags(*ids, position=POSITION):
    cls, parts = classes_of("apriltag_ros/AprilTagDetectionArray")
    message = cls()
    for each in ids:
        detection = parts["AprilTagDetection"](id=each, size=[SIZE] * len(each))
        fill(detection.pose.pose.pose, position=position)
        message.detections.append(detection)
    return message


def aruco(rotation):
    cls, parts = classes_of("aruco_msgs/MarkerArray")
    marker = parts["Marker"](id=7)
    fill(marker.pose.pose, rotation)
    return cls(markers=[marker])


def test_a_pose_of_apriltag_ros_gives_the_corners_that_it_projects_to():
    (marker,) = read(apriltags([3]))
    assert (marker.id, marker.from_pose) == (3, True)
    # its K is that of pixels whose origin is the corner of the first one
    assert marker.corners == pytest.approx(expected() - 0.5, abs=1e-9)


def test_bundles_alone_are_refused():
    with pytest.raises(DamagedMessage, match="standalone_tags"):
        read(apriltags([4, 5]))
    assert read(apriltags()) == ()


def test_bundles_and_poses_without_a_projection_are_left_out():
    assert [marker.id for marker in read(apriltags([3], [4, 5], [6]))] == [3, 6]
    for bad in ([0.0, 0.0, -1.0], [0.0, np.nan, 1.0]):
        assert read(apriltags([3], position=np.array(bad))) == ()
    message = apriltags([3])
    message.detections[0].pose.pose.pose.orientation = Quaternion()
    assert read(message) == ()


@pytest.mark.parametrize(
    "axes,columns",
    # Which of Sextant's axes (x right, y up, z out) each of theirs is: library 1 has x up, y out, z right
    [("as_sextant", [0, 1, 2]), ("aruco_library_1", [1, 2, 0])],
)
def test_poses_of_aruco_ros_have_the_axes_of_its_library(axes, columns):
    (marker,) = read(aruco(R[:, columns]), "DICT_ARUCO_ORIGINAL", axes)
    assert (marker.id, marker.from_pose) == (7, True)
    assert marker.corners == pytest.approx(expected(), abs=1e-9)


@pytest.mark.parametrize("family,first", [("DICT_5X5_1000", 0), ("tag36h11", 2)])
def test_corners_of_fiducials_are_used_as_they_are(family, first):
    cls, parts = classes_of("fiducial_msgs/FiducialArray")
    theirs = np.roll(expected(), -first, axis=0)  # OpenCV's AprilTags are rotated by 180 degrees
    values = {f"{axis}{i}": theirs[i, k] for i in range(4) for k, axis in enumerate("xy")}
    (marker,) = read(cls(fiducials=[parts["Fiducial"](fiducial_id=9, **values)]), family)
    assert (marker.id, marker.from_pose) == (9, False)
    assert np.array_equal(marker.corners, expected())


@pytest.mark.parametrize("family,turn", [("DICT_5X5_1000", 1.0), ("tag36h11", -1.0)])
def test_transforms_of_fiducials_give_the_corners_that_they_project_to(family, turn):
    cls, parts = classes_of("fiducial_msgs/FiducialTransformArray")
    transform = parts["FiducialTransform"](fiducial_id=2)
    fill(transform.transform, R @ np.diag([turn, turn, 1.0]), names=("translation", "rotation"))
    (marker,) = read(cls(transforms=[transform]), family)
    assert (marker.id, marker.from_pose) == (2, True)
    assert marker.corners == pytest.approx(expected(), abs=1e-9)


def test_another_type_is_refused_with_the_list_of_those_that_are_read():
    with pytest.raises(DamagedMessage, match="Quaternion is not one of apriltag_ros/AprilTagDetectionArray"):
        read(Quaternion())
