# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A picture and the photo of the map that it is likest, side by side, with what they have in common."""

from typing import Sequence, Tuple

import cv2
import numpy as np

from sextant.places.place_matches import MatchedPhoto
from sextant.places.probability_scale import Colour, probability_colour

HEIGHT = 480  # pixels of both pictures
WIDEST = 4 * HEIGHT  # pixels; wider ones, of a line camera, are less high
GAP, BAR = 8, 36  # pixels between them, and of the line of words
PAPER, INK = (255, 255, 255), (40, 40, 40)
SHOWN = 60  # matches, the best ones
BORDER = (255, 255, 255)


def match_picture(picture: np.ndarray, photo: np.ndarray, match: MatchedPhoto, words: str) -> np.ndarray:
    """uint8 (height, width, 3) RGB: the picture at the left, the photo at the right.

    :param picture: uint8, grey or RGB
    :param photo: of the map, uint8, grey or RGB
    :param words: below both
    """
    left, right = _scaled(picture), _scaled(photo)
    offset = left.shape[1] + GAP
    sheet = np.full((HEIGHT + BAR, offset + right.shape[1], 3), PAPER, np.uint8)
    sheet[: left.shape[0], : left.shape[1]] = left
    sheet[: right.shape[0], offset:] = right
    best = np.argsort(-match.weights, kind="stable")[:SHOWN][::-1]  # the best ones on top
    most = match.weights.max(initial=1e-9)
    for each in best:
        begin = _pixel(match.picture_xy[each], left.shape)
        end = _pixel(match.photo_xy[each], right.shape)
        _draw(sheet, begin, (end[0] + offset, end[1]), probability_colour(match.weights[each] / most))
    cv2.putText(sheet, words, (8, HEIGHT + 24), cv2.FONT_HERSHEY_SIMPLEX, 0.55, INK, 1, cv2.LINE_AA)
    return sheet


def _scaled(image: np.ndarray) -> np.ndarray:
    """RGB, as high as the sheet, if there is room."""
    colour = image if image.ndim == 3 else cv2.cvtColor(image, cv2.COLOR_GRAY2RGB)
    height, width = image.shape[:2]
    scale = min(HEIGHT / height, WIDEST / width)
    size = (max(1, round(width * scale)), max(1, round(height * scale)))
    return cv2.resize(colour, size, interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR)


def _pixel(xy: np.ndarray, shape: Sequence[int]) -> Tuple[int, int]:
    """:param xy: in longer sides of the picture"""
    x, y = np.rint(xy * max(shape[:2])).astype(int)
    return int(x), int(y)


def _draw(sheet: np.ndarray, begin: Tuple[int, int], end: Tuple[int, int], colour: Colour) -> None:
    cv2.line(sheet, begin, end, colour, 1, cv2.LINE_AA)
    for point in (begin, end):
        cv2.circle(sheet, point, 4, BORDER, -1, cv2.LINE_AA)
        cv2.circle(sheet, point, 3, colour, -1, cv2.LINE_AA)
