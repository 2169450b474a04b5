# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Photos of coloured rectangles, with labels."""

import numpy as np
from PIL import Image

from sextant.labels.labelled_photos import LabelledPhotos, labelled_photo

NAMES = ("ball", "goal")
COLOURS = {0: (230, 140, 20), 1: (30, 60, 200)}
SIZE = (80, 60)


def write_photos(folder, count=3, size=SIZE, seed=1):
    """Photos 0.png, 1.png ... with as many objects as their number; the first has none."""
    folder.mkdir(parents=True, exist_ok=True)
    random = np.random.default_rng(seed)
    photos = []
    for number in range(count):
        image = np.full((size[1], size[0], 3), 110, np.uint8) + random.integers(0, 20, 3, dtype=np.uint8)
        boxes, classes = [], []
        for i in range(number):
            left, top = 2 + 20 * (i % 4), 4 + 28 * (i // 4 % 2)
            width, height = random.integers(8, 17, 2)
            boxes.append([left, top, left + width, top + height])
            classes.append(int(random.integers(2)))
            image[top : top + height, left : left + width] = COLOURS[classes[-1]]
        path = folder / f"{number}.png"
        Image.fromarray(image).save(path)
        photos.append(labelled_photo(path, size, boxes, classes))
    return LabelledPhotos(NAMES, tuple(photos))


def assert_same_labels(found, expected, tolerance=0.01):
    assert found.classes == expected.classes
    pairs = list(zip(*(sorted(each.photos, key=lambda photo: photo.path.name) for each in (found, expected))))
    assert len(pairs) == len(found.photos) == len(expected.photos)
    for one, other in pairs:
        assert one.path.name == other.path.name
        assert one.size == other.size and one.path.read_bytes() == other.path.read_bytes()
        np.testing.assert_allclose(one.boxes, other.boxes, atol=tolerance)
        np.testing.assert_array_equal(one.classes, other.classes)
