# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Keypoints of photos that are added and removed, and scores of photos that the tests draw."""

import numpy as np
import pytest

from sextant.places.photo_keypoints import UNIT, Keypoints, PhotoKeypoints

WIDTH, CODES = 20, 8


def drawn(seed, count=50):
    rng = np.random.default_rng(seed)
    positions = rng.integers(UNIT // 4, 3 * UNIT // 4, (count, 2)).astype(np.uint16)
    return Keypoints(positions, rng.normal(0, 10, (count, WIDTH)).astype(np.float32))


def made(photos):
    kind = PhotoKeypoints.empty(np.concatenate([photo.descriptors for photo in photos]), CODES)
    kind.add(photos)
    return kind


def test_each_photo_has_its_keypoints_also_after_others_are_removed():
    photos = [drawn(seed, count) for seed, count in enumerate((3, 0, 5, 2))]
    kind = made(photos)
    kind.keep(np.array([True, True, False, True]))
    kind.add([photos[2]])
    assert kind.counts.tolist() == [3, 0, 2, 5] and kind.firsts.tolist() == [0, 3, 3, 5]
    for number, photo in enumerate((photos[0], photos[1], photos[3], photos[2])):
        found = kind.of(number)
        assert np.array_equal(found.positions, photo.positions)
        assert np.array_equal(found.codes, kind.coder.encode(photo.descriptors))
    assert kind.bytes == 10 * (CODES + 4)


def test_a_photo_itself_has_the_highest_score():
    photos = [drawn(seed) for seed in range(5)]
    kind = made(photos)
    noise = np.random.default_rng(9).normal(0, 1, (50, WIDTH)).astype(np.float32)
    image = kind.encode(photos[3]._replace(descriptors=photos[3].descriptors + noise))
    found = kind.scores(image, np.arange(5))
    assert found.logs.argmax() == 3 and found.logs[3] > np.delete(found.logs, 3).max() + 2
    assert np.median(found.nearest) < np.sqrt(WIDTH) < np.median(found.background) / kind.coder.scale
    assert kind.scores(image, np.array([4, 3])).logs.argmax() == 1


@pytest.mark.filterwarnings("error")
def test_photos_without_keypoints_get_the_median_of_the_others():
    kind = made([drawn(0), drawn(1, 0), drawn(2), drawn(3)])
    logs = kind.scores(kind.encode(drawn(0)), np.arange(4)).logs
    assert logs[1] == np.median(logs[[0, 2, 3]])
    empty = made([drawn(0), drawn(1, 0)])
    assert not empty.scores(empty.encode(drawn(0)), np.array([1])).logs.any()
    assert not kind.scores(kind.encode(drawn(0, 0)), np.arange(4)).logs.any()
