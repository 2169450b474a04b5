# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Distances of places that are laid out by hand."""

import numpy as np
import pytest

from sextant.places.place_spacing import neighbour_radius, spacing_of


def line(count, spacing=2.0):
    return np.c_[spacing * np.arange(count), np.zeros(count)]


def test_the_spacing_is_that_of_neighbours():
    assert spacing_of(np.r_[line(9), [[100, 0]]]) == 2.0
    assert spacing_of(np.zeros((3, 2))) == spacing_of(line(1)) == 1.0


@pytest.mark.parametrize(
    "positions, expected",
    [
        (line(100), 20.0),  # ten spacings
        (line(11), 4.8),  # a share of the extent
        (line(5), 1.92),  # each of a few spots is another place
        (np.repeat(line(100), 2, axis=0), 20.0),  # two photos at each place
        (np.zeros((3, 2)), 0.0),
        (line(1), 0.0),
    ],
)
def test_neighbours_are_within_some_spacings_and_a_share_of_the_extent(positions, expected):
    assert neighbour_radius(positions) == pytest.approx(expected)
