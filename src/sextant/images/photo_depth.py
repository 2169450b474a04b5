# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Depth images beside the photos of a map: PNG files of 16-bit millimetres in the view of the photo."""

from pathlib import Path
from typing import Optional

import cv2
import numpy as np

MAX_DEPTH = 65.535  # metres


def depth_path(photo: Path) -> Path:
    """Path of the depth image of a photo."""
    return photo.with_name(photo.name + ".depth")


def encoded_depth(depth: np.ndarray) -> bytes:
    """Content of the file. :param depth: float32 (height, width), metres, 0: none"""
    millimetres = np.where(depth <= MAX_DEPTH, np.rint(1e3 * depth), 0).astype(np.uint16)
    return cv2.imencode(".png", millimetres)[1].tobytes()


def read_photo_depth(photo: Path) -> Optional[np.ndarray]:
    """Depth of a photo, float32 (height, width) metres, 0: none; None: the photo has none.

    :raises OSError: the file cannot be read
    :raises ValueError: it is not a PNG image of 16-bit grey
    """
    path = depth_path(photo)
    if not path.exists():
        return None
    try:
        return decoded_depth(path.read_bytes())
    except ValueError as error:
        raise ValueError(f"{path}: {error}; write it again") from None


def decoded_depth(content: bytes) -> np.ndarray:
    """The inverse of encoded_depth().

    :raises ValueError: it is not a PNG image of 16-bit grey
    """
    image = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED) if content else None
    if image is None or image.ndim != 2 or image.dtype != np.uint16:
        raise ValueError("is not a PNG image of 16-bit grey (depth in mm)")
    return image.astype(np.float32) * np.float32(1e-3)
