# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Brightness of walls by the cosine of the light, their relief, rain and shadows."""

import numpy as np
import pytest

from sextant.streets.street_conditions import StreetConditions
from sextant.streets.street_light import GAIN, RELIEF, SOAKED, lit
from sextant.streets.street_shadows import caster
from sextant.streets.street_surface import TEXELS, Texture

WALL = np.array([-2.0, 0.0]), np.array([2.0, 0.0])  # faces -y
PLAIN = Texture(np.full((2 * TEXELS, 4 * TEXELS), 100.0, np.float32), None, 4.0, 2.0)


def light(azimuth_deg, **changed):
    return StreetConditions(sun=np.deg2rad(azimuth_deg), direct=0.8, sun_height=0.3, cast=True, **changed)


@pytest.mark.parametrize("angle", [0, 40, -70])
def test_a_wall_is_lit_by_the_cosine_of_the_light(angle):
    grey = lit(PLAIN, *WALL, light(-90 + angle), [])
    assert grey == pytest.approx(100 * (0.2 + 0.8 * GAIN * np.cos(np.deg2rad(angle))), rel=1e-4)


def test_a_wall_that_turns_away_has_diffuse_light_only():
    assert lit(PLAIN, *WALL, light(90), []) == pytest.approx(20.0)


def test_so_has_a_wall_in_the_shade():
    before = caster(np.array([-9.0, -1.0]), np.array([9.0, -1.0]), Texture(PLAIN.grey, None, 18.0, 5.0))
    assert lit(PLAIN, *WALL, light(-90), [before]) == pytest.approx(20.0, abs=0.5)


def test_the_bright_side_of_what_protrudes_is_that_of_the_sun():
    grey = PLAIN.grey.copy()
    grey[:, 200:210] += 20.0  # a pilaster
    texture = Texture(grey, None, 4.0, 2.0)
    for angle, edges in ((-30, (200, 211)), (30, (209, 198))):
        seen = lit(texture, *WALL, light(-90 + angle), [])
        row = seen[100] / seen[100, 50] * 100
        bright, dark = (row[edge] for edge in edges)
        assert bright - 120 == pytest.approx(RELIEF * 0.8 * 20, abs=3), angle
        assert dark - 100 == pytest.approx(-RELIEF * 0.8 * 20, abs=3), angle


def test_rain_darkens_walls_most_at_their_foot():
    wet, dry = (lit(PLAIN, *WALL, light(90, wet=share), []) for share in (1.0, 0.0))
    assert np.all(wet <= dry + 1e-3) and np.all(wet >= (1 - SOAKED) * dry - 1e-3)
    assert wet[-10:].mean() < 0.7 * 20 and wet[-10:].mean() < wet[:100].mean() - 1
