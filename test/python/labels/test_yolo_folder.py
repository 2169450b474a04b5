# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Folders of photos with YOLO's label files."""

from pathlib import Path

import numpy as np
import pytest
from made_labels import NAMES, write_photos

from sextant.images.photo_depth import depth_path, encoded_depth
from sextant.labels.yolo_folder import read_yolo_folder, write_yolo_folder, yolo_parts

BLIMP = Path(__file__).resolve().parents[4] / "shared/data/objects/blimp"


@pytest.fixture()
def folder(tmp_path):
    """A folder with one photo of 80 × 60 pixels."""
    write_photos(tmp_path / "train/images", 1)
    (tmp_path / "train/labels").mkdir()
    (tmp_path / "data.yaml").write_text("train: train/images\nval: train/images\nnames: [ball, goal]\n")
    return tmp_path


def labelled(folder, text):
    (folder / "train/labels/0.txt").write_text(text)
    return read_yolo_folder(folder, "train").photos[0]


def test_fractions_are_of_the_photo(folder):
    photo = labelled(folder, "1 0.5 0.5 0.25 0.5\n\n0 0.1 0.1 0.2 0.2\n")
    np.testing.assert_allclose(photo.boxes, [[30, 15, 50, 45], [0, 0, 16, 12]], atol=1e-9)
    assert photo.classes.tolist() == [1, 0]


def test_a_polygon_has_a_box(folder):
    photo = labelled(folder, "0 0.25 0.5 0.5 0.1 0.75 0.5 0.5 0.9 0.25 0.5")
    np.testing.assert_allclose(photo.boxes, [[20, 6, 60, 54]], atol=1e-9)


def test_a_photo_without_label_file_has_no_objects(folder):
    (photo,) = read_yolo_folder(folder / "data.yaml").photos[:1]
    assert photo.boxes.shape == (0, 4) and not len(photo.classes)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("0 0.5 0.5 0.2", ":1: has 4 numbers"),
        ("0 0.5 0.5 0.2 0.2\n0 0.5 0.5 0.2 0.2 0.9", ":2: has 6 numbers"),
        ("2 0.5 0.5 0.2 0.2", ":1: its class is 2, it must be a whole number from 0 to 1"),
        ("-1 0.5 0.5 0.2 0.2", "its class is -1"),
        ("0.0 0.5 0.5 0.2 0.2", "its class is 0.0"),
        ("0 0.5 0.5 x 0.2", "are not numbers"),
        ("0 0.5 0.5 nan 0.2", "not finite"),
        ("0 0.5 0.5 0 0.2", "must not be empty"),
        ("0 0.5 0.5 -0.2 0.2", "must not be empty"),
        ("0 0.9 0.5 0.4 0.2", "leaves the photo of 80 × 60"),
        ("0 0.1 0.1 5 0.2 7 8", "leaves the photo"),
    ],
)
def test_wrong_lines_are_refused_with_their_number(folder, text, reason):
    with pytest.raises(ValueError, match=f"train/labels/0.txt{'' if reason[0] == ':' else ':1: '}.*{reason}"):
        labelled(folder, text)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("train: [", "is not YAML"),
        ("- a", "must have the fields names, train and val"),
        ("train: train/images", "names must be a list"),
        ("train: train/images\nnames: {1: ball}", "names must be a list"),
        ("train: train/images\nnames: {0: ball, goal: 1}", "names must be a list"),
        ("train: train/images\nnames: [ball, ball]", "ball is there twice"),
        ("names: [ball]", "has no part train"),
        ("train: elsewhere\nnames: [ball]", "there is no folder .*elsewhere"),
    ],
)
def test_a_wrong_table_is_refused(folder, text, reason):
    (folder / "data.yaml").write_text(text)
    with pytest.raises(ValueError, match=f"data.yaml: .*{reason}"):
        read_yolo_folder(folder, "train")


def test_labels_without_a_photo_are_refused(folder):
    (folder / "train/labels/lost.txt").write_text("0 0.5 0.5 0.2 0.2")
    with pytest.raises(ValueError, match="labels/lost.txt: there is no photo for it"):
        read_yolo_folder(folder)


