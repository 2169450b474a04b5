# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from written_bags import WrittenBag, flat, header, nanoseconds

import sextant
from sextant.bags.bag_file import BagError
from sextant.bags.recorded_poses import read_frame, read_poses
from sextant.messages.pose_messages import pose_to_message

COVARIANCE = np.diag([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]) + 0.1


def pose(x):
    return sextant.pose_from_xyz_rpy([x, 2.0, 3.0], [0.1, 0.2, 0.3])


def with_covariance(seconds, x, frame="map"):
    message = PoseWithCovarianceStamped(header=header(seconds, frame))
    message.pose.pose, message.pose.covariance = pose_to_message(pose(x)), COVARIANCE.ravel()
    return message


def test_poses_with_covariances(tmp_path):
    with WrittenBag(tmp_path / "a.bag") as bag:
        bag.image("/cam/image_raw", flat(), 0.0)
        bag.write("/pose", with_covariance(2.0, 2.0), 1.0)  # overtaken
        bag.write("/pose", with_covariance(1.5, 1.0), 2.0)
    read = read_poses(str(tmp_path / "a.bag"), "pose")
    assert read.frame == "map" and read.start == nanoseconds(0.0) and read.warnings == ()
    assert read.stamps.tolist() == [nanoseconds(1.5), nanoseconds(2.0)]
    np.testing.assert_allclose(read.poses, [pose(1.0), pose(2.0)], atol=1e-12)
    np.testing.assert_array_equal(read.covariances, [COVARIANCE] * 2)


def test_other_types(tmp_path):
    with WrittenBag(tmp_path / "a.bag") as bag:
        bag.write("/plain", PoseStamped(header(1.0, "map"), pose_to_message(pose(1.0))), 1.0)
        bag.odometry("/odom", pose(2.0), 1.0)
    plain, odometry = (read_poses(str(tmp_path / "a.bag"), topic) for topic in ("/plain", "/odom"))
    np.testing.assert_allclose(plain.poses, [pose(1.0)], atol=1e-12)
    assert np.isnan(plain.covariances).all()
    np.testing.assert_allclose(odometry.poses, [pose(2.0)], atol=1e-12)
    assert odometry.frame == "odom"


def test_messages_that_cannot_be_used_are_counted(tmp_path):
    with WrittenBag(tmp_path / "a.bag") as bag:
        bag.write("/pose", with_covariance(1.0, 1.0), 1.0)
        bag.write("/pose", with_covariance(2.0, np.nan), 2.0)
        bag.write("/pose", with_covariance(3.0, 1.0, frame="odom"), 3.0)
        bag.write("/pose", with_covariance(1.0, 1.0), 4.0)
    read = read_poses(str(tmp_path / "a.bag"), "/pose")
    assert len(read.stamps) == 1 and len(read.warnings) == 3
    assert any("must be finite" in each for each in read.warnings)
    assert any("its frame is 'odom'" in each for each in read.warnings)


def test_refusals(tmp_path):
    with WrittenBag(tmp_path / "a.bag") as bag:
        bag.write("/pose", with_covariance(1.0, np.nan), 1.0)
        bag.image("/cam/image_raw", flat(), 0.0)
    with pytest.raises(BagError, match="there is no pose on /cam/image_raw; topics with this type: /pose"):
        read_poses(str(tmp_path / "a.bag"), "/cam/image_raw")
    with pytest.raises(BagError, match="nothing on /pose can be used"):
        read_poses(str(tmp_path / "a.bag"), "/pose")


def test_where_tf_had_a_frame(tmp_path):
    path = str(tmp_path / "a.bag")
    with WrittenBag(path) as bag:
        bag.transforms([("base_link", "truth", pose(5.0))])
        for second in (1.0, 2.0):
            moved = sextant.pose_from_xyz_rpy([second, 0.0, 0.0], [0.0, 0.0, 0.0])
            bag.transforms([("map", "base_link", moved)], second, topic="/tf")
    with WrittenBag(tmp_path / "b.bag") as bag:
        bag.transforms([("map", "truth", pose(5.0))])
        bag.transforms([("map", "truth", pose(6.0))])
    found, notes = read_frame(path, "map", "truth", [nanoseconds(1.5), nanoseconds(9.0)], max_gap=1.0)
    assert notes == []
    assert list(found) == [nanoseconds(1.5)]
    np.testing.assert_allclose(found[nanoseconds(1.5)][:3, 3], [6.5, 2.0, 3.0], atol=1e-9)
    assert read_frame(path, "map", "truth", [nanoseconds(1.5)])[0] == {}  # tf2 itself would make it up
    [note] = read_frame(str(tmp_path / "b.bag"), "map", "truth", [])[1]
    assert "/tf_static has different transforms of truth" in note
    with pytest.raises(BagError, match="tf does not connect 'map' with 'nobody'"):
        read_frame(path, "map", "nobody", [])
