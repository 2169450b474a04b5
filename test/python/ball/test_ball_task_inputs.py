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
from sextant.nodes.ball.ball_task_inputs import BallTaskInputs

SECOND = 10**9
GRID = FloorGrid(FloorGridParams())


def odometry(frame, stamp, x, y, heading=0.0, speed=(0.0, 0.0), child="base"):
    message = Odometry(child_frame_id=child)
    message.header.frame_id, message.header.stamp = frame, rospy.Time(nsecs=round(1e9 * stamp))
    message.pose.pose.position = Point(x, y, 0.0)
    message.pose.pose.orientation = Quaternion(0.0, 0.0, math.sin(0.5 * heading), math.cos(0.5 * heading))
    message.twist.twist.linear = Vector3(*speed, 0.0)
    return message


def placed(*stamps, inputs=None):
    """Odometry is (1, 0, 0) where the robot is at (2, 3) in the map and faces along its y axis."""
    inputs = inputs or BallTaskInputs(1.0, 0.35)
    for stamp in stamps:
        inputs.add_odometry(odometry("odom", stamp, 1.0, 0.0))
        inputs.add_pose(odometry("map", stamp, 2.0, 3.0, 0.5 * math.pi))
    return inputs


def test_there_is_no_pose_before_both_messages_of_a_stamp():
    inputs = BallTaskInputs(1.0, 0.35)
    assert inputs.stamp == -math.inf
    inputs.add_pose(odometry("map", 5.0, 0.0, 0.0))
    inputs.add_odometry(odometry("odom", 4.9, 0.0, 0.0))
    assert inputs.stamp == -math.inf
    inputs.add_odometry(odometry("odom", 5.0, 0.0, 0.0))
    assert inputs.stamp == 5.0
    assert (inputs.map_frame, inputs.odom_frame, inputs.base_frame) == ("map", "odom", "base")


def test_the_ball_is_taken_from_odometrys_frame_to_the_map():
    inputs = placed(5.0)
    inputs.set_ball(odometry("odom", 4.9, 1.5, 0.2, speed=(0.4, 0.1)))
    view = inputs.task_view(GRID)
    np.testing.assert_allclose(view.pose, [2.0, 3.0, 0.5 * math.pi])
    # 0.5 ahead and 0.2 to the left, 0.1 s ago.
    velocity, slowed = np.array([-0.1, 0.4]), 0.1 * 0.35 / math.hypot(0.1, 0.4)
    expected = np.array([1.8, 3.5]) + 0.1 * (1.0 - 0.5 * slowed) * velocity
    np.testing.assert_allclose(view.ball.position, expected)
    np.testing.assert_allclose(view.ball.velocity, (1.0 - slowed) * velocity)
    assert (view.stamp, view.ball.stamp) == (5.0, 4.9)


def test_a_ball_without_new_messages_is_unknown():
    inputs = placed(5.0)
    assert inputs.task_view(GRID).ball is None
    inputs.set_ball(odometry("odom", 4.9, 1.5, 0.2))
    assert placed(5.8, inputs=inputs).task_view(GRID).ball is not None
    assert placed(5.95, inputs=inputs).task_view(GRID).ball is None


def test_a_ball_is_seen_when_a_picture_shows_it():
    inputs = placed(5.0)
    inputs.set_ball(odometry("odom", 4.9, 1.5, 0.2))
    for stamp, name in ((4.5, "ball"), (4.9, "blue_pillar")):
        objects = Objects(objects=[ObjectBox(class_name=name)])
        objects.header.stamp = rospy.Time.from_sec(stamp)
        inputs.set_objects(objects)
    assert inputs.task_view(GRID).ball.stamp == 4.5


def test_a_ball_in_another_frame_is_refused():
    with pytest.raises(ValueError, match="its frame is 'world', odometry's is 'odom'"):
        placed(5.0).set_ball(odometry("world", 5.0, 0.0, 0.0))


def test_landmarks_are_pillars():
    inputs = placed(5.0)
    entries = LandmarkMapEntries(landmarks=[LandmarkMapEntry(class_name="blue_pillar", x=1.0, y=-2.0)])
    inputs.set_landmarks(entries)
    (pillar,) = inputs.task_view(GRID).pillars
    assert pillar.class_name == "blue_pillar" and list(pillar.position) == [1.0, -2.0]


