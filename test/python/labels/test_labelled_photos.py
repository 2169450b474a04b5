# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Boxes and classes of photos."""

from pathlib import Path

import numpy as np
import pytest

from sextant.labels.labelled_photos import (
    LabelledPhotos,
    box_around,
    check_names,
    labelled_photo,
    with_classes,
)


def photo(boxes, classes):
    return labelled_photo(Path("a.png"), (80, 60), boxes, classes)


def test_boxes_are_cut_at_the_border():
    assert photo([[-0.9, 0, 80.5, 60]], [0]).boxes.tolist() == [[0, 0, 80, 60]]


@pytest.mark.parametrize(
    ("box", "reason"),
    [
        ([5, 5, 5, 9], "0 × 4 pixels, it must not be empty"),
        ([9, 5, 5, 9], "it must not be empty"),
        ([0, 0, np.nan, 9], "not finite"),
        ([0, 0, np.inf, 9], "not finite"),
        ([-2, 0, 5, 9], "leaves the photo of 80 × 60 pixels"),
        ([0, 0, 5, 62], "leaves the photo"),
    ],
)
def test_wrong_boxes_are_refused(box, reason):
    with pytest.raises(ValueError, match=reason):
        photo([box], [0])


def test_classes_in_another_order():
    photos = LabelledPhotos(("a", "b", "c"), (photo([[0, 0, 5, 5], [1, 1, 6, 6]], [0, 2]),))
    assert photos.counts().tolist() == [1, 0, 1]
    moved = with_classes(photos, ["c", "a"], "photos")
    assert moved.classes == ("c", "a") and moved.photos[0].classes.tolist() == [1, 0]
    with pytest.raises(ValueError, match="photos: has objects of c; the classes are a, b"):
        with_classes(photos, ["a", "b"], "photos")


def test_a_box_around_points():
    assert box_around([(3, 4), (1, 9), (2, 5)]) == [1, 4, 3, 9]


@pytest.mark.parametrize(
    ("names", "reason"), [([], "at least one"), (["a", " "], "empty"), (["a", "a "], "a is there")]
)
def test_wrong_names_are_refused(names, reason):
    with pytest.raises(ValueError, match=f"names.txt: class names: .*{reason}"):
        check_names(names, "names.txt")
