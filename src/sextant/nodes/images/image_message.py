# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts images to messages; sextant.messages.image_messages converts back."""

import numpy as np
from sensor_msgs.msg import Image
from std_msgs.msg import Header


def image_to_message(image: np.ndarray, header: Header) -> Image:
    """Converts a uint8 array to sensor_msgs/Image: (height, width) to mono8, (height, width, 3) to rgb8."""
    height, width = image.shape[:2]
    encoding, channels = ("mono8", 1) if image.ndim == 2 else ("rgb8", 3)
    return Image(header, height, width, encoding, 0, channels * width, image.tobytes())