def test_what_is_not_finite_is_refused_and_what_was_known_stays():
    inputs = placed(5.0)
    inputs.set_ball(odometry("odom", 4.9, 1.5, 0.2))
    with pytest.raises(ValueError, match="not finite"):
        inputs.set_ball(odometry("odom", 5.0, math.nan, 0.2))
    with pytest.raises(ValueError, match="not finite"):
        inputs.set_landmarks(LandmarkMapEntries(landmarks=[LandmarkMapEntry(x=math.inf)]))
    view = inputs.task_view(GRID)
    assert view.ball.stamp == 4.9 and view.pillars == []


def test_a_short_touch_is_reported_once_and_a_long_one_as_long_as_it_lasts():
    inputs = placed(5.0)
    inputs.set_bumper(True)
    inputs.set_bumper(False)
    assert [inputs.task_view(GRID).is_bumped for _ in range(2)] == [True, False]
    inputs.set_bumper(True)
    assert [inputs.task_view(GRID).is_bumped for _ in range(2)] == [True, True]
    inputs.set_bumper(False)
    assert [inputs.task_view(GRID).is_bumped for _ in range(2)] == [True, False]
    inputs.set_bumper(True)
    inputs.set_bumper(False)
    inputs.clear_touches()
    assert not inputs.task_view(GRID).is_bumped


def test_a_depth_image_waits_for_the_pose_of_its_moment():
    inputs = placed(5.0)
    inputs.add_depth_points(5_050_000_000, np.ones((2, 3)))
    assert inputs.ready_points() == []
    inputs.add_odometry(odometry("odom", 5.1, 1.0, 0.0))
    inputs.add_pose(odometry("map", 5.1, 2.4, 3.0, 0.5 * math.pi))
    ((points, pose),) = inputs.ready_points()
    np.testing.assert_allclose(pose, [2.2, 3.0, 0.5 * math.pi])
    assert points.shape == (2, 3) and inputs.ready_points() == []


def test_of_a_clock_that_was_set_back_nothing_stays():
    inputs = placed(50.0)
    inputs.set_ball(odometry("odom", 50.0, 1.5, 0.2))
    inputs.set_landmarks(LandmarkMapEntries(landmarks=[LandmarkMapEntry(x=1.0)]))
    inputs = placed(5.0, inputs=inputs)
    assert (
        inputs.stamp == 5.0 and inputs.task_view(GRID).ball is None and inputs.task_view(GRID).pillars == []
    )


def test_a_ball_with_a_stamp_in_the_future_is_of_another_clock():
    inputs = placed(5.0)
    inputs.set_ball(odometry("odom", 3605.0, 1.5, 0.2, speed=(0.1, 0.0)))
    assert inputs.task_view(GRID).ball is None


def test_a_ball_rolls_no_farther_than_its_floor_lets_it():
    """From 0.1 m/s at 0.35 m/s^2 it lies after 14 mm."""
    inputs = placed(5.0)
    inputs.set_ball(odometry("odom", 4.2, 1.5, 0.0, speed=(0.1, 0.0)))
    ball = inputs.task_view(GRID).ball
    np.testing.assert_allclose(ball.position, [2.0, 3.5 + 0.1**2 / (2 * 0.35)])
    np.testing.assert_allclose(ball.velocity, 0.0, atol=1e-12)


def test_stamps_of_the_newest_images():
    inputs = placed(5.0)
    assert math.isnan(inputs.newest_image) and inputs.newest_depth == -math.inf
    inputs.set_objects(Objects(header=odometry("camera", 4.9, 0.0, 0.0).header))
    inputs.add_depth_points(4_950_000_000, np.ones((2, 3)))
    inputs.add_depth_points(1_000_000_000, np.ones((2, 3)))
    placed(5.0, 5.1, inputs=inputs)
    assert (inputs.newest_image, inputs.newest_depth) == (4.9, -math.inf)  # before all poses, and its next
    assert [len(inputs.ready_points()), inputs.without_pose] == [0, 2]
    inputs.add_depth_points(5_050_000_000, np.ones((2, 3)))
    assert len(inputs.ready_points()) == 1 and inputs.newest_depth == pytest.approx(5.05)
