# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Labels survive every format."""

import pytest
from made_labels import NAMES, assert_same_labels, write_photos

from sextant.labels.label_formats import WRITERS, read_labels
from sextant.labels.labelled_photos import LabelledPhotos

FILES = {"yolo": "", "coco": "labels.json", "label-studio": "tasks.json"}


@pytest.mark.parametrize("name", WRITERS)
def test_labels_are_read_as_they_were_written(tmp_path, name):
    photos = write_photos(tmp_path / "photos", 6)
    path = tmp_path / "out" / FILES[name]
    path.parent.mkdir(exist_ok=True)
    WRITERS[name](path, photos)
    found = read_labels(path)
    if name == "label-studio":  # knows only the classes that there are, in the order of the first objects
        order = [found.classes.index(each) for each in NAMES]
        assert sorted(order) == [0, 1]
        photos = LabelledPhotos(
            found.classes,
            tuple(photo._replace(classes=[order[each] for each in photo.classes]) for photo in photos.photos),
        )
    assert_same_labels(found, photos)


def test_only_yolo_has_parts(tmp_path):
    photos = write_photos(tmp_path, 2)
    WRITERS["coco"](tmp_path / "labels.json", photos)
    with pytest.raises(ValueError, match="labels.json: only a YOLO folder has a part 'train'"):
        read_labels(tmp_path / "labels.json", "train")
