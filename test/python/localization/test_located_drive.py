# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
from still_series import FAMILY, ID, SIZE, exact_corners, facing, noisy_corners, observations

import sextant
from sextant.localization.located_drive import locate_drive


def marker_map(id=ID):
    result = sextant.MarkerMap("marker")
    result.add(sextant.MappedMarker(FAMILY, id, SIZE, np.eye(4)))
    return result


def params(**locator):
    result = sextant.LocalizationParams()
    for name, value in locator.items():
        setattr(result.locator, name, value)
    return result


def test_exact_corners_give_the_exact_pose():
    T = facing(1.5)
    located = locate_drive(observations([exact_corners(T)] * 3), marker_map(), params())
    assert located.failures == {} and len(located.stamps) == 3
    np.testing.assert_allclose(located.poses, [T] * 3, atol=1e-6)


@pytest.mark.parametrize("sigma", [0.1, 0.5])
def test_covariance_is_that_of_the_poses(sigma):
    T = facing(1.5)
    drive = observations(noisy_corners(T, 400, sigma, 3))
    located = locate_drive(drive, marker_map(), params(corner_sigma=sigma))
    measured = located.poses[:, :3, 3].std(axis=0, ddof=1)
    published = np.sqrt(located.covariances[:, [0, 1, 2], [0, 1, 2]].mean(axis=0))
    np.testing.assert_allclose(published / measured, 1.0, atol=0.15)


def test_images_without_a_pose_are_counted_by_reason():
    located = locate_drive(observations([exact_corners(facing(1.0))] * 4), marker_map(id=3), params())
    assert len(located.stamps) == 0 and located.poses.shape == (0, 4, 4)
    assert sum(located.failures.values()) == 4 and len(located.failures) == 1
