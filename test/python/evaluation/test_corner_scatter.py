# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
from dataclasses import replace

import numpy as np
import pytest
from still_series import FAMILY, ID, facing, noisy_corners, observations

import sextant
from sextant.evaluation.corner_scatter import corner_noise as noise_of

T = facing(2.0)


def corner_noise(drives):
    return noise_of(drives, {(FAMILY, ID)})


@pytest.mark.parametrize("sigma", [0.05, 0.3, 1.0])
def test_noise_is_found(sigma):
    noise = corner_noise([observations(noisy_corners(T, 500, sigma, 1))])
    assert noise.sigma == pytest.approx(sigma, rel=0.05)
    assert "499 pairs" in noise.measured


def test_the_sigmas_of_the_corners_are_subtracted():
    drives = [observations(noisy_corners(T, 500, 0.5, seed), sigmas=0.3) for seed in (1, 2)]
    assert corner_noise(drives).sigma == pytest.approx(0.4, rel=0.05)  # 3, 4, 5
    boasting = observations(noisy_corners(T, 500, 0.5, 1), sigmas=0.6)
    assert corner_noise([boasting]).sigma == pytest.approx(0.01)


def test_drift_is_no_noise():
    drift = np.linspace(0.0, 20.0, 500)[:, None, None]  # a hundred times the noise
    drifting = observations(noisy_corners(T, 500, 0.2, 1) + drift)
    assert corner_noise([drifting]).sigma == pytest.approx(0.2, rel=0.05)


def test_somebody_walks_against_the_table():
    corners = noisy_corners(T, 500, 0.2, 1)
    corners[250:260] += 30.0 * np.random.default_rng(2).normal(size=(10, 4, 2))
    assert corner_noise([observations(corners)]).sigma == pytest.approx(0.2, rel=0.05)


def test_series_at_several_distances_count_by_their_images():
    few, many = noisy_corners(T, 101, 0.6, 1), noisy_corners(facing(5.0), 401, 0.2, 2)
    expected = np.sqrt((100 * 0.6**2 + 400 * 0.2**2) / 500)
    assert corner_noise([observations(few), observations(many)]).sigma == pytest.approx(expected, rel=0.05)


def test_too_few_images():
    one_each = [observations(noisy_corners(T, 1, 0.2, seed)) for seed in range(30)]
    with pytest.raises(ValueError, match="needs 20 pairs of images of a marker, there are 0"):
        corner_noise(one_each)


def test_a_camera_that_moves():
    corners = noisy_corners(T, 50, 0.2, 1) + 20.0 * np.random.default_rng(2).normal(size=(50, 1, 2))
    with pytest.raises(ValueError, match="did the camera stand still"):
        corner_noise([observations(corners)])


def test_false_detections_are_left_out():
    drive = observations(noisy_corners(T, 500, 0.2, 1))
    for k, place in ((10, 0.0), (20, 80.0), (30, 7.0)):
        false = sextant.Detection(FAMILY, ID + 1, drive.images[k].markers[0].corners + place)
        drive.images[k] = replace(drive.images[k], markers=[*drive.images[k].markers, false])
    assert corner_noise([drive]).sigma == pytest.approx(0.2, rel=0.05)