def test_a_folder_with_classes_txt(tmp_path):
    photos = write_photos(tmp_path / "images", 2)
    (tmp_path / "labels").mkdir()
    (tmp_path / "classes.txt").write_text("ball\ngoal\n")
    found = read_yolo_folder(tmp_path)
    assert found.classes == NAMES and len(found.photos) == len(photos.photos)
    with pytest.raises(ValueError, match="no data.yaml, so there is no part 'train'"):
        read_yolo_folder(tmp_path, "train")
    (tmp_path / "classes.txt").unlink()
    with pytest.raises(ValueError, match="has neither data.yaml nor classes.txt"):
        read_yolo_folder(tmp_path)


def test_photos_of_the_same_name_are_not_written(tmp_path):
    one, other = write_photos(tmp_path / "a", 2), write_photos(tmp_path / "b", 2)
    with pytest.raises(ValueError, match="have the same name"):
        write_yolo_folder(tmp_path / "out", one._replace(photos=one.photos + other.photos))


def test_every_tenth_photo_is_for_validation(tmp_path):
    photos = write_photos(tmp_path / "photos", 25)
    write_yolo_folder(tmp_path / "data", photos)
    assert yolo_parts(tmp_path / "data") == ("train", "valid")
    parts = [read_yolo_folder(tmp_path / "data", part) for part in ("train", "valid")]
    assert [len(part.photos) for part in parts] == [23, 2]
    write_yolo_folder(tmp_path / "whole", photos, hold_out=0)
    assert yolo_parts(tmp_path / "whole") == ("train",)


def test_a_folder_is_added_to_with_the_same_classes_only(tmp_path):
    one, other = write_photos(tmp_path / "a", 3), write_photos(tmp_path / "b", 3, seed=5)
    write_yolo_folder(tmp_path / "data", one, 0)
    with pytest.raises(ValueError, match="data.yaml: has other classes, or in another order"):
        write_yolo_folder(tmp_path / "data", one._replace(classes=one.classes[::-1]), 0)
    with pytest.raises(ValueError, match="2.png: is another photo than"):
        write_yolo_folder(tmp_path / "data", other._replace(photos=other.photos[2:]), 0)
    renamed = []
    for photo in other.photos:
        path = photo.path.with_name(f"more{photo.path.name}")
        photo.path.rename(path)
        renamed.append(photo._replace(path=path))
    depth_path(renamed[0].path).write_bytes(encoded_depth(np.ones((4, 4), np.float32)))
    write_yolo_folder(tmp_path / "data", other._replace(photos=tuple(renamed)), 0)
    assert len(read_yolo_folder(tmp_path / "data").photos) == 6
    assert depth_path(tmp_path / "data/train/images/more0.png").exists()


def test_a_photo_that_is_added_again_stays_in_its_part(tmp_path):
    photos = write_photos(tmp_path / "photos", 10)
    out = tmp_path / "data"
    write_yolo_folder(out, photos)
    (out / "data.yaml").write_text((out / "data.yaml").read_text() + "test: test/images\n")
    write_yolo_folder(out, photos._replace(photos=photos.photos[::-1]))
    assert [len(read_yolo_folder(out, part).photos) for part in ("train", "valid")] == [9, 1]
    assert "test" in yolo_parts(out)
    (out / "data.yaml").write_text("train: elsewhere\nnames: [ball, goal]\n")
    with pytest.raises(ValueError, match="a folder with train: train/images only"):
        write_yolo_folder(out, photos)


def test_a_folder_without_labels_is_refused(folder):
    (folder / "train/labels").rmdir()
    with pytest.raises(ValueError, match="train/images: there is no folder .*train/labels with its labels"):
        read_yolo_folder(folder)


def test_paths_of_roboflow(folder):
    (folder / "data.yaml").write_text("train: ../train/images\nnames: [ball, goal]\n")
    assert len(read_yolo_folder(folder).photos) == 1


@pytest.mark.skipif(not BLIMP.is_dir(), reason="external test data")
def test_labels_of_real_photos():
    """Counted by another program."""
    found = [read_yolo_folder(BLIMP, part) for part in ("train", "valid")]
    assert [len(each.photos) for each in found] == [2000, 255]
    assert sum(each.counts() for each in found).tolist() == [549, 633, 869, 555, 707, 906, 807, 1170]
