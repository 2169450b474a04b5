# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The most common displacement of matches whose displacement is known."""

import numpy as np
import pytest

from sextant.places.place_verification import CELL, displacement_support

RNG = np.random.default_rng(1)
XY = RNG.uniform(0, 1, (60, 2))


def support(photo_xy, weights=None, groups=None, count=1):
    weights = np.ones(len(XY)) if weights is None else weights
    return displacement_support(
        XY, photo_xy, weights, np.zeros(len(XY), int) if groups is None else groups, count
    )


def test_one_displacement_has_all_the_weight():
    whole = np.array([3, -2]) * CELL  # the middle of a cell
    assert support(XY + whole) == pytest.approx([60])


@pytest.mark.parametrize("shift", [(0.013, 0.047), (0.05, 0.05)])
def test_the_borders_of_cells_cost_at_most_three_quarters(shift):
    assert support(XY + np.array(shift))[0] >= 60 / 4 - 1e-9


def test_scattered_matches_have_little():
    assert support(RNG.uniform(0, 1, (60, 2)))[0] < 8


def test_a_part_that_agrees_stands_out():
    photo_xy = RNG.uniform(0, 1, (60, 2))
    photo_xy[:20] = XY[:20] + 2 * CELL
    assert 20 <= support(photo_xy)[0] < 25


def test_weights_are_summed_group_by_group():
    groups = np.repeat([0, 2], 30)
    weights = np.where(groups == 0, 0.5, 2.0)
    assert support(XY, weights, groups, 3) == pytest.approx([15, 0, 60])


def test_displacements_beyond_reach_do_no_harm():
    assert np.all(np.isfinite(support(XY + 100.0)))


def test_no_match_no_support():
    none = np.zeros((0, 2))
    assert displacement_support(none, none, np.zeros(0), np.zeros(0, int), 2).tolist() == [0, 0]
