# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
from std_msgs.msg import Header

from sextant.messages.image_messages import (
    colour_image,
    grey_compressed,
    grey_image,
    image_to_message,
    image_to_png_message,
)

IMAGE = np.random.default_rng(1).integers(0, 256, (24, 31, 3), dtype=np.uint8)


def test_images_are_read_as_they_were_written():
    np.testing.assert_array_equal(grey_image(image_to_message(IMAGE[..., 0], Header())), IMAGE[..., 0])
    np.testing.assert_array_equal(colour_image(image_to_message(IMAGE, Header())), IMAGE[..., ::-1])


def test_png_loses_nothing():
    message = image_to_png_message(IMAGE[..., 0], Header(frame_id="camera"))
    assert (message.format, message.header.frame_id) == ("png", "camera")
    np.testing.assert_array_equal(grey_compressed(message), IMAGE[..., 0])
    with pytest.raises(ValueError):
        grey_compressed(type(message)(format="png", data=message.data[:50]))
