# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Collections of pictures whose differences are known."""

import json

import cv2
import numpy as np
import pytest
from made_photos import picture

from sextant.images.photo_depth import encoded_depth, read_photo_depth
from sextant.labels.picture_collection import CollectionParams, PictureCollection


def view(seed, brightness=1.0, blur=0.0):
    """A picture of its own view."""
    image = cv2.cvtColor(picture(seed, (96, 72)), cv2.COLOR_GRAY2BGR)
    image = np.clip(image * brightness, 0, 255).astype(np.uint8)
    return cv2.GaussianBlur(image, (0, 0), blur) if blur else image


def test_views_and_lights_that_differ_are_kept(tmp_path):
    collection = PictureCollection(tmp_path / "a")
    assert [collection.offer(str(i), view(i)) for i in range(4)] == [True] * 4
    assert not collection.offer("again", view(2))
    assert collection.offer("dim", view(2, 0.5))
    assert collection.counts == {"kept": 5, "like another one": 1}
    assert collection.summary() == [f"{tmp_path}/a: 5 pictures; dropped: 1 like another one"]


def test_blurred_and_dark_pictures_are_dropped(tmp_path):
    collection = PictureCollection(tmp_path)
    for i in range(5):
        collection.offer(str(i), view(i))
    assert not collection.offer("blurred", view(9, blur=2.0))
    assert not collection.offer("dark", np.full((72, 96, 3), 4, np.uint8))
    assert collection.counts == {"kept": 5, "blurred": 1, "dark or white": 1}


def test_pictures_are_spread_over_a_drive_of_any_length(tmp_path):
    """A slow turn: neighbours are alike, and the later half is as well represented as the first one."""
    wide = cv2.cvtColor(picture(3, (1200, 72)), cv2.COLOR_GRAY2BGR)
    wide = cv2.GaussianBlur(wide, (0, 0), 6)
    wide += np.random.default_rng(1).integers(0, 3, wide.shape, dtype=np.uint8)
    collection = PictureCollection(tmp_path, CollectionParams(count=12, difference=2.0))
    for i in range(0, 1100, 4):
        collection.offer(f"{i:04d}", wide[:, i : i + 96])
    numbers = [int(path.stem) for path in sorted(tmp_path.glob("*.jpg"))]
    assert 6 <= len(numbers) == len(collection) <= 12
    assert np.diff(numbers).min() >= 20 and sum(number > 550 for number in numbers) >= 3
    counts = collection.counts
    assert sum(counts.values()) == 275 and counts["kept"] == len(numbers) and counts["thinned out"] > 0


def test_a_collection_is_continued(tmp_path):
    first = PictureCollection(tmp_path)
    first.offer("0", view(0)), first.offer("1", view(1, 0.1)), first.write_counts()
    again = PictureCollection(tmp_path)
    assert not again.offer("0", view(0)) and not again.offer("new", view(0)) and again.offer("2", view(2))
    again.write_counts()
    counts = json.loads((tmp_path / "collected.json").read_text())
    assert counts["kept"] == len(again) == len(list(tmp_path.glob("*.jpg")))
    assert counts["already there"] == 1
    (tmp_path / "collected.json").write_text("{")
    with pytest.raises(ValueError, match="collected.json: is damaged, remove it"):
        PictureCollection(tmp_path)


def test_a_full_folder_gets_the_pictures_of_another_day(tmp_path):
    params = CollectionParams(count=5)
    for day in range(2):
        collection = PictureCollection(tmp_path, params)
        for seed in range(20 * day, 20 * day + 12):
            collection.offer(str(seed), view(seed))
    names = sorted(int(path.stem) for path in tmp_path.glob("*.jpg"))
    assert 3 <= sum(name < 20 for name in names) <= 5 and 3 <= sum(name >= 20 for name in names) <= 5


def test_depth_goes_with_a_picture_that_is_deleted(tmp_path):
    collection = PictureCollection(tmp_path, CollectionParams(count=2, difference=0.5))
    depth = np.full((72, 96), 1.5, np.float32)
    for number in range(6):  # slowly brighter: neighbours are the most similar ones
        image = np.clip(view(0) * (0.5 + 0.06 * number), 0, 255).astype(np.uint8)
        if collection.offer(str(number), image):
            collection.add_depth(str(number), encoded_depth(depth))
    pictures = {path.name for path in tmp_path.glob("*.jpg")}
    assert len(pictures) == len(collection) <= 2 and collection.counts["thinned out"] > 0
    assert {path.name for path in tmp_path.glob("*.depth")} == {f"{name}.depth" for name in pictures}
    assert read_photo_depth(tmp_path / sorted(pictures)[0])[0, 0] == pytest.approx(1.5)


def test_pictures_that_were_there_are_never_deleted(tmp_path):
    (tmp_path / "holiday").mkdir()
    for number in range(4):
        cv2.imwrite(str(tmp_path / f"mine{number}.png"), view(number))
        cv2.imwrite(str(tmp_path / f"holiday/{number}.png"), view(10 + number))
    collection = PictureCollection(tmp_path, CollectionParams(count=3))
    for number in range(20, 24):
        collection.offer(str(number), view(number))
    assert len(list(tmp_path.rglob("*.png"))) == 8 and 1 <= len(list(tmp_path.glob("*.jpg"))) <= 3


def test_a_black_picture_is_dropped(tmp_path):
    collection = PictureCollection(tmp_path, CollectionParams(min_contrast=0.0))
    assert not collection.offer("black", np.zeros((72, 96, 3), np.uint8))
