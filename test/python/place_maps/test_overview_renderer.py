# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Answers on an overview: colours where the places are, words, and nothing outside the picture."""

import numpy as np
import pytest
from PIL import Image

from sextant.place_maps.overview_backdrop import DARKEST, LIGHTEST, backdrop, subdued
from sextant.place_maps.overview_renderer import PLACE, TRAIL, Hypothesis, OverviewRenderer, text_of
from sextant.place_maps.place_map import Overview, Photo, PlaceMap
from sextant.place_maps.probability_colours import probability_bar, probability_colour

UNKNOWN_PLACE = [Hypothesis(0, 0.0)]
LUMA = np.array([0.2126, 0.7152, 0.0722])  # of sRGB, IEC 61966-2-1


def place_map(folder, positions, size=(400, 200), grey=200):
    Image.new("RGB", size, (grey, grey, grey)).save(folder / "park.png")
    photos = [Photo(i, f"{i}.jpg", float(x), float(y)) for i, (x, y) in enumerate(positions)]
    return PlaceMap(folder, Overview("park.png", *size), tuple(photos))


def colour_at(picture, x, y):
    """Of the pixel that has this point."""
    return tuple(picture[int(y), int(x)].tolist())


POSITIONS = [(50, 50), (150, 50), (250, 150), (350, 150)]


def test_places_are_dots_where_the_map_has_them(tmp_path):
    picture = OverviewRenderer(place_map(tmp_path, POSITIONS)).draw()
    assert picture.dtype == np.uint8 and picture.shape[1] == 800
    for x, y in POSITIONS:  # the overview is shown at twice its size
        assert colour_at(picture, 2 * x, 2 * y) == PLACE
    dots = np.argwhere((picture[:400] == PLACE).all(axis=2))
    left = dots[dots[:, 1] < 200]
    np.testing.assert_allclose(left.mean(axis=0) + 0.5, [100, 100], atol=0.4)  # OpenCV fills so


def test_hypotheses_have_the_colours_of_their_probabilities(tmp_path):
    answer = [Hypothesis(2, 0.1), Hypothesis(0, 0.6), Hypothesis(3, 0.25)]
    picture = OverviewRenderer(place_map(tmp_path, POSITIONS)).draw(answer)
    for number, probability in answer:
        x, y = POSITIONS[number]
        assert colour_at(picture, 2 * x, 2 * y) == probability_colour(probability)
    assert colour_at(picture, 300, 100) == PLACE


def test_the_best_one_is_the_largest(tmp_path):
    drawn = OverviewRenderer(place_map(tmp_path, POSITIONS))
    picture, empty = drawn.draw([Hypothesis(0, 0.6), Hypothesis(2, 0.4)]), drawn.draw(UNKNOWN_PLACE)
    changed = (picture != empty).any(axis=2)[:400]
    best, other = changed[:200, :200].sum(), changed[200:, 400:600].sum()
    assert best > 1.5 * other > 0
    assert drawn.radii.place < drawn.radii.hypothesis < drawn.radii.best


def test_a_place_that_the_map_does_not_have_is_left_out(tmp_path):
    drawn = OverviewRenderer(place_map(tmp_path, POSITIONS))
    assert 77 not in drawn.at
    known = drawn.draw([Hypothesis(0, 0.6)])
    np.testing.assert_array_equal(drawn.draw([Hypothesis(0, 0.6), Hypothesis(77, 0.9)], [77]), known)


def test_the_trail_fades(tmp_path):
    positions = [(40 + 60 * i, 100) for i in range(6)]
    drawn = OverviewRenderer(place_map(tmp_path, positions))
    picture = drawn.draw(UNKNOWN_PLACE, list(range(6)))
    colours = np.array([colour_at(picture, 2 * x, 2 * y) for x, y in positions], float)
    distances = np.linalg.norm(colours - TRAIL, axis=1)
    assert np.all(np.diff(distances) < 0)
    assert tuple(picture[200, 2 * 70]) != tuple(drawn.draw(UNKNOWN_PLACE)[200, 2 * 70])  # a line joins them


def test_ids_stand_beside_likely_places_only_and_inside(tmp_path):
    corners = [(0, 0), (400, 0), (0, 200), (400, 200), (200, 100)]
    drawn = OverviewRenderer(place_map(tmp_path, corners))
    picture = drawn.draw([Hypothesis(i, 0.19) for i in range(5)])
    empty = drawn.draw(UNKNOWN_PLACE)
    changed = (picture != empty).any(axis=2)[:400]
    quiet = (drawn.draw([Hypothesis(i, 0.01) for i in range(5)]) != empty).any(axis=2)[:400]
    assert changed.sum() > 1.1 * quiet.sum()
    for rows in ((0, 40), (360, 400)):
        for columns in ((0, 60), (740, 800)):
            part = slice(*rows), slice(*columns)
            assert changed[part].sum() > 1.1 * quiet[part].sum()


