# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Snow lies on top of things: on ledges as deep as set, at the foot of walls, and on outlines."""

import numpy as np
import pytest

from sextant.streets import street_snow
from sextant.streets.street_surface import SNOW, TEXELS


def dark(rows=200, columns=400):
    return np.full((rows, columns), 50.0, np.float32)


def test_a_heap_lies_on_its_ledge_and_is_as_deep_as_set():
    grey, ledge = dark(), (100, 300, 120)
    street_snow.on_ledges(np.random.default_rng(1), grey, [ledge], 0.2)
    rows, columns = np.nonzero(grey > 150)
    assert (columns.min(), columns.max(), rows.max()) == pytest.approx((100, 300, 120), abs=2)
    assert (grey > 150)[:, 150:250].sum(axis=0).mean() == pytest.approx(0.2 * TEXELS, rel=0.15)


def test_a_drift_lies_along_the_foot():
    grey = dark(3 * TEXELS)
    street_snow.at_foot(np.random.default_rng(1), grey)
    white = grey > 150
    assert white[-3:].mean() > 0.9 and not white[:TEXELS].any()


def test_an_outline_is_white_from_above_to_its_depth():
    grey, mask = dark(), np.zeros((200, 400), np.uint8)
    mask[50:150, 100:300] = 255
    street_snow.on_outline(grey, mask, 8)
    assert np.all(grey[50:58, 100:300] == SNOW) and np.count_nonzero(grey == SNOW) == 8 * 200


def test_roofs_have_more_of_it_in_season_snow():
    cover = []
    for season in ("winter", "snow"):
        roof = dark()
        street_snow.on_roof(np.random.default_rng(1), roof, season)
        cover.append(np.mean(roof > 180))
    assert cover[1] > cover[0] > 0.3
