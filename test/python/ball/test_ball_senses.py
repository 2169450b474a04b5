# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import math

import numpy as np
import pytest
import rospy
from geometry_msgs.msg import Point, Quaternion, Vector3
from nav_msgs.msg import Odometry

from sextant.ball.floor_grid import FloorGrid, FloorGridParams
from sextant.msg import LandmarkMapEntries, LandmarkMapEntry, ObjectBox, Objects
from sextant.nodes.ball.ball_senses import BallSenses

SECOND = 10**9
GRID = FloorGrid(FloorGridParams())


def told(frame, stamp, x, y, heading=0.0, speed=(0.0, 0.0), child="base"):
    message = Odometry(child_frame_id=child)
    message.header.frame_id, message.header.stamp = frame, rospy.Time(nsecs=round(1e9 * stamp))
    message.pose.pose.position = Point(x, y, 0.0)
    message.pose.pose.orientation = Quaternion(0.0, 0.0, math.sin(0.5 * heading), math.cos(0.5 * heading))
    message.twist.twist.linear = Vector3(*speed, 0.0)
    return message


def placed(*stamps, senses=None):
    """Odometry says (1, 0, 0), where the robot is at (2, 3) and looks along the map's y axis."""
    senses = senses or BallSenses(1.0, 0.35)
    for stamp in stamps:
        senses.hear_odometry(told("odom", stamp, 1.0, 0.0))
        senses.hear_pose(told("map", stamp, 2.0, 3.0, 0.5 * math.pi))
    return senses


def test_there_is_no_pose_before_both_have_told_of_a_moment():
    senses = BallSenses(1.0, 0.35)
    assert senses.stamp == -math.inf
    senses.hear_pose(told("map", 5.0, 0.0, 0.0))
    senses.hear_odometry(told("odom", 4.9, 0.0, 0.0))
    assert senses.stamp == -math.inf
    senses.hear_odometry(told("odom", 5.0, 0.0, 0.0))
    assert senses.stamp == 5.0
    assert (senses.map_frame, senses.odom_frame, senses.base_frame) == ("map", "odom", "base")


def test_the_ball_is_taken_from_odometrys_frame_to_the_map():
    senses = placed(5.0)
    senses.hear_ball(told("odom", 4.9, 1.5, 0.2, speed=(0.4, 0.1)))
    view = senses.view(GRID)
    np.testing.assert_allclose(view.pose, [2.0, 3.0, 0.5 * math.pi])
    # 0.5 ahead and 0.2 to the left, 0.1 s ago.
    velocity, slowed = np.array([-0.1, 0.4]), 0.1 * 0.35 / math.hypot(0.1, 0.4)
    expected = np.array([1.8, 3.5]) + 0.1 * (1.0 - 0.5 * slowed) * velocity
    np.testing.assert_allclose(view.ball.position, expected)
    np.testing.assert_allclose(view.ball.velocity, (1.0 - slowed) * velocity)
    assert (view.stamp, view.ball.stamp) == (5.0, 4.9)


def test_a_ball_that_nobody_tells_of_any_more_is_not_known():
    senses = placed(5.0)
    assert senses.view(GRID).ball is None
    senses.hear_ball(told("odom", 4.9, 1.5, 0.2))
    assert placed(5.8, senses=senses).view(GRID).ball is not None
    assert placed(5.95, senses=senses).view(GRID).ball is None


def test_a_ball_is_seen_when_a_picture_shows_it():
    senses = placed(5.0)
    senses.hear_ball(told("odom", 4.9, 1.5, 0.2))
    for stamp, name in ((4.5, "ball"), (4.9, "blue_pillar")):
        objects = Objects(objects=[ObjectBox(class_name=name)])
        objects.header.stamp = rospy.Time.from_sec(stamp)
        senses.hear_objects(objects)
    assert senses.view(GRID).ball.stamp == 4.5


def test_a_ball_in_another_frame_is_refused():
    with pytest.raises(ValueError, match="it is in 'world', odometry in 'odom'"):
        placed(5.0).hear_ball(told("world", 5.0, 0.0, 0.0))


