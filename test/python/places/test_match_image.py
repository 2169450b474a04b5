# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Lines between two pictures, looked for where they must be."""

import numpy as np
import pytest

from sextant.place_maps.place_map import Photo
from sextant.place_maps.probability_colours import probability_colour
from sextant.places.match_image import BAR, BORDER, GAP, HEIGHT, MAX_MATCHES, MAX_WIDTH, match_image
from sextant.places.place_matches import MatchedPhoto

GREY = np.full((240, 320), 128, np.uint8)  # shown at twice its size
TALL = np.full((960, 480, 3), 40, np.uint8)  # at half


def matched(*pairs):
    """(x, y, x in the photo, y there, weight) in pixels of both, weights sum up as they are."""
    pairs = np.array(pairs, float).reshape(-1, 5)
    return MatchedPhoto(Photo(3, "3.png", 1, 1), pairs[:, :2] / 320, pairs[:, 2:4] / 960, pairs[:, 4])


def test_images_lie_side_by_side_at_one_height():
    sheet = match_image(GREY, TALL, matched(), "words")
    assert sheet.shape == (HEIGHT + BAR, 640 + GAP + 240, 3)
    assert (sheet[:HEIGHT, :640] == 128).all() and (sheet[:HEIGHT, 640 + GAP :] == 40).all()
    assert (sheet[:HEIGHT, 640 : 640 + GAP] == 255).all()
    assert (sheet[HEIGHT:] < 200).any()  # the words


@pytest.mark.parametrize("shape", [(1, 1), (1, 9000), (9000, 1)])
def test_a_line_of_pixels_makes_no_huge_image(shape):
    sheet = match_image(np.full(shape, 90, np.uint8), GREY, matched(), "")
    assert sheet.shape[0] == HEIGHT + BAR and sheet.shape[1] <= MAX_WIDTH + GAP + 640
    assert (sheet[0, 0] == 90).all()


def test_a_match_is_a_line_between_its_two_points():
    sheet = match_image(GREY, TALL, matched((100, 50, 300, 600, 1.0)), "")
    begin, end = (200, 100), (640 + GAP + 150, 300)
    for x, y in (begin, end):
        assert tuple(sheet[y, x]) == probability_colour(1.0)
        assert tuple(sheet[y, x + 4]) == pytest.approx(BORDER, abs=60)
    middle = np.add(begin, end) // 2
    changed = np.abs(sheet[middle[1] - 2 : middle[1] + 3, middle[0]].astype(int) - 128).max(axis=1)
    assert changed.max() > 60


def test_the_better_the_darker_and_on_top():
    sheet = match_image(GREY, TALL, matched((100, 50, 300, 600, 4.0), (100, 50, 300, 900, 1.0)), "")
    assert tuple(sheet[100, 200]) == probability_colour(1.0)
    assert tuple(sheet[450, 640 + GAP + 150]) == probability_colour(0.25)


def test_only_the_best_are_shown():
    rows = np.linspace(10, 230, 2 * MAX_MATCHES)
    weights = np.where(np.arange(2 * MAX_MATCHES) % 2, 1.0, 0.01)
    pairs = [(20, row, 20, 4 * row, weight) for row, weight in zip(rows, weights)]
    sheet = match_image(GREY, TALL, matched(*pairs), "")
    faint = np.array(probability_colour(0.01))
    assert (np.abs(sheet[:HEIGHT].astype(int) - faint).max(axis=2) < 3).sum() == 0
