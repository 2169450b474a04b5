# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the index, for the two kinds of keypoints."""

import pytest

from sextant.places.index_params import IndexParams, default_features, plain_features


def test_fine_keypoints_are_of_larger_images_and_smaller_regions():
    coarse, fine = IndexParams().feature_params(), IndexParams().fine_params()
    assert fine.max_side == 2 * coarse.max_side
    assert fine.support_scale < coarse.support_scale and fine.min_size > coarse.min_size
    assert fine.sift_contrast == coarse.sift_contrast


@pytest.mark.parametrize("features", [plain_features("SIFT", "SIFT"), plain_features("AKAZE", "AKAZE")])
def test_without_a_matcher_any_features_are_valid(features):
    params = IndexParams(features)
    params.validate()
    assert params.fine_params() is None


def test_what_is_invalid_is_named():
    with pytest.raises(ValueError, match="matcher"):
        IndexParams(matcher="none").validate()
    with pytest.raises(ValueError, match="min_size"):
        IndexParams({**default_features(), "min_size": -1.0}).validate()
