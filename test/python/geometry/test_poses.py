# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

import sextant
from sextant.geometry.poses import quaternion_of

# x to y, y to z, z to x: a third of a turn about (1, 1, 1), whose quaternion is known without a formula
CYCLE = np.array([[0.0, 0.0, 1.0, 1.0], [1.0, 0.0, 0.0, 2.0], [0.0, 1.0, 0.0, 3.0], [0.0, 0.0, 0.0, 1.0]])


def test_known_rotation():
    assert sextant.pose_from_quaternion([1.0, 2.0, 3.0], [0.5, 0.5, 0.5, 0.5]) == pytest.approx(CYCLE)
    assert sextant.pose_from_quaternion([1.0, 2.0, 3.0], [-0.5, -0.5, -0.5, -0.5]) == pytest.approx(CYCLE)
    assert quaternion_of(CYCLE[:3, :3]) == pytest.approx([0.5, 0.5, 0.5, 0.5])
    assert quaternion_of(np.eye(3)) == pytest.approx([0, 0, 0, 1])
    assert quaternion_of(np.diag([-1.0, -1.0, 1.0])) == pytest.approx([0, 0, 1, 0])


def test_real_part_is_never_negative():
    for angle in np.linspace(-3.1, 3.1, 50):
        c, s = np.cos(angle), np.sin(angle)
        q = quaternion_of(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))
        assert q == pytest.approx([0.0, 0.0, np.sin(0.5 * angle), np.cos(0.5 * angle)])


def test_length_of_the_quaternion():
    with pytest.raises(ValueError, match="its norm is 1.02, not 1"):
        sextant.pose_from_quaternion([0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.02])
    assert sextant.pose_from_quaternion(
        [0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.02], tolerance=0.03
    ) == pytest.approx(np.eye(4))
    assert sextant.pose_from_quaternion([1.0, 2.0, 3.0], [2.0] * 4, tolerance=np.inf) == pytest.approx(CYCLE)
    with pytest.raises(ValueError, match="its norm is 0, not 1"):
        sextant.pose_from_quaternion([0.0, 0.0, 0.0], [0.0] * 4, tolerance=np.inf)


@pytest.mark.parametrize("position, q", [([np.inf, 0, 0], [0, 0, 0, 1]), ([0, 0, 0], [np.nan, 0, 0, 1])])
def test_numbers_that_are_not_finite(position, q):
    with pytest.raises(ValueError, match="must be finite"):
        sextant.pose_from_quaternion(position, q, tolerance=np.inf)