def test_landmarks_are_pillars():
    senses = placed(5.0)
    entries = LandmarkMapEntries(landmarks=[LandmarkMapEntry(class_name="blue_pillar", x=1.0, y=-2.0)])
    senses.hear_landmarks(entries)
    (pillar,) = senses.view(GRID).pillars
    assert pillar.class_name == "blue_pillar" and list(pillar.position) == [1.0, -2.0]


def test_what_is_not_finite_is_refused_and_what_was_known_stays():
    senses = placed(5.0)
    senses.hear_ball(told("odom", 4.9, 1.5, 0.2))
    with pytest.raises(ValueError, match="not finite"):
        senses.hear_ball(told("odom", 5.0, math.nan, 0.2))
    with pytest.raises(ValueError, match="not finite"):
        senses.hear_landmarks(LandmarkMapEntries(landmarks=[LandmarkMapEntry(x=math.inf)]))
    view = senses.view(GRID)
    assert view.ball.stamp == 4.9 and view.pillars == []


def test_a_short_touch_is_told_once_and_a_long_one_as_long_as_it_lasts():
    senses = placed(5.0)
    senses.hear_bumper(True)
    senses.hear_bumper(False)
    assert [senses.view(GRID).is_bumped for _ in range(2)] == [True, False]
    senses.hear_bumper(True)
    assert [senses.view(GRID).is_bumped for _ in range(2)] == [True, True]
    senses.hear_bumper(False)
    assert [senses.view(GRID).is_bumped for _ in range(2)] == [True, False]
    senses.hear_bumper(True)
    senses.hear_bumper(False)
    senses.forget_touches()
    assert not senses.view(GRID).is_bumped


def test_a_depth_image_waits_for_the_pose_of_its_moment():
    senses = placed(5.0)
    senses.hear_depth(5_050_000_000, np.ones((2, 3)))
    assert senses.looks() == []
    senses.hear_odometry(told("odom", 5.1, 1.0, 0.0))
    senses.hear_pose(told("map", 5.1, 2.4, 3.0, 0.5 * math.pi))
    ((points, pose),) = senses.looks()
    np.testing.assert_allclose(pose, [2.2, 3.0, 0.5 * math.pi])
    assert points.shape == (2, 3) and senses.looks() == []


def test_of_a_clock_that_was_set_back_nothing_stays():
    senses = placed(50.0)
    senses.hear_ball(told("odom", 50.0, 1.5, 0.2))
    senses.hear_landmarks(LandmarkMapEntries(landmarks=[LandmarkMapEntry(x=1.0)]))
    senses = placed(5.0, senses=senses)
    assert senses.stamp == 5.0 and senses.view(GRID).ball is None and senses.view(GRID).pillars == []


def test_a_ball_that_is_told_ahead_of_time_is_of_another_clock():
    senses = placed(5.0)
    senses.hear_ball(told("odom", 3605.0, 1.5, 0.2, speed=(0.1, 0.0)))
    assert senses.view(GRID).ball is None


def test_a_ball_rolls_no_farther_than_its_floor_lets_it():
    """From 0.1 m/s at 0.35 m/s^2 it lies after 14 mm."""
    senses = placed(5.0)
    senses.hear_ball(told("odom", 4.2, 1.5, 0.0, speed=(0.1, 0.0)))
    ball = senses.view(GRID).ball
    np.testing.assert_allclose(ball.position, [2.0, 3.5 + 0.1**2 / (2 * 0.35)])
    np.testing.assert_allclose(ball.velocity, 0.0, atol=1e-12)


def test_when_pictures_and_depth_images_were_told_last():
    senses = placed(5.0)
    assert math.isnan(senses.pictures) and senses.depth == -math.inf
    senses.hear_objects(Objects(header=told("camera", 4.9, 0.0, 0.0).header))
    senses.hear_depth(4_950_000_000, np.ones((2, 3)))
    senses.hear_depth(1_000_000_000, np.ones((2, 3)))
    placed(5.0, 5.1, senses=senses)
    assert (senses.pictures, senses.depth) == (4.9, -math.inf)  # before all poses, and its next
    assert [len(senses.looks()), senses.without_pose] == [0, 2]
    senses.hear_depth(5_050_000_000, np.ones((2, 3)))
    assert len(senses.looks()) == 1 and senses.depth == pytest.approx(5.05)
