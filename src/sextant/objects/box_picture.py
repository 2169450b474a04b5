# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A picture with the boxes that were found in it, their classes and scores."""

from typing import Sequence, Tuple

import cv2
import numpy as np

from sextant.landmarks.landmark_colours import colour_of_class
from sextant.objects.detection import Detections, names_of

FONT, DARK, LIGHT = cv2.FONT_HERSHEY_SIMPLEX, (20, 20, 20), (255, 255, 255)
OF_HEIGHT = 1.0 / 900.0  # size of the letters, of the picture's height


def box_picture(image: np.ndarray, found: Detections, classes: Sequence[str]) -> np.ndarray:
    """Another picture; the surest box is on top.

    :param image: uint8 (height, width, 3), red first
    """
    drawn = image.copy()
    rows = list(zip(found.boxes, found.scores, names_of(found.classes, classes)))
    for box, score, name in reversed(rows):
        colour = tuple(round(255 * part) for part in colour_of_class(name))
        _draw(drawn, box, f"{name} {score:.2f}", colour)
    return drawn


def _draw(image: np.ndarray, box: np.ndarray, words: str, colour: Tuple[int, ...]) -> None:
    height, width = image.shape[:2]
    left, top, right, bottom = (int(round(each)) for each in box)
    scale = max(0.35, height * OF_HEIGHT)
    cv2.rectangle(image, (left, top), (right - 1, bottom - 1), LIGHT, 3)
    cv2.rectangle(image, (left, top), (right - 1, bottom - 1), colour, 2)
    (wide, high), below = cv2.getTextSize(words, FONT, scale, 1)
    x = max(0, min(left, width - wide - 4))
    y = top if top >= high + below + 4 else min(height, bottom + high + below + 4)  # above it, or below
    cv2.rectangle(image, (x, y - high - below - 4), (x + wide + 4, y), colour, cv2.FILLED)
    ink = DARK if np.dot(colour, (0.3, 0.6, 0.1)) > 110 else LIGHT
    cv2.putText(image, words, (x + 2, y - below - 1), FONT, scale, ink, 1, cv2.LINE_AA)