@pytest.mark.parametrize(
    "size, max_side, shape",
    [((4000, 2000), 1000, (500, 1000)), ((400, 200), 1000, (400, 800)), ((100, 400), 300, (300, 75))],
)
def test_the_overview_is_shown_large_enough_but_not_too_large(tmp_path, size, max_side, shape):
    assert backdrop(place_map(tmp_path, [], size), max_side).shape == (*shape, 3)


def test_the_map_has_the_shape_of_the_overview(tmp_path):
    stretched = place_map(tmp_path, [(30, 10)], (400, 200))._replace(overview=Overview("park.png", 100, 100))
    drawn = OverviewRenderer(stretched)
    assert drawn.backdrop.shape == (800, 800, 3)
    assert colour_at(drawn.draw(), 240, 80) == PLACE


@pytest.mark.parametrize("low, high", [(0, 40), (0, 255), (200, 255), (128, 128)])
def test_every_overview_becomes_light_and_pale(low, high):
    rng = np.random.default_rng(1)
    ground = subdued(rng.integers(low, high + 1, (50, 60, 3)).astype(np.uint8)).astype(float)
    grey = ground @ [0.299, 0.587, 0.114]
    assert grey.min() > DARKEST - 12
    assert grey.max() < LIGHTEST + 6
    assert grey.mean() - np.mean(PLACE) > 80


def test_colour_of_the_overview_is_weak_but_there():
    red = subdued(np.full((8, 8, 3), (200, 40, 40), np.uint8))[0, 0].astype(int)
    difference = red[0] - red[1]
    assert 20 < difference < 80


def test_darker_is_likelier():
    """In steps of the same size to the eye, about: CIE L* of sRGB."""
    bar = probability_bar(101, 2)
    linear = (bar[0] / 255.0) ** 2.2
    lightness = 116 * np.cbrt(linear @ LUMA) - 16
    steps = np.diff(lightness[::10])
    assert np.all(steps < -3) and np.all(steps > -12)
    assert tuple(bar[0, 0]) == probability_colour(0.0)
    assert probability_colour(-1.0) == probability_colour(0.0)
    assert tuple(bar[0, -1]) == probability_colour(1.0)
    assert probability_colour(1.1) == probability_colour(1.0)


def test_the_scale_is_in_the_image(tmp_path):
    strip = OverviewRenderer(place_map(tmp_path, POSITIONS)).draw()[400:]
    bar = probability_bar(180, 12)
    found = [
        (row, column)
        for row, column in np.argwhere((strip == probability_colour(0.0)).all(axis=2))
        if np.array_equal(strip[row : row + 12, column : column + 180], bar)
    ]
    assert len(found) == 1


@pytest.mark.parametrize(
    "answer, words",
    [
        (None, ("No result yet", "9 places in this map")),
        ([], ("Unknown place", "9 places in this map")),
        (UNKNOWN_PLACE, ("Unknown place", "9 places in this map")),
        ([(5, 1.0)], ("Place 5: 100 %", "9 places in this map")),
        ([(5, 0.6), (6, 0.3)], ("Place 5: 60 %", "6: 30 %, none of these: 10 %")),
        (
            [(5, 0.6), (6, 0.2), (7, 0.1), (8, 0.099), (1, 0.001)],
            ("Place 5: 60 %", "6: 20 %, 7: 10 %, 2 more"),
        ),
        ([(5, 0.2), (6, 0.1)], ("Probably none of these: 70 %", "place 5: 20 %, 6: 10 %")),
        ([(5, 0.001)], ("Probably none of these: 100 %", "place 5: < 1 %")),
    ],
)
def test_text_of_hypotheses(answer, words):
    hypotheses = None if answer is None else [Hypothesis(*each) for each in answer]
    assert text_of(hypotheses, [each for each in hypotheses or [] if each.probability > 0], 9) == words


def test_an_unknown_place_is_shown(tmp_path):
    drawn = OverviewRenderer(place_map(tmp_path, POSITIONS))
    nowhere, nothing_yet = drawn.draw(UNKNOWN_PLACE), drawn.draw()
    np.testing.assert_array_equal(nowhere[:400], nothing_yet[:400])
    assert (nowhere[400:] != nothing_yet[400:]).any()


@pytest.mark.parametrize("ids", [[], [0], [7, 2**31 - 1]])
def test_a_narrow_overview_has_room_for_words(tmp_path, ids):
    narrow = place_map(tmp_path, [(5, 5)], (10, 400))
    narrow = narrow._replace(
        photos=tuple(Photo(number, "a.jpg", 5.0, 5.0 + 40 * (number % 9)) for number in ids)
    )
    drawn = OverviewRenderer(narrow)
    picture = drawn.draw([Hypothesis(number, 0.4) for number in ids])
    assert picture.shape == (856, 520, 3)
    assert all(colour_at(picture, *drawn.at[number]) == probability_colour(0.4) for number in ids)


def test_an_overview_that_is_not_there_is_named(tmp_path):
    lacking = PlaceMap(tmp_path, Overview("park.png", 10, 10))
    with pytest.raises(OSError, match="park.png"):
        OverviewRenderer(lacking)
