# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Shadows lie where the direction of the light and the height of what casts them put them."""

import numpy as np
import pytest

from sextant.streets.street_shadows import (
    SHADOW_TEXELS,
    SOFT,
    Sun,
    caster,
    ground_shadow,
    upright_shadow,
)
from sextant.streets.street_surface import TEXELS, Texture

TEXEL = 1 / SHADOW_TEXELS
EDGE = 2 * SOFT + TEXEL  # metres


def board(left, right, height, mask=None):
    width = np.linalg.norm(np.subtract(right, left))
    grey = np.zeros((round(height * TEXELS), round(width * TEXELS)), np.float32)
    return caster(np.array(left, float), np.array(right, float), Texture(grey, mask, width, height))


def sun(azimuth_deg, elevation_deg):
    azimuth = np.deg2rad(azimuth_deg)
    return Sun(np.array([np.cos(azimuth), np.sin(azimuth)]), np.tan(np.deg2rad(elevation_deg)))


def extent(shadow, origin=(0.0, 0.0), texels=SHADOW_TEXELS):
    """Least and greatest x and y of a shadow, metres."""
    rows, columns = np.nonzero(shadow > 127)
    x, y = origin[0] + (columns + 0.5) / texels, origin[1] + (rows + 0.5) / texels
    return x.min(), x.max(), y.min(), y.max()


@pytest.mark.parametrize("azimuth, elevation", [(180, 45), (180, 12), (150, 20), (-130, 30)])
def test_the_shadow_of_a_pole_ends_where_the_light_puts_its_top(azimuth, elevation):
    pole, height = board((20.0, 20.0), (20.0, 20.5), 3.0), 3.0
    shadow = ground_shadow([pole], sun(azimuth, elevation), np.array([0.0, 0.0]), 20.0, (800, 800))
    length = height / np.tan(np.deg2rad(elevation))
    away = np.deg2rad(azimuth + 180)
    x, y = 20 + length * np.cos(away), 20 + length * np.sin(away)
    expected = min(20, x), max(20, x), min(20, y), max(20.5, y + 0.5)
    assert extent(shadow, texels=20.0) == pytest.approx(expected, abs=0.2)


def test_a_wall_is_dark_up_to_where_the_shadow_of_a_fence_reaches():
    fence = board((-3.0, -4.0), (3.0, -4.0), 2.0)  # 4 m before the wall, light from behind the fence
    elevation = np.degrees(np.arctan(0.25))
    shadow = upright_shadow([fence], sun(-90, elevation), np.array([-5.0, 0.0]), np.array([5.0, 0.0]), 3.0)
    left, right, top, bottom = extent(shadow)
    assert (left, right) == pytest.approx((2.0, 8.0), abs=EDGE)
    assert top == pytest.approx(3.0 - (2.0 - 4.0 * 0.25), abs=EDGE) and bottom == pytest.approx(3.0, abs=EDGE)


def test_the_shadow_on_the_wall_continues_the_one_on_the_ground():
    """A pole's shadow leaves the ground at the foot of the wall, where the wall's begins."""
    pole, light = board((-2.0, -3.0), (-1.8, -3.0), 4.0), sun(-120, 25)
    left, right = np.array([-5.0, 0.0]), np.array([5.0, 0.0])
    on_wall = upright_shadow([pole], light, left, right, 3.0)
    origin = np.array([-5.0, -5.0])
    on_ground = ground_shadow([pole], light, origin, SHADOW_TEXELS, (240, 240))
    foot = np.flatnonzero(on_wall[-4] > 100).mean()
    before = np.flatnonzero(on_ground[120 - 2] > 100).mean()  # 8 cm before the wall
    assert foot == pytest.approx(before, abs=3)
    assert foot * TEXEL - 5 == pytest.approx(-1.9 + 3 * np.tan(np.deg2rad(30)), abs=EDGE)


def test_what_is_behind_a_wall_casts_no_shadow_on_it():
    behind, light = board((-3.0, 4.0), (3.0, 4.0), 2.0), sun(-90, 20)
    wall = np.array([-5.0, 0.0]), np.array([5.0, 0.0])
    assert not upright_shadow([behind], light, *wall, 3.0).any()
    itself = board(*wall, 3.0)
    assert not upright_shadow([itself], light, *wall, 3.0).any()
    through = board((0.0, -4.0), (0.1, 4.0), 3.0)  # goes through the wall: only its half before it
    shadow = upright_shadow([through], sun(-60, 20), *wall, 3.0)
    assert extent(shadow)[0] == pytest.approx(5 - 4 * np.tan(np.deg2rad(30)), abs=EDGE)
    assert extent(shadow)[1] == pytest.approx(5.0, abs=2 * EDGE)


def test_a_hole_in_an_outline_lets_the_light_through():
    mask = np.full((2 * TEXELS, 4 * TEXELS), 255, np.uint8)
    mask[TEXELS // 2 : 3 * TEXELS // 2, TEXELS : 2 * TEXELS] = 0  # 1 m x 1 m, between heights 0.5 and 1.5 m
    window = board((10.0, 10.0), (10.0, 14.0), 2.0, mask)
    shadow = ground_shadow([window], sun(180, 45), np.array([0.0, 0.0]), 20.0, (400, 400))
    assert shadow[int(11.5 * 20), int(11.0 * 20)] == 0  # the middle of the hole is 1 m high
    assert shadow[int(13.0 * 20), int(11.0 * 20)] == 255
