# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts image messages to arrays and back.

Grey images have the same bytes as in the nodes (src/ros/detection/image_conversions.cpp).
"""

from typing import Any, Callable, Dict, Optional

import cv2
import numpy as np
from cv_bridge import CvBridge
from cv_bridge.boost.cv_bridge_boost import cvtColor2
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Header

from sextant.messages.damaged_message import DamagedMessage
from sextant.objects.depth_encodings import metres_of

_BAYER = [f"bayer_{order}{bits}" for order in ("rggb", "bggr", "gbrg", "grbg") for bits in (8, 16)]
_COLOURS = [f"{order}{bits}" for order in ("rgb", "rgba", "bgr", "bgra") for bits in (8, 16)]
IMAGE_ENCODINGS = {"mono8", "mono16", "yuv422", "8UC1", "8UC3", "8UC4", *_BAYER, *_COLOURS}
DEPTH_ENCODINGS = ("16UC1", "32FC1")

_Conversions = Dict[str, Callable[[np.ndarray], np.ndarray]]

# Encodings that cv_bridge does not support, or not in both byte orders.
_GREY_CONVERSIONS: _Conversions = {
    "8UC1": lambda pixels: pixels,
    "mono8": lambda pixels: pixels,
    "8UC3": lambda pixels: cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY),
    "8UC4": lambda pixels: cv2.cvtColor(pixels, cv2.COLOR_BGRA2GRAY),
    "mono16": lambda pixels: (pixels >> 8).astype(np.uint8),
}
_COLOUR_CONVERSIONS: _Conversions = {
    **_GREY_CONVERSIONS,
    "8UC3": lambda pixels: pixels,
    "8UC4": lambda pixels: cv2.cvtColor(pixels, cv2.COLOR_BGRA2BGR),
}


def is_camera_image(message: Optional[Any]) -> bool:
    """Whether a sensor_msgs/Image is grey or colour, not depth or floats; also if there is none."""
    return message is None or message.encoding in IMAGE_ENCODINGS


def grey_image(message: Any) -> np.ndarray:
    """(height, width) uint8 of a sensor_msgs/Image.

    :raises DamagedMessage: the encoding is not grey or colour, or size, step or length are not valid
    """
    return _converted(message, _GREY_CONVERSIONS, "mono8")


def colour_image(message: Any) -> np.ndarray:
    """As grey_image(), but (height, width, 3) in the order BGR for a colour image."""
    return _converted(message, _COLOUR_CONVERSIONS, "bgr8")


def depth_image(message: Any) -> np.ndarray:
    """float32 (height, width) metres, 0 where unknown, of a depth sensor_msgs/Image (REP 118).

    :raises DamagedMessage: the encoding is not depth, or size, step or length are not valid
    """
    if message.encoding not in DEPTH_ENCODINGS:
        allowed = " or ".join(DEPTH_ENCODINGS)
        raise DamagedMessage(f"the encoding '{message.encoding}' is not depth, publish {allowed}")
    return metres_of(_pixels(message))


def _converted(message: Any, own: _Conversions, encoding: str) -> np.ndarray:
    if message.encoding not in IMAGE_ENCODINGS:
        raise DamagedMessage(
            f"the encoding '{message.encoding}' is not an image of a camera, publish mono8 or bgr8"
        )
    pixels = _pixels(message)
    if message.encoding in own:
        return np.ascontiguousarray(own[message.encoding](pixels))
    try:
        return cvtColor2(pixels, message.encoding, encoding)
    except Exception as error:  # cv_bridge and OpenCV raise various exceptions
        raise DamagedMessage(f"the encoding {message.encoding} cannot be read ({error})") from None


def _pixels(message: Any) -> np.ndarray:
    """(height, width) or (height, width, channels), without the padding of rows."""
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
    """As grey_compressed(), but (height, width, 3) in the order BGR for a colour image."""
    return _decoded(message, cv2.IMREAD_ANYCOLOR)


def _decoded(message: Any, flag: int) -> np.ndarray:
    image = None
    if message.data:
        # A calibration is valid for the pixels of the sensor, without the rotation of an EXIF header.
        flags = flag | cv2.IMREAD_IGNORE_ORIENTATION
        try:
            image = cv2.imdecode(np.frombuffer(message.data, np.uint8), flags)
        except cv2.error:
            image = None
    if image is None:
        raise DamagedMessage(f"the compressed image ({message.format}) cannot be decoded")
    return image


def image_to_message(image: np.ndarray, header: Header) -> Image:
    """Converts a uint8 array to sensor_msgs/Image: (height, width) to mono8, (height, width, 3) to rgb8."""
    height, width = image.shape[:2]
    encoding, channels = ("mono8", 1) if image.ndim == 2 else ("rgb8", 3)
    return Image(header, height, width, encoding, 0, channels * width, image.tobytes())


def image_to_png_message(image: np.ndarray, header: Header) -> CompressedImage:
    """Converts a uint8 array (height, width) to sensor_msgs/CompressedImage, without loss."""
    _, data = cv2.imencode(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, 1])
    return CompressedImage(header, "png", data.tobytes())
