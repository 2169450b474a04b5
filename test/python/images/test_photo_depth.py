# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Depth images beside photos."""

import cv2
import numpy as np
import pytest

from sextant.images.photo_depth import depth_path, encoded_depth, read_photo_depth


def test_depth_survives_to_the_millimetre(tmp_path):
    photo, depth = tmp_path / "a.jpg", np.array([[0.0, 0.3004, 8.1], [65.535, 70.0, 1.0]], np.float32)
    depth_path(photo).write_bytes(encoded_depth(depth))
    assert depth_path(photo).name == "a.jpg.depth"
    expected = [[0.0, 0.3, 8.1], [65.535, 0.0, 1.0]]
    np.testing.assert_allclose(read_photo_depth(photo), expected, atol=5e-6)
    assert read_photo_depth(tmp_path / "b.jpg") is None


@pytest.mark.parametrize(
    "content", [b"", b"no image", cv2.imencode(".png", np.zeros((2, 3), np.uint8))[1].tobytes()]
)
def test_a_damaged_file_is_refused(tmp_path, content):
    depth_path(tmp_path / "a.jpg").write_bytes(content)
    with pytest.raises(ValueError, match="a.jpg.depth: is not a PNG image of 16-bit grey"):
        read_photo_depth(tmp_path / "a.jpg")
