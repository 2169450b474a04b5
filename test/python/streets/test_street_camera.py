# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A simulated camera shows what its focal length, exposure and tone curve say."""

from dataclasses import replace

import numpy as np
import pytest

from sextant.streets.street_camera import CAMERAS, METERED, StreetCamera, exposed, tone_curve

RAMP = np.tile(np.linspace(0, 600, 64, dtype=np.float32), (48, 1))


def image(camera, light=RAMP, seed=0):
    return exposed(light, camera, np.random.default_rng(seed))


def test_the_ideal_camera_changes_nothing_but_saturation():
    assert image(CAMERAS["ideal"]) == pytest.approx(np.minimum(RAMP, 255), abs=1e-3)


@pytest.mark.parametrize("gamma", [0.5, 1.0, 1.8])
def test_a_tone_curve_is_monotonic_and_keeps_black_and_white(gamma):
    grey = tone_curve(RAMP[:1], gamma)[0]
    assert np.all(np.diff(grey) >= 0) and np.all(np.diff(grey[RAMP[0] < 250]) > 0)
    assert (grey[0], grey[-1]) == pytest.approx((0.0, 255.0), abs=1e-3)
    assert tone_curve(np.float32([[127.5]]), gamma)[0, 0] == pytest.approx(255 * 0.5**gamma, abs=0.01)


def test_more_exposure_is_brighter_everywhere_until_white():
    dark, usual, bright = (image(StreetCamera(exposure=gain)) for gain in (0.5, 1.0, 2.0))
    assert np.all(dark <= usual) and np.all(usual <= bright)
    assert dark[:, 5] == pytest.approx(usual[:, 5] / 2) and bright[:, 5] == pytest.approx(2 * usual[:, 5])
    assert np.mean(bright > 254.9) > np.mean(usual > 254.9) > np.mean(dark > 254.9)


def test_metering_makes_the_mean_brightness_the_same():
    light = np.random.default_rng(1).uniform(10, 100, (48, 64)).astype(np.float32)
    metered = StreetCamera(metering=1.0)
    for gain in (0.5, 1.0, 2.0):
        assert image(metered, gain * light).mean() == pytest.approx(METERED, rel=0.02)


def test_the_error_of_the_exposure_is_as_many_stops_as_set():
    grey, camera = np.full((4, 4), 20.0, np.float32), StreetCamera(exposure_error=0.5)
    stops = np.log2([image(camera, grey, seed)[0, 0] / 20 for seed in range(400)])
    assert np.std(stops) == pytest.approx(0.5, rel=0.15) and np.mean(stops) == pytest.approx(0, abs=0.1)
    assert np.array_equal(image(camera, grey, 7), image(camera, grey, 7))


def test_an_image_has_single_precision():
    assert image(StreetCamera(vignetting=0.5, gamma=1.8)).dtype == np.float32


def test_vignetting_is_the_loss_in_the_corners():
    grey = np.full((49, 65), 100.0, np.float32)
    seen = image(StreetCamera(vignetting=0.4), grey)
    assert seen[24, 32] == pytest.approx(100) and seen[[0, 0, -1, -1], [0, -1, 0, -1]] == pytest.approx(60)
    assert np.all(np.diff(seen[24, 32:]) < 0)


def test_half_the_tangent_is_twice_the_focal_length():
    wide = StreetCamera(horizontal_fov=1.2)
    narrow = replace(wide, horizontal_fov=2 * np.arctan(np.tan(0.6) / 2))
    assert narrow.focal_length(640) == pytest.approx(2 * wide.focal_length(640))
    assert wide.focal_length(640) == pytest.approx(320 / np.tan(0.6))


def test_a_camera_that_cannot_be_is_refused():
    with pytest.raises(ValueError, match="gamma: must be within"):
        StreetCamera(gamma=0.0)
