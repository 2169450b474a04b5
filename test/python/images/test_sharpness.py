# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sharpness of pictures and of blurred ones."""

import cv2
import pytest
from made_photos import picture

from sextant.images.sharpness import sharpness


def test_a_blurred_image_is_less_sharp():
    sharp = picture(1)
    blurred = cv2.GaussianBlur(sharp, (0, 0), 2)
    assert sharpness(blurred) < 0.5 * sharpness(sharp)
    assert sharpness(cv2.merge([sharp] * 3)) == pytest.approx(sharpness(sharp))
