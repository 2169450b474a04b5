# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Letterboxing of an image, and transformation of boxes."""

import numpy as np
import pytest

from sextant.objects.letter_box import GREY, blob_of, letter_box, letterboxed

SIZES = [(640, 480), (480, 640), (641, 333), (100, 100), (31, 1000), (7, 2000)]


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("taken", [(160, 160), (256, 192)])
def test_boxes_come_back(size, taken):
    box = letter_box(size, taken)
    assert max(box.inner[0] / taken[0], box.inner[1] / taken[1]) == 1.0
    width, height = size
    boxes = np.array([[0, 0, width, height], [0.1 * width, 0.3 * height, 0.7 * width, 0.9 * height]])
    there = box.to_input(boxes)
    assert there[0] == pytest.approx(
        [box.left, box.top, box.left + box.inner[0], box.top + box.inner[1]], abs=1e-9
    )
    assert box.to_image(there, size) == pytest.approx(boxes, abs=1e-9)


def test_boxes_are_cut_at_the_borders():
    box = letter_box((640, 480), (160, 160))
    assert box.to_image(np.array([[-5.0, 0.0, 170.0, 150.0]]), (640, 480)).tolist() == [[0, 0, 640, 480]]


def test_a_picture_of_four_by_three_has_grey_above_and_below():
    image = np.full((480, 640, 3), (200, 10, 30), np.uint8)
    blob = blob_of(image, letter_box((640, 480), (160, 160)), (160, 160))
    assert blob.shape == (1, 3, 160, 160) and blob.dtype == np.float32
    expected = np.full((3, 160, 160), GREY / 255.0)
    expected[:, 20:140] = np.array([200, 10, 30])[:, None, None] / 255.0
    assert blob[0] == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("size, taken", [((640, 480), (160, 160)), ((50, 30), (128, 96))])
def test_what_is_seen_is_inside_its_box(size, taken):
    """A white rectangle on black, found again by its brightness."""
    image = np.zeros((size[1], size[0], 3), np.uint8)
    low, high = np.array(size) // 5, np.array(size) // 2
    image[low[1] : high[1], low[0] : high[0]] = 255
    box = letter_box(size, taken)
    inside = letterboxed(image, box, taken)[
        box.top : box.top + box.inner[1], box.left : box.left + box.inner[0], 0
    ]
    rows, columns = inside.sum(axis=1, dtype=float), inside.sum(axis=0, dtype=float)
    x0, y0, x1, y1 = box.to_input(np.array([[*low, *high]], float))[0]
    assert [x1 - x0, y1 - y0] == pytest.approx([rows.max() / 255, columns.max() / 255], abs=0.6)
    middle = [columns @ (np.arange(len(columns)) + 0.5), rows @ (np.arange(len(rows)) + 0.5)] / inside.sum(
        dtype=float
    )
    assert middle + [box.left, box.top] == pytest.approx([0.5 * (x0 + x1), 0.5 * (y0 + y1)], abs=0.1)
