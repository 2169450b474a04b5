# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Kinds of keypoints of pictures of several sizes."""

import cv2
import numpy as np
import pytest
from made_photos import picture

from sextant.places.index_params import IndexParams, default_features
from sextant.places.photo_features import KeypointExtractor, decode_photo, photo_features
from sextant.places.photo_keypoints import UNIT

LARGE = cv2.resize(picture(1), (640, 480))


def test_large_images_have_coarse_and_fine_keypoints_and_small_ones_coarse_ones():
    extractor = KeypointExtractor(IndexParams())
    coarse, fine = extractor.extract(LARGE)
    assert 100 < len(coarse.positions) <= 300 and 100 < len(fine.positions) <= 300
    small, none = extractor.extract(picture(1))
    assert len(small.positions) > 100
    assert none.positions.shape == (0, 2) and none.descriptors.shape == (0, 128)


def test_positions_are_fractions_of_the_longer_side():
    image = np.full((240, 320), 90, np.uint8)
    cv2.circle(image, (160, 60), 12, 255, -1)
    (blob, *_) = KeypointExtractor(IndexParams()).extract(image)
    assert blob.positions[0] / UNIT * 320 == pytest.approx([160, 60], abs=1)


@pytest.mark.parametrize(
    "params",
    [
        IndexParams(matcher="BruteForce"),
        IndexParams({**default_features(), "detector": "ORB", "extractor": "ORB"}),
        IndexParams({**default_features(), "max_side": 0}),
    ],
)
def test_without_measured_fine_keypoints_there_are_coarse_ones_only(params):
    assert len(KeypointExtractor(params).extract(LARGE)) == 1


def test_a_photo_is_decoded_large_enough_for_the_fine_keypoints(tmp_path):
    path = tmp_path / "large.png"
    cv2.imwrite(str(path), cv2.resize(picture(1), (1280, 960)))
    assert max(decode_photo(IndexParams(), path.read_bytes(), path).shape) >= 640
    found = photo_features(IndexParams(), path)
    assert found.count == sum(len(each.positions) for each in found.kinds) > 300
