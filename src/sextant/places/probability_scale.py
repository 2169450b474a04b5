# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Colours of probabilities on light ground, from yellow by red to dark violet (matplotlib's plasma)."""

from typing import Tuple

import cv2
import numpy as np

Colour = Tuple[int, int, int]  # red, green, blue

_PALEST, _DARKEST = 20, 243  # the map's very ends are too close to white and to black outlines
_PLASMA = cv2.applyColorMap(np.arange(256, dtype=np.uint8), cv2.COLORMAP_PLASMA)[::-1, 0, ::-1]


def probability_colour(probability: float) -> Colour:
    """The darker, the likelier; also for those who cannot tell red from green, and in grey.

    :param probability: what is outside [0, 1] has the colour of the nearer end
    """
    index = round(_PALEST + min(max(probability, 0.0), 1.0) * (_DARKEST - _PALEST))
    red, green, blue = (int(part) for part in _PLASMA[index])
    return red, green, blue


def probability_bar(width: int, height: int) -> np.ndarray:
    """uint8 (height, width, 3): the colours from 0 at the left to 1 at the right."""
    row = [probability_colour(column / max(width - 1, 1)) for column in range(width)]
    return np.tile(np.array(row, np.uint8), (height, 1, 1))
