# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Images of messages.

Grey ones are the same bytes as the detector node sees (src/ros/detection/image_bridge.cpp).
"""

from typing import Any, Callable, Dict, Optional

import cv2
import numpy as np
from cv_bridge import CvBridge
from cv_bridge.boost.cv_bridge_boost import cvtColor2

from sextant.bags.bag_file import DamagedMessage
from sextant.objects.depth_image import metres_of

_BAYER = [f"bayer_{order}{bits}" for order in ("rggb", "bggr", "gbrg", "grbg") for bits in (8, 16)]
_COLOURS = [f"{order}{bits}" for order in ("rgb", "rgba", "bgr", "bgra") for bits in (8, 16)]
PICTURES = {"mono8", "mono16", "yuv422", "8UC1", "8UC3", "8UC4", *_BAYER, *_COLOURS}
DEPTHS = ("16UC1", "32FC1")

_Own = Dict[str, Callable[[np.ndarray], np.ndarray]]

# Encodings that cv_bridge does not take, or not in either byte order.
_OWN: _Own = {
    "8UC1": lambda pixels: pixels,
    "mono8": lambda pixels: pixels,
    "8UC3": lambda pixels: cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY),
    "8UC4": lambda pixels: cv2.cvtColor(pixels, cv2.COLOR_BGRA2GRAY),
    "mono16": lambda pixels: (pixels >> 8).astype(np.uint8),
}
_OWN_COLOUR: _Own = {
    **_OWN,
    "8UC3": lambda pixels: pixels,
    "8UC4": lambda pixels: cv2.cvtColor(pixels, cv2.COLOR_BGRA2BGR),
}


def is_picture(message: Optional[Any]) -> bool:
    """Whether a sensor_msgs/Image holds one in which markers could be found: no depth, no floats."""
    return message is None or message.encoding in PICTURES


def grey_image(message: Any) -> np.ndarray:
    """(height, width) uint8 of a sensor_msgs/Image.

    :raises DamagedMessage: an encoding that holds no picture, or a size, step or length that cannot be
    """
    return _converted(message, _OWN, "mono8")


def colour_image(message: Any) -> np.ndarray:
    """As grey_image(), but (height, width, 3) in the order BGR of one that has colours."""
    return _converted(message, _OWN_COLOUR, "bgr8")


def depth_image(message: Any) -> np.ndarray:
    """float32 (height, width) metres, 0 where there is none, of a sensor_msgs/Image as REP 118 has it.

    :raises DamagedMessage: another encoding, or a size, step or length that cannot be
    """
    if message.encoding not in DEPTHS:
        allowed = " or ".join(DEPTHS)
        raise DamagedMessage(f"the encoding '{message.encoding}' holds no depth, publish {allowed}")
    return metres_of(_pixels(message))


def _converted(message: Any, own: _Own, encoding: str) -> np.ndarray:
    if message.encoding not in PICTURES:
        raise DamagedMessage(f"the encoding '{message.encoding}' holds no picture, publish mono8 or bgr8")
    pixels = _pixels(message)
    if message.encoding in own:
        return np.ascontiguousarray(own[message.encoding](pixels))
    try:
        return cvtColor2(pixels, message.encoding, encoding)
    except Exception as error:  # cv_bridge and OpenCV have their own
        raise DamagedMessage(f"the encoding {message.encoding} cannot be read ({error})") from None


def _pixels(message: Any) -> np.ndarray:
    """(height, width) or (height, width, channels), without what the rows are padded with."""
    depth, channels = CvBridge().encoding_to_dtype_with_channels(message.encoding)
    stored = np.dtype(depth).newbyteorder(">" if message.is_bigendian else "<")
    height, width, row = message.height, message.width, message.width * channels * stored.itemsize
    if height == 0 or width == 0:
        raise DamagedMessage(f"the image is empty ({width} x {height})")
    if message.step < row:
        raise DamagedMessage(f"a step of {message.step} bytes is too short for {width} pixels")
    if len(message.data) < message.step * height:
        raise DamagedMessage(f"the image is cut short: {len(message.data)} bytes of {message.step * height}")
    rows = np.frombuffer(message.data, np.uint8, message.step * height).reshape(height, message.step)
    pixels = np.ascontiguousarray(rows[:, :row]).view(stored).astype(depth, copy=False)
    return pixels if channels == 1 else pixels.reshape(height, width, channels)


def grey_compressed(message: Any) -> np.ndarray:
    """(height, width) uint8 of a sensor_msgs/CompressedImage.

    :raises DamagedMessage: OpenCV cannot decode it
    """
    return _decoded(message, cv2.IMREAD_GRAYSCALE)


def colour_compressed(message: Any) -> np.ndarray:
    """As grey_compressed(), but (height, width, 3) in the order BGR of one that has colours."""
    return _decoded(message, cv2.IMREAD_ANYCOLOR)


def _decoded(message: Any, flag: int) -> np.ndarray:
    image = None
    if message.data:
        # A calibration is for the pixels as the sensor had them, whatever the header says of up and down.
        flags = flag | cv2.IMREAD_IGNORE_ORIENTATION
        try:
            image = cv2.imdecode(np.frombuffer(message.data, np.uint8), flags)
        except cv2.error:
            image = None
    if image is None:
        raise DamagedMessage(f"the compressed image ({message.format}) cannot be decoded")
    return image
