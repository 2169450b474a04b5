# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Colour scale of probabilities on a light background, from yellow to dark violet (matplotlib's plasma)."""

from typing import Tuple

import cv2
import numpy as np

Colour = Tuple[int, int, int]  # red, green, blue

_PALEST, _DARKEST = 20, 243  # indices of the map; its ends are too close to white and to black outlines
_PLASMA = cv2.applyColorMap(np.arange(256, dtype=np.uint8), cv2.COLORMAP_PLASMA)[::-1, 0, ::-1]


def probability_colour(probability: float) -> Colour:
    """Colour of a probability: darker is more probable, also for colour-blind viewers and in grey.

    :param probability: is clipped to [0, 1]
    """
    index = round(_PALEST + min(max(probability, 0.0), 1.0) * (_DARKEST - _PALEST))
    red, green, blue = (int(channel) for channel in _PLASMA[index])
    return red, green, blue


def probability_bar(width: int, height: int) -> np.ndarray:
    """Colour bar, uint8 (height, width, 3) RGB, from 0 on the left to 1 on the right."""
    row = [probability_colour(column / max(width - 1, 1)) for column in range(width)]
    return np.tile(np.array(row, np.uint8), (height, 1, 1))
