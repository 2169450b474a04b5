# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""An overview as the ground to draw on: light and pale, whatever it was, so that dots stand out."""

import cv2
import numpy as np

from sextant.place_maps.photo_file import read_rgb
from sextant.place_maps.place_map import PlaceMap

READABLE = 800  # pixels of the longer side; smaller overviews are enlarged to it

DARKEST, LIGHTEST = 185.0, 250.0  # grey levels of the result
COLOUR_LEFT = 0.35  # of the overview's
_LEAST_CONTRAST = 64.0  # grey levels; less is not stretched, it may be noise
_LUMA = np.array([0.299, 0.587, 0.114], np.float32)  # ITU-R BT.601


def backdrop(place_map: PlaceMap, max_side: int) -> np.ndarray:
    """The map's overview, subdued; uint8 (height, width, 3), RGB, in the shape that the map says it has.

    :param max_side: pixels of the longer side, at most
    :raises OSError: the overview cannot be read
    :raises ValueError: it is no picture
    """
    overview = place_map.overview
    picture = read_rgb(place_map.folder / overview.image, max_side)
    longer = max(overview.width, overview.height)
    scale = min(max_side, max(longer, READABLE)) / longer
    size = (max(1, round(overview.width * scale)), max(1, round(overview.height * scale)))
    shrinks = size[0] < picture.shape[1] or size[1] < picture.shape[0]
    return subdued(cv2.resize(picture, size, interpolation=cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR))


def subdued(picture: np.ndarray) -> np.ndarray:
    """Its contrast pressed into the light greys, with little colour left; RGB as it came."""
    grey = picture.astype(np.float32) @ _LUMA
    low, high = np.percentile(grey, (2, 98))
    contrast = max(float(high - low), _LEAST_CONTRAST)
    ground = LIGHTEST + (grey - high) * (LIGHTEST - DARKEST) / contrast
    tint = (picture - grey[..., None]) * COLOUR_LEFT
    return np.clip(np.clip(ground, DARKEST, LIGHTEST)[..., None] + tint, 0, 255).astype(np.uint8)
