# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
from geometry_msgs.msg import Point, Pose, Quaternion

from sextant.messages.pose_messages import pose_from_message, pose_to_message, transform_to_message

HALF = np.sqrt(0.5)
# x to y, y to z, z to x: a third of a turn about (1, 1, 1), whose quaternion is known without a formula
CYCLE = np.array([[0.0, 0.0, 1.0, 1.0], [1.0, 0.0, 0.0, 2.0], [0.0, 1.0, 0.0, 3.0], [0.0, 0.0, 0.0, 1.0]])


def test_known_rotation():
    pose = pose_to_message(CYCLE)
    assert (pose.position.x, pose.position.y, pose.position.z) == (1.0, 2.0, 3.0)
    q = pose.orientation
    assert [q.x, q.y, q.z, q.w] == pytest.approx([0.5, 0.5, 0.5, 0.5])
    assert pose_from_message(pose) == pytest.approx(CYCLE)
    transform = transform_to_message(CYCLE)
    assert transform.translation.z == 3.0 and transform.rotation == q


@pytest.mark.parametrize(
    "q, x_axis",
    [
        ((0.0, 0.0, 0.0, 1.0), (1.0, 0.0, 0.0)),
        ((0.0, 0.0, HALF, HALF), (0.0, 1.0, 0.0)),
        ((0.0, 0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)),
        ((0.0, -HALF, 0.0, -HALF), (0.0, 0.0, -1.0)),  # -q is the same rotation as q
    ],
)
def test_known_quaternions(q, x_axis):
    T = pose_from_message(Pose(Point(), Quaternion(*q)))
    assert T[:3, 0] == pytest.approx(x_axis)
    again = pose_to_message(T).orientation
    assert abs(np.dot(q, [again.x, again.y, again.z, again.w])) == pytest.approx(1.0)


def test_there_and_back_is_exact():
    generator = np.random.default_rng(1)
    for _ in range(100):
        q = generator.normal(size=4)
        T = pose_from_message(Pose(Point(*generator.normal(size=3)), Quaternion(*q / np.linalg.norm(q))))
        assert pose_from_message(pose_to_message(T)) == pytest.approx(T, abs=1e-12)


@pytest.mark.parametrize(
    "position, q",
    [
        ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)),
        ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.1)),
        ((0.0, 0.0, 0.0), (np.nan, 0.0, 0.0, 1.0)),
        ((np.inf, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)),
    ],
)
def test_refused(position, q):
    with pytest.raises(ValueError, match="must be finite|is not a rotation"):
        pose_from_message(Pose(Point(*position), Quaternion(*q)))
