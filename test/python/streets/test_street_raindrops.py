# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Raindrops on a lens cover as much as set, and show the scene upside down."""

import numpy as np
import pytest

from sextant.streets.street_raindrops import RADIUS, add_raindrops

BRIGHT_ABOVE = np.full((480, 640), 200, np.float32)
BRIGHT_ABOVE[240:] = 40


def behind(mean, seed=1, light=BRIGHT_ABOVE):
    return add_raindrops(light, mean, np.random.default_rng(seed))


def test_without_drops_nothing_changes():
    assert np.array_equal(behind(0), BRIGHT_ABOVE)


def test_a_drop_shows_the_sky_at_its_lower_end():
    changed = behind(20) - BRIGHT_ABOVE
    assert changed[:200].min() < -120 and changed[:200].max() < 25
    assert changed[280:].max() > 120 and changed[280:].min() > -25


def test_drops_cover_the_area_that_their_number_and_size_make():
    covered = [np.mean(np.abs(behind(4, seed) - BRIGHT_ABOVE) > 80) for seed in range(40)]
    low, high = RADIUS
    radius_squared = (low**2 + low * high + high**2) / 3 * 640**2
    expected = 4 * 1.2 * np.pi * radius_squared / (480 * 640)
    assert np.mean(covered) == pytest.approx(expected, rel=0.3)


def test_the_same_seed_makes_the_same_drops():
    assert np.array_equal(behind(10, 3), behind(10, 3)) and not np.array_equal(behind(10, 3), behind(10, 4))
