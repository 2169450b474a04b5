# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Boxes are drawn where they are, also at and beyond the borders."""

import numpy as np
import pytest

from sextant.landmarks.landmark_colours import NAMED
from sextant.objects.detection_image import detection_image
from sextant.objects.detections import NO_DETECTIONS, Detections

CLASSES = ["blue_pillar", "red_pillar"]
GREY = np.full((240, 320, 3), 128, np.uint8)


def drawn(*boxes):
    count = len(boxes)
    found = Detections(np.array(boxes, float), np.linspace(0.9, 0.5, count), np.arange(count) % 2)
    image = detection_image(GREY, found, CLASSES)
    assert image.shape == GREY.shape and image.dtype == np.uint8
    return image


def colour(name):
    return [round(255 * part) for part in NAMED[name]]


def test_a_frame_has_the_colour_of_its_class_and_nothing_inside():
    image = drawn((100, 100, 160, 200), (200, 50, 240, 90))
    assert image[150, 100].tolist() == colour("blue") and image[199, 130].tolist() == colour("blue")
    assert image[70, 200].tolist() == colour("red")
    assert np.all(image[104:196, 104:156] == 128) and np.all(image[:20] == 128)


def test_words_are_above_or_below_if_there_is_no_room():
    assert np.any(drawn((100, 100, 160, 200))[80:97, 100:160] != 128)
    at_top = drawn((100, 0, 160, 150))
    assert np.any(at_top[153:168, 100:160] != 128) and np.all(at_top[10:145, 105:155] == 128)


@pytest.mark.parametrize("box", [(0, 0, 320, 240), (315, 235, 320, 240), (0, 0, 0, 0), (-50, -50, 500, 400)])
def test_borders_are_no_trouble(box):
    assert np.any(drawn(box) != 128)


def test_the_surest_is_on_top():
    image = drawn((100, 100, 160, 200), (100, 100, 160, 200))
    assert image[150, 100].tolist() == colour("blue")


def test_the_picture_itself_stays_as_it_was():
    before = GREY.copy()
    assert np.array_equal(detection_image(GREY, NO_DETECTIONS, CLASSES), before)
    drawn((10, 10, 50, 50))
    assert np.array_equal(GREY, before)
