# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Images of hard rooms and of photographs, and their ground truth."""

import cv2
import numpy as np
import pytest

from sextant.objects.object_kinds import KINDS
from sextant.training.hard_images import (
    EMPTY,
    HALL,
    PhotoImages,
    hard_image,
    joined_with,
    painted,
    recoloured,
    wide_paint,
)
from sextant.training.image_set import drawn_images
from sextant.training.object_images import HEIGHT, WIDTH, random_clutter

SIZE, SEEDS = 160, range(60)


@pytest.fixture(scope="module")
def photos(tmp_path_factory):
    folder = tmp_path_factory.mktemp("photos")
    for number, (rows, columns) in enumerate([(480, 640), (900, 500), (300, 1200)]):
        cv2.imwrite(str(folder / f"{number}.png"), np.full((rows, columns, 3), 120, np.uint8))
    return PhotoImages([folder])


def test_a_seed_is_a_hard_image():
    first, again, other = hard_image(7, SIZE), hard_image(7, SIZE), hard_image(9, SIZE)
    np.testing.assert_array_equal(first.image, again.image)
    np.testing.assert_array_equal(first.truth.boxes, again.truth.boxes)
    assert np.any(first.image != other.image)


@pytest.mark.slow
def test_hard_images_have_objects_of_every_class():
    drawn = [hard_image(seed, SIZE) for seed in SEEDS]
    classes = np.concatenate([each.truth.classes for each in drawn])
    assert np.bincount(classes, minlength=len(KINDS)).min() > 10
    for each in drawn:
        assert each.image.shape == (480, 640, 3) and each.image.dtype == np.uint8
        assert np.all(each.truth.boxes >= 0.0) and np.all(each.truth.boxes[:, 2] <= 640)
        assert np.all(each.truth.boxes[:, 3] <= 480)


@pytest.mark.slow
def test_objects_change_the_photo_where_they_are():
    photo = np.full((HEIGHT, WIDTH, 3), 120, np.uint8)
    seen_objects = 0
    for seed in SEEDS:
        random = np.random.default_rng(seed)
        clutter = random_clutter(random, HALL, seed, wide_paint)
        joined, seen = joined_with(photo, clutter, random)
        changed = abs(joined.astype(int) - photo).max(axis=2) > 6
        around = np.zeros((HEIGHT, WIDTH), bool)
        for each in seen:
            around[max(0, each.low[1] - 3) : each.high[1] + 3, max(0, each.low[0] - 3) : each.high[0] + 3] = (
                True
            )
            if each.pixels > 100:
                inside = changed[each.low[1] : each.high[1], each.low[0] : each.high[0]]
                assert inside.mean() > 0.2, (seed, each.object)
                seen_objects += 1
        assert not np.any(changed & ~around)
    assert seen_objects > 50


def test_recoloured_photos_have_the_same_value_and_all_hues():
    photo = np.tile(np.uint8([200, 100, 100]), (4, 6, 1))
    drawn = np.array([recoloured(photo, np.random.default_rng(seed))[0, 0] for seed in range(200)], int)
    assert np.bincount(drawn.argmax(axis=1), minlength=3).min() > 40
    assert abs(drawn.max(axis=1) - 200).max() <= 1
    ranges = np.ptp(drawn, axis=1)
    assert ranges.min() < 50 and ranges.max() > 190
    grey = np.full((4, 6, 3), 90, np.uint8)
    np.testing.assert_array_equal(recoloured(grey, np.random.default_rng(1)), grey)


def test_painted_surfaces_have_other_colours_and_the_light_of_the_photo():
    light = np.tile(np.linspace(60, 180, WIDTH), (HEIGHT, 1))
    photo = np.repeat(light[..., np.newaxis], 3, axis=2).astype(np.uint8)
    shares, colours = [], []
    for seed in range(100):
        image = painted(photo, np.random.default_rng(seed)).astype(float)
        changed = np.ptp(image, axis=2) > 20  # not grey
        shares.append(changed.mean())
        row = image[changed[:, 100:-100].sum(axis=1).argmax()]
        colours += list(row[np.ptp(row, axis=1) > 20])
    assert 0.02 < np.mean(shares) < 0.6 and min(shares) < 0.02
    assert np.bincount(np.argmax(colours, axis=1), minlength=3).min() > 500  # red, green and blue ones


def test_painted_surfaces_keep_the_shading():
    photo = np.full((HEIGHT, WIDTH, 3), 100, np.uint8)
    photo[:, WIDTH // 2 :] = 50
    ratios = []
    for seed in range(100):
        image = painted(photo, np.random.default_rng(seed)).astype(float)
        left, right = image[:, WIDTH // 2 - 4], image[:, WIDTH // 2 + 4]
        both = (
            (abs(left - 100).max(axis=1) > 10) & (abs(right - 50).max(axis=1) > 10) & (left.max(axis=1) < 250)
        )
        ratios += list(left[both].max(axis=1) / right[both].max(axis=1))
    assert len(ratios) > 1000
    np.testing.assert_allclose(np.median(ratios), 2.0, rtol=0.05)


def test_a_folder_with_few_photos_is_chosen_as_often(tmp_path):
    for folder, grey, count in (("rooms", 40, 1), ("others", 200, 9)):
        (tmp_path / folder).mkdir()
        for number in range(count):
            cv2.imwrite(str(tmp_path / folder / f"{number}.png"), np.full((480, 640, 3), grey, np.uint8))
    photos = PhotoImages([tmp_path / "rooms", tmp_path / "others"])
    dark = np.mean([np.median(photos(seed, SIZE).image) < 120 for seed in range(60)])
    assert 0.3 < dark < 0.7


def test_some_photos_stay_without_objects(photos):
    drawn = [photos(seed, SIZE) for seed in range(30)]
    assert all(each.image.shape == (HEIGHT, WIDTH, 3) for each in drawn)
    empty = np.mean([not len(each.truth.boxes) for each in drawn])
    assert 0.7 * EMPTY < empty < 1.0
    again = photos(4, SIZE)
    np.testing.assert_array_equal(drawn[4].image, again.image)


@pytest.mark.slow
def test_sets_are_drawn_by_several_processes(photos):
    one, two = (drawn_images(photos, range(6), SIZE, jobs) for jobs in (1, 2))
    np.testing.assert_array_equal(one.images, two.images)


def test_folders_without_photos_are_refused(tmp_path):
    cv2.imwrite(str(tmp_path / "photo.png"), np.zeros((4, 6, 3), np.uint8))
    with pytest.raises(ValueError, match="empty: there are no photos"):
        PhotoImages([tmp_path, tmp_path / "empty"])
    (tmp_path / "empty").mkdir()
    (tmp_path / "empty/text.png").write_text("no photo")
    with pytest.raises(ValueError, match="text.png"):
        PhotoImages([tmp_path, tmp_path / "empty"])


def test_wide_paint_is_still_that_of_the_class():
    random = np.random.default_rng(0)
    for name, strongest in (("blue_pillar", 2), ("green_pillar", 1), ("red_pillar", 0)):
        paints = np.array([wide_paint(name, random) for _ in range(200)])
        assert np.mean(np.argmax(paints, axis=1) == strongest) == 1.0
    balls = np.array([wide_paint("ball", random) for _ in range(200)])
    assert np.all(np.argmin(balls, axis=1) == 2) and np.mean(balls[:, 0] > balls[:, 1]) > 0.6
