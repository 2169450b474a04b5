# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws an image and the most similar photo of the map side by side, with their matches."""

from typing import Sequence, Tuple

import cv2
import numpy as np

from sextant.place_maps.probability_colours import Colour, probability_colour
from sextant.places.place_matches import MatchedPhoto

HEIGHT = 480  # of both images, pixels
MAX_WIDTH = 4 * HEIGHT  # of each image, pixels; wider ones (line cameras) are scaled down
GAP, BAR = 8, 36  # gap between the images, and height of the caption, pixels
PAPER, INK = (255, 255, 255), (40, 40, 40)
MAX_MATCHES = 60  # maximum number of matches drawn
BORDER = (255, 255, 255)  # around keypoints


def match_image(image: np.ndarray, photo: np.ndarray, match: MatchedPhoto, caption: str) -> np.ndarray:
    """Returns uint8 (height, width, 3) RGB: the image on the left, the photo on the right.

    :param image: uint8, grey or RGB
    :param photo: of the map, uint8, grey or RGB
    :param match: the matched keypoints
    :param caption: text below both
    """
    left, right = _scaled(image), _scaled(photo)
    offset = left.shape[1] + GAP
    sheet = np.full((HEIGHT + BAR, offset + right.shape[1], 3), PAPER, np.uint8)
    sheet[: left.shape[0], : left.shape[1]] = left
    sheet[: right.shape[0], offset:] = right
    best = np.argsort(-match.weights, kind="stable")[:MAX_MATCHES][::-1]  # the best ones on top
    highest = match.weights.max(initial=1e-9)
    for i in best:
        begin = _pixel(match.query_xy[i], left.shape)
        end = _pixel(match.photo_xy[i], right.shape)
        _draw(sheet, begin, (end[0] + offset, end[1]), probability_colour(match.weights[i] / highest))
    cv2.putText(sheet, caption, (8, HEIGHT + 24), cv2.FONT_HERSHEY_SIMPLEX, 0.55, INK, 1, cv2.LINE_AA)
    return sheet


def _scaled(image: np.ndarray) -> np.ndarray:
    """The image in RGB, scaled to HEIGHT, or to MAX_WIDTH if it is wider then."""
    colour = image if image.ndim == 3 else cv2.cvtColor(image, cv2.COLOR_GRAY2RGB)
    height, width = image.shape[:2]
    scale = min(HEIGHT / height, MAX_WIDTH / width)
    size = (max(1, round(width * scale)), max(1, round(height * scale)))
    return cv2.resize(colour, size, interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR)


def _pixel(xy: np.ndarray, shape: Sequence[int]) -> Tuple[int, int]:
    """Pixel of xy, which is a fraction of the longer side of an image of this shape."""
    x, y = np.rint(xy * max(shape[:2])).astype(int)
    return int(x), int(y)


def _draw(sheet: np.ndarray, begin: Tuple[int, int], end: Tuple[int, int], colour: Colour) -> None:
    cv2.line(sheet, begin, end, colour, 1, cv2.LINE_AA)
    for point in (begin, end):
        cv2.circle(sheet, point, 4, BORDER, -1, cv2.LINE_AA)
        cv2.circle(sheet, point, 3, colour, -1, cv2.LINE_AA)
