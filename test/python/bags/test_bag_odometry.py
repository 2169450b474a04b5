# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
from written_bags import SMALL, WrittenBag, flat, nanoseconds

import sextant
from sextant.bags.bag_file import BagError
from sextant.bags.bag_params import BagParams
from sextant.bags.drive_reader import read_drive

TURNED = sextant.pose_from_xyz_rpy([0.1, -0.2, 0.3], [0.1, -0.4, 1.2])


def write_odometry(bag, child="base_link", topic="/odom", stamps=(0.0, 0.2, 0.1)):
    for index, seconds in enumerate(stamps):
        T = sextant.pose_from_xyz_rpy([float(index), 0.0, 0.0], [0.0, 0.0, 0.1 * index])
        bag.odometry(topic, T, seconds, child=child, received=0.1 * index)


def read_with_odometry(tmp_path, write, **options):
    with WrittenBag(tmp_path / "a.bag") as bag:
        bag.info("/cam/camera_info", SMALL)
        bag.image("/cam/image_raw", flat(), 0.0)
        write(bag)
    return read_drive(tmp_path / "a.bag", BagParams(**{"mounts": {"camera": TURNED}, **options}))


def test_odometry_is_brought_into_order(tmp_path):
    result = read_with_odometry(tmp_path, lambda bag: write_odometry(bag, stamps=(0.0, 0.2, 0.1, 0.2, None)))
    assert result.odometry_stamps.tolist() == [nanoseconds(t) for t in (0.0, 0.1, 0.2)]
    assert result.odometry[:, 0, 3].tolist() == [0.0, 2.0, 1.0]
    assert "/odom: 1 of 5 messages were left out: the same stamp came before" in result.warnings
    assert "/odom: 1 of 5 messages were left out: the stamp is zero" in result.warnings


def test_odometry_of_another_frame_of_the_robot(tmp_path):
    def write(bag):
        write_odometry(bag, "base_footprint")
        bag.transforms([("base_footprint", "base_link", TURNED)])

    assert read_with_odometry(tmp_path, write).odometry[0] == pytest.approx(TURNED, abs=1e-12)


def test_odometry_that_nothing_connects_with_the_base(tmp_path):
    result = read_with_odometry(tmp_path, lambda bag: write_odometry(bag, "wheels"))
    assert len(result.odometry) == 0 and any(
        "no static transform connects" in each for each in result.warnings
    )
    result = read_with_odometry(tmp_path, lambda bag: write_odometry(bag, ""))
    assert len(result.odometry) == 3 and any("taken as base_link" in each for each in result.warnings)
    result = read_with_odometry(tmp_path, write_odometry, odometry="none")
    assert len(result.odometry) == 0 and result.warnings == ()


def test_odometry_that_cannot_be_chosen_or_used(tmp_path):
    def write(bag):
        write_odometry(bag, "wheels")
        write_odometry(bag, "wheels", "/ground_truth")

    for options, reason in (
        ({}, "there are several topics of nav_msgs/Odometry: /ground_truth, /odom; name one by --odometry"),
        (
            {"odometry": "/odom"},
            "no static transform connects it with 'base_link'; set --base-frame wheels",
        ),
        ({"odometry": "/cam/image_raw"}, "there is no nav_msgs/Odometry on /cam/image_raw"),
        (
            {"odometry": "/odom", "mounts": {}},
            "/odom cannot be used: the pose of the camera on the robot is unknown",
        ),
    ):
        with pytest.raises(BagError) as caught:
            read_with_odometry(tmp_path, write, **options)
        assert reason in str(caught.value)


def test_odometry_none_of_which_can_be_used(tmp_path):
    with pytest.raises(BagError, match="/odom can be used: position and quaternion must be finite"):
        nowhere = sextant.pose_from_xyz_rpy(np.full(3, np.nan), np.zeros(3))
        read_with_odometry(tmp_path, lambda bag: bag.odometry("/odom", nowhere, 0.0))
