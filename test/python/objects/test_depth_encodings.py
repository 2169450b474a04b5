# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

from sextant.objects.depth_encodings import metres_of


def test_millimetres_and_metres_are_the_same():
    millimetres = np.array([[0, 280], [1500, 65535]], np.uint16)
    metres = np.array([[0.0, 0.28], [1.5, 65.535]], np.float32)
    np.testing.assert_allclose(metres_of(millimetres), metres, rtol=1e-6)
    np.testing.assert_array_equal(metres_of(metres), metres)


def test_what_is_no_depth_is_nought():
    depth = np.array([[np.nan, np.inf, -np.inf], [-1.0, 0.0, 2.0]], np.float32)
    np.testing.assert_array_equal(metres_of(depth), [[0, 0, 0], [0, 0, 2]])


@pytest.mark.parametrize(
    "image", [np.zeros((2, 2), np.uint8), np.zeros((2, 2)), np.zeros((2, 2, 3), np.float32)]
)
def test_another_image_is_refused(image):
    with pytest.raises(ValueError, match="it must be 16UC1 .mm. or 32FC1"):
        metres_of(image)
