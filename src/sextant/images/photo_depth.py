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
    content = np.frombuffer(path.read_bytes(), np.uint8)
    image = cv2.imdecode(content, cv2.IMREAD_UNCHANGED) if len(content) else None
    if image is None or image.ndim != 2 or image.dtype != np.uint16:
        raise ValueError(f"{path}: is not a PNG image of 16-bit grey (depth in mm); make the map again")
    return image.astype(np.float32) * np.float32(1e-3)
