# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Letterboxing: resize an image to a fixed size with its aspect ratio kept."""

from typing import NamedTuple, Tuple

import cv2
import numpy as np

GREY = 114  # level of the margin, as in training


class LetterBox(NamedTuple):
    """Transform from pixels of an image to those of a network's input."""

    scale: Tuple[float, float]  # of x and y; equal except for rounding to whole pixels
    left: int  # margin, pixels of the input
    top: int  # margin, pixels of the input
    inner: Tuple[int, int]  # width and height of the image in the input

    def to_input(self, boxes: np.ndarray) -> np.ndarray:
        """Transform box corners (n, 4) from the image to the input."""
        return boxes * (self.scale * 2) + [self.left, self.top] * 2

    def to_image(self, boxes: np.ndarray, size: Tuple[int, int]) -> np.ndarray:
        """Transform box corners (n, 4) from the input to the image, clipped at its borders.

        :param size: width and height of the image
        """
        found = (boxes - [self.left, self.top] * 2) / (self.scale * 2)
        return np.clip(found, 0.0, [*size, *size])


def letter_box(image: Tuple[int, int], input_size: Tuple[int, int]) -> LetterBox:
    """Compute the letterbox of an image. :param image: its width and height, pixels

    :param input_size: width and height of the network's input, pixels
    """
    scale = min(input_size[0] / image[0], input_size[1] / image[1])
    inner = max(1, round(image[0] * scale)), max(1, round(image[1] * scale))
    exact = inner[0] / image[0], inner[1] / image[1]
    return LetterBox(exact, (input_size[0] - inner[0]) // 2, (input_size[1] - inner[1]) // 2, inner)


def letterboxed(
    image: np.ndarray, box: LetterBox, input_size: Tuple[int, int], is_interpolated: bool = False
) -> np.ndarray:
    """Resize an image to the network's input; returns uint8 (height, width, 3).

    :param image: uint8 (height, width, 3)
    :param is_interpolated: whether images are reduced by linear interpolation, not by means
    """
    canvas = np.full((input_size[1], input_size[0], 3), GREY, np.uint8)
    means = max(box.scale) < 1.0 and not is_interpolated
    small = cv2.resize(image, box.inner, interpolation=cv2.INTER_AREA if means else cv2.INTER_LINEAR)
    canvas[box.top : box.top + box.inner[1], box.left : box.left + box.inner[0]] = small
    return canvas


def blob_of(
    image: np.ndarray, box: LetterBox, input_size: Tuple[int, int], is_interpolated: bool = False
) -> np.ndarray:
    """Convert an image to the network's input: float32 (1, 3, height, width) in [0, 1], RGB.

    :param image: uint8 (height, width, 3), red first
    :param is_interpolated: see letterboxed()
    """
    planes = letterboxed(image, box, input_size, is_interpolated).transpose(2, 0, 1)[np.newaxis]
    return np.ascontiguousarray(planes, np.float32) / np.float32(255.0)
