# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Images with ground truth, and sets of them for a network."""

from functools import partial
from typing import Callable, List, NamedTuple, Sequence

import numpy as np

from sextant.base.jobs import run_jobs
from sextant.detection_scores.average_precision import TrueObjects
from sextant.objects.letter_box import letter_box, letterboxed


class ObjectImage(NamedTuple):
    """An image and its ground truth."""

    image: np.ndarray  # uint8 (height, width, 3), RGB
    truth: TrueObjects  # boxes and classes


class ImageSet(NamedTuple):
    """Letterboxed images of one size with ground truth; most: the largest number of objects in an image."""

    images: np.ndarray  # uint8 (n, size, size, 3), RGB
    boxes: np.ndarray  # (n, most, 4) left, top, right, bottom, pixels
    classes: np.ndarray  # (n, most) int
    exists: np.ndarray  # (n, most) bool; False: padding
    is_counted: np.ndarray  # (n, most) bool, as TrueObjects.is_counted

    def truths(self) -> List[TrueObjects]:
        """Ground truth of each image."""
        return [
            TrueObjects(boxes[exists], classes[exists], is_counted[exists])
            for boxes, classes, exists, is_counted in zip(
                self.boxes, self.classes, self.exists, self.is_counted
            )
        ]


def drawn_images(
    draw: Callable[[int, int], ObjectImage], seeds: Sequence[int], size: int, jobs: int, progress: str = ""
) -> ImageSet:
    """Draws and letterboxes images.

    :param draw: function of a seed and size, as random_image(); it must be possible to pickle it
    :param size: side of the network's input, pixels
    :param jobs: number of parallel processes
    :param progress: title of the progress bar, as in run_jobs()
    """
    drawn = run_jobs(partial(_letterboxed_drawing, draw, size), seeds, jobs, progress=progress)
    return stacked_images(list(drawn))


def letterboxed_image(drawn: ObjectImage, size: int) -> ObjectImage:
    """An image and its boxes in the square input of a network.

    :param size: side of the input, pixels
    """
    box = letter_box((drawn.image.shape[1], drawn.image.shape[0]), (size, size))
    truth = drawn.truth._replace(boxes=box.to_input(drawn.truth.boxes))
    return ObjectImage(letterboxed(drawn.image, box, (size, size)), truth)


def stacked_images(images: Sequence[ObjectImage]) -> ImageSet:
    """A set of letterboxed images of the same size."""
    most = max([1, *(len(each.truth.classes) for each in images)])
    return ImageSet(
        images=np.array([each.image for each in images]),
        boxes=_filled([each.truth.boxes for each in images], most),
        classes=_filled([each.truth.classes for each in images], most),
        exists=_filled([np.ones(len(each.truth.classes), bool) for each in images], most),
        is_counted=_filled([each.truth.is_counted for each in images], most),
    )


def joined_sets(sets: Sequence[ImageSet]) -> ImageSet:
    """All images of some sets of the same size."""
    images = [ObjectImage(image, truth) for part in sets for image, truth in zip(part.images, part.truths())]
    return stacked_images(images)


def _letterboxed_drawing(draw: Callable[[int, int], ObjectImage], size: int, seed: int) -> ObjectImage:
    return letterboxed_image(draw(seed, size), size)


def _filled(rows: Sequence[np.ndarray], most: int) -> np.ndarray:
    """Stacks rows to (n, most, ...), padded with zeros."""
    filled = np.zeros((len(rows), most, *rows[0].shape[1:]), rows[0].dtype)
    for i, row in enumerate(rows):
        filled[i, : len(row)] = row
    return filled
