# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Effects of a camera on images whose result is known."""

import numpy as np
import pytest

from sextant.simulation.camera_effects import CameraEffects, random_effects, with_effects

GREY = np.full((60, 80, 3), 128, np.uint8)
PICTURE = np.random.default_rng(1).integers(0, 256, (60, 80, 3), dtype=np.uint8)


def seen_with(image, effects):
    return with_effects(image, effects, np.random.default_rng(5))


def test_without_effects_an_image_stays_as_it_is():
    np.testing.assert_array_equal(seen_with(PICTURE, CameraEffects()), PICTURE)


def test_gains_multiply_and_saturate():
    seen = seen_with(GREY, CameraEffects(gains=np.array([0.5, 1.0, 3.0])))
    np.testing.assert_array_equal(np.unique(seen.reshape(-1, 3), axis=0), [[64, 128, 255]])


def test_without_saturation_an_image_is_grey():
    seen = seen_with(PICTURE, CameraEffects(saturation=0.0)).astype(int)
    assert np.ptp(seen, axis=2).max() == 0
    np.testing.assert_allclose(seen[..., 0], PICTURE.mean(axis=2), atol=1.0)


def test_motion_makes_a_ramp_of_an_edge_in_its_direction():
    edge = np.zeros((60, 80, 3), np.uint8)
    edge[:, 40:] = 200
    moved = seen_with(edge, CameraEffects(blur=(10.0, 0.0)))[30, :, 0].astype(int)
    assert np.count_nonzero((moved > 0) & (moved < 200)) in (9, 10, 11)
    assert np.all(np.diff(moved) >= 0) and moved[39] + moved[40] == pytest.approx(200, abs=2)
    np.testing.assert_array_equal(seen_with(edge, CameraEffects(blur=(0.0, 10.0))), edge)


def test_light_falls_off_towards_the_corners():
    seen = seen_with(GREY, CameraEffects(vignetting=0.5))
    assert seen[30, 40, 0] == pytest.approx(128, abs=1) and seen[0, 0, 0] == 64
    # 0.8 of the distance to the corner, squared
    assert seen[30, 0, 0] == pytest.approx(128 * (1 - 0.5 * 0.64), abs=1)


def test_dirt_covers_its_place_only():
    dark = np.full((60, 80, 3), 10, np.uint8)
    dark[:, 40:] = 250
    seen = seen_with(dark, CameraEffects(blots=np.array([[0.75, 0.375, 0.1, 0.5]]))).astype(int)
    assert seen[30, 60, 0] < 180
    np.testing.assert_array_equal(seen[:, :40], dark[:, :40])


def test_haze_adds_light_and_sharpening_overshoots():
    assert np.all(seen_with(GREY, CameraEffects(haze=0.1)) == 154)  # 128 + 25.5
    step = np.full((60, 80, 3), 100, np.uint8)
    step[:, 40:] = 150
    sharp = seen_with(step, CameraEffects(sharpening=1.0))[30, :, 0]
    assert sharp.min() < 95 and sharp.max() > 155 and sharp[5] == 100 and sharp[75] == 150


def test_less_quality_is_a_larger_error():
    errors = [
        np.abs(seen_with(PICTURE, CameraEffects(quality=quality)).astype(int) - PICTURE).mean()
        for quality in (100, 90, 30)
    ]
    assert errors[0] == 0.0 and 0.0 < errors[1] < errors[2]


def test_random_effects_follow_their_seed_and_keep_images_usable():
    for seed in range(50):
        one, same = (seen_with(PICTURE, random_effects(np.random.default_rng(seed))) for _ in range(2))
        np.testing.assert_array_equal(one, same)
        assert one.dtype == np.uint8 and one.shape == PICTURE.shape and one.std() > 10.0


def test_noise_and_lens_blur_have_their_standard_deviations():
    noisy = seen_with(GREY, CameraEffects(noise=6.0)).astype(float)
    assert noisy.std() == pytest.approx(6.0, rel=0.05) and noisy.mean() == pytest.approx(128.0, abs=0.3)
    point = np.zeros((61, 61, 3), np.uint8)
    point[30, 30] = 255
    spread = seen_with(np.repeat(np.repeat(point, 3, 0), 3, 1), CameraEffects(defocus=4.0)).astype(float)[
        ..., 0
    ]
    x = np.arange(183) - 91.0
    variance = np.average(x**2, weights=spread.sum(axis=0))
    assert variance == pytest.approx(4.0**2 + 2.0 / 3.0, rel=0.15)  # of the lens, and of three pixels
