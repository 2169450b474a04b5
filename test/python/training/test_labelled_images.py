# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Images of labelled photos, for training."""

import numpy as np
from made_labels import COLOURS, write_photos

from sextant.training.image_set import joined_sets
from sextant.training.labelled_images import labelled_image_set, with_class_indices


def test_boxes_hold_the_objects_of_the_letter_boxed_photos(tmp_path):
    found = labelled_image_set(write_photos(tmp_path, 6), 160, 1)
    assert found.images.shape == (6, 160, 160, 3) and found.exists.sum() == 15
    for image, truth in zip(found.images, found.truths()):
        for box, each in zip(truth.boxes, truth.classes):
            x, y = (0.5 * (box[:2] + box[2:])).astype(int)
            np.testing.assert_array_equal(image[y, x], COLOURS[each])


def test_sets_are_joined_with_the_classes_of_the_first_one(tmp_path):
    photos = write_photos(tmp_path, 4)
    one = labelled_image_set(photos, 64, 1)
    other = with_class_indices(one, ["goal", "tree"], ["ball", "goal"])  # 0 was a goal, 1 a tree
    assert other.exists.sum() == np.sum(one.classes[one.exists] == 0)
    assert set(other.classes[other.exists]) <= {1}
    joined = joined_sets([one, other])
    assert len(joined.images) == 8 and joined.exists.sum() == one.exists.sum() + other.exists.sum()
    np.testing.assert_array_equal(joined.images[:4], one.images)
