# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts an overview to a light, pale background for dots."""

import cv2
import numpy as np

from sextant.images.photo_file import read_rgb
from sextant.place_maps.place_map import PlaceMap

READABLE = 800  # minimum of the longer side, pixels, for text to be readable; smaller overviews are enlarged

DARKEST, LIGHTEST = 185.0, 250.0  # grey levels of the result
SATURATION = 0.35  # relative to that of the overview
_MIN_CONTRAST = 64.0  # grey levels; a smaller contrast is not stretched, as it may be noise
_LUMA = np.array([0.299, 0.587, 0.114], np.float32)  # weights of R, G, B in the grey level, ITU-R BT.601


def backdrop(place_map: PlaceMap, max_side: int) -> np.ndarray:
    """Pale background from a map's overview, uint8 (height, width, 3) RGB, in the map file's aspect ratio.

    :param max_side: maximum of the longer side, pixels
    :raises OSError: the overview cannot be read
    :raises ValueError: it is not an image
    """
    overview = place_map.overview
    image = read_rgb(place_map.folder / overview.image, max_side)
    longer = max(overview.width, overview.height)
    scale = min(max_side, max(longer, READABLE)) / longer
    size = (max(1, round(overview.width * scale)), max(1, round(overview.height * scale)))
    shrinks = size[0] < image.shape[1] or size[1] < image.shape[0]
    return subdued(cv2.resize(image, size, interpolation=cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR))


def subdued(image: np.ndarray) -> np.ndarray:
    """The RGB image with its contrast mapped to light greys and with reduced saturation."""
    grey = image.astype(np.float32) @ _LUMA
    low, high = np.percentile(grey, (2, 98))
    contrast = max(float(high - low), _MIN_CONTRAST)
    light = LIGHTEST + (grey - high) * (LIGHTEST - DARKEST) / contrast
    tint = (image - grey[..., None]) * SATURATION
    return np.clip(np.clip(light, DARKEST, LIGHTEST)[..., None] + tint, 0, 255).astype(np.uint8)
