# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The sun before the lens: where it is, how much of it is hidden, and where its light is scattered."""

import numpy as np
import pytest

from sextant.streets.street_flare import DISC, GHOSTS, RADIUS, add_flare, add_sun, visible_sun

F, SHAPE = 500.0, (480, 640)


def sky_with(sun, direct=0.8):
    light = np.full(SHAPE, 150.0, np.float32)
    add_sun(light, sun, F, direct)
    return light


def test_the_disc_is_where_the_sun_is_and_as_large_as_set():
    rows, columns = np.nonzero(sky_with((200.0, 100.0)) > DISC * 0.8 / 2)
    assert (columns.mean(), rows.mean()) == pytest.approx((200, 100), abs=1.5)
    assert len(rows) == pytest.approx(np.pi * (RADIUS * F) ** 2, rel=0.35)


def test_what_hides_the_sun_takes_the_flare_away():
    sun = (200.0, 100.0)
    light = sky_with(sun)
    whole = visible_sun(light, sun, F)
    light[:, :200] = 60.0
    half = visible_sun(light, sun, F)
    light[:] = 60.0
    assert whole > 0.8 and half == pytest.approx(whole / 2, abs=0.2) and visible_sun(light, sun, F) == 0
    assert visible_sun(light, (-50.0, 100.0), F) == 1  # outside the image nothing is known to hide it


def test_scattered_light_is_strongest_at_the_sun_and_in_proportion_to_it():
    once, twice = np.zeros(SHAPE, np.float32), np.zeros(SHAPE, np.float32)
    add_flare(once, (200.0, 100.0), F, 1.0)
    add_flare(twice, (200.0, 100.0), F, 2.0)
    assert twice == pytest.approx(2 * once, rel=1e-4)
    row, column = np.unravel_index(once.argmax(), SHAPE)
    assert (column, row) == pytest.approx((200, 100), abs=6)
    assert once.min() > 0  # a veil over everything


def test_ghosts_lie_on_the_line_through_the_image_centre():
    light, sun, centre = np.zeros(SHAPE, np.float32), np.array([150.0, 90.0]), np.array([319.5, 239.5])
    add_flare(light, sun, F, 1.0)
    place, radius, tone = GHOSTS[1]
    across = np.array([centre[1] - sun[1], sun[0] - centre[0]]) / np.hypot(*(centre - sun))
    middle = sun + place * (centre - sun)
    inside, outside = (middle + across * F * radius * part for part in (0.8, 1.25))
    at = [light[round(y), round(x)] for x, y in (inside, outside)]
    assert at[0] - at[1] == pytest.approx(tone, abs=10)
