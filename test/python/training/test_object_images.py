# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rendered images and their ground truth."""

import numpy as np
import pytest

from sextant.training.image_set import drawn_images
from sextant.training.object_images import CLASSES, MIN_SIDE, random_image

SIZE, SEEDS = 160, range(40, 64)


def test_a_seed_is_a_picture():
    first, again, other = random_image(7, SIZE), random_image(7, SIZE), random_image(9, SIZE)
    np.testing.assert_array_equal(first.image, again.image)
    np.testing.assert_array_equal(first.truth.boxes, again.truth.boxes)
    assert np.any(first.image != other.image)


@pytest.mark.slow
def test_boxes_hold_what_looks_like_their_class():
    """The strongest channel in the middle of a box, by the medians over many images."""
    strongest = {name: [] for name in CLASSES}
    for seed in SEEDS:
        picture = random_image(seed, SIZE)
        for (left, top, right, bottom), which, is_counted in zip(*picture.truth):
            assert 0 <= left < right <= 640 and 0 <= top < bottom <= 480
            if is_counted and right - left > 30:
                x, y = int(0.5 * (left + right)), int(0.5 * (top + bottom))
                strongest[CLASSES[which]].append(
                    picture.image[y - 2 : y + 3, x - 2 : x + 3].mean(axis=(0, 1))
                )
    medians = {name: np.median(values, axis=0) for name, values in strongest.items()}
    assert np.argmax(medians["blue_pillar"]) == 2 and np.argmax(medians["green_pillar"]) == 1
    assert np.argmax(medians["red_pillar"]) == 0 and np.argmin(medians["ball"]) == 2


@pytest.mark.slow
def test_a_set_is_letter_boxed_and_filled_up():
    pictures = drawn_images(random_image, SEEDS, SIZE, 1)
    assert pictures.images.shape == (len(SEEDS), SIZE, SIZE, 3) and pictures.images.dtype == np.uint8
    assert np.all(pictures.images[:, :19] == 114) and np.all(
        pictures.images[:, -19:] == 114
    )  # 4:3 in a square
    for truth, seed in zip(pictures.truths(), SEEDS):
        original = random_image(seed, SIZE).truth
        np.testing.assert_allclose(truth.boxes, original.boxes / 4.0 + [0, 20, 0, 20])
        np.testing.assert_array_equal(truth.classes, original.classes)
        sides = (truth.boxes[:, 2:] - truth.boxes[:, :2]).min(axis=1, initial=np.inf)
        assert np.all(sides[truth.is_counted] >= MIN_SIDE)
    assert 0.5 < pictures.is_counted[pictures.exists].mean() < 1.0
