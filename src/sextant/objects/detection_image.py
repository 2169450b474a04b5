# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""An image with the detected boxes, their classes and scores drawn into it."""

from typing import Sequence, Tuple

import cv2
import numpy as np

from sextant.landmarks.landmark_colours import colour_of_class
from sextant.objects.detections import Detections

FONT, DARK, LIGHT = cv2.FONT_HERSHEY_SIMPLEX, (20, 20, 20), (255, 255, 255)
FONT_SCALE = 1.0 / 900.0  # font size per pixel of the image's height


def detection_image(
    image: np.ndarray, found: Detections, classes: Sequence[str], with_scores: bool = True
) -> np.ndarray:
    """Return a copy of the image with all detections; the one with the highest score is on top.

    :param image: uint8 (height, width, 3), red first
    :param with_scores: whether the scores are written
    """
    drawn = image.copy()
    for box, score, number in zip(*(each[::-1] for each in found)):
        colour = tuple(round(255 * part) for part in colour_of_class(classes[number]))
        _draw(drawn, box, f"{classes[number]} {score:.2f}" if with_scores else classes[number], colour)
    return drawn


def _draw(image: np.ndarray, box: np.ndarray, label: str, colour: Tuple[int, ...]) -> None:
    height, width = image.shape[:2]
    left, top, right, bottom = (int(round(each)) for each in box)
    scale = max(0.35, height * FONT_SCALE)
    cv2.rectangle(image, (left, top), (right - 1, bottom - 1), LIGHT, 3)
    cv2.rectangle(image, (left, top), (right - 1, bottom - 1), colour, 2)
    (wide, high), below = cv2.getTextSize(label, FONT, scale, 1)
    x = max(0, min(left, width - wide - 4))
    y = top if top >= high + below + 4 else min(height, bottom + high + below + 4)  # above the box, or below
    cv2.rectangle(image, (x, y - high - below - 4), (x + wide + 4, y), colour, cv2.FILLED)
    ink = DARK if np.dot(colour, (0.3, 0.6, 0.1)) > 110 else LIGHT
    cv2.putText(image, label, (x + 2, y - below - 1), FONT, scale, ink, 1, cv2.LINE_AA)
