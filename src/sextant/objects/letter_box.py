# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A picture of any size in the middle of one of a fixed size, with its proportions."""

from typing import NamedTuple, Tuple

import cv2
import numpy as np

GREY = 114  # of the margin, as in training


class LetterBox(NamedTuple):
    """How pixels of a picture become those of a network's input."""

    scale: Tuple[float, float]  # of x and y; the same but for rounding to whole pixels
    left: int  # margin, pixels of the input
    top: int
    inner: Tuple[int, int]  # width and height of the picture in it

    def to_input(self, boxes: np.ndarray) -> np.ndarray:
        """(n, 4) corners in the input of corners in the picture."""
        return boxes * (self.scale * 2) + [self.left, self.top] * 2

    def to_image(self, boxes: np.ndarray, size: Tuple[int, int]) -> np.ndarray:
        """(n, 4) corners in the picture, cut at its borders, of corners in the input.

        :param size: width and height of the picture
        """
        found = (boxes - [self.left, self.top] * 2) / (self.scale * 2)
        return np.clip(found, 0.0, [*size, *size])


def letter_box(image: Tuple[int, int], taken: Tuple[int, int]) -> LetterBox:
    """:param image: width and height of a picture, pixels. :param taken: of the network's input"""
    scale = min(taken[0] / image[0], taken[1] / image[1])
    inner = max(1, round(image[0] * scale)), max(1, round(image[1] * scale))
    exact = inner[0] / image[0], inner[1] / image[1]
    return LetterBox(exact, (taken[0] - inner[0]) // 2, (taken[1] - inner[1]) // 2, inner)


def boxed(image: np.ndarray, box: LetterBox, taken: Tuple[int, int]) -> np.ndarray:
    """uint8 (height, width, 3) of the input's size.

    :param image: uint8 (height, width, 3)
    """
    canvas = np.full((taken[1], taken[0], 3), GREY, np.uint8)
    small = cv2.resize(
        image, box.inner, interpolation=cv2.INTER_AREA if max(box.scale) < 1.0 else cv2.INTER_LINEAR
    )
    canvas[box.top : box.top + box.inner[1], box.left : box.left + box.inner[0]] = small
    return canvas


def blob_of(image: np.ndarray, box: LetterBox, taken: Tuple[int, int]) -> np.ndarray:
    """float32 (1, 3, height, width) in [0, 1], red first.

    :param image: uint8 (height, width, 3), red first
    """
    planes = boxed(image, box, taken).transpose(2, 0, 1)[np.newaxis]
    return np.ascontiguousarray(planes, np.float32) / np.float32(255.0)
