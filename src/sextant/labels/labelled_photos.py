# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Photos with the boxes and classes of the objects in them."""

from pathlib import Path
from typing import Iterable, List, NamedTuple, Sequence, Tuple

import numpy as np

SLACK = 1.0  # pixels by which rounding may move a side out of the photo


class LabelledPhoto(NamedTuple):
    """A photo and the objects in it."""

    path: Path  # image file
    size: Tuple[int, int]  # width and height, pixels
    boxes: np.ndarray  # (n, 4) left, top, right, bottom, pixels; (0, 0) is the corner of the first pixel
    classes: np.ndarray  # int (n,) indices of the classes


class LabelledPhotos(NamedTuple):
    """Photos with the same classes."""

    classes: Tuple[str, ...]  # names by index
    photos: Tuple[LabelledPhoto, ...]  # in the order of the file

    def counts(self) -> np.ndarray:
        """Number of objects of each class."""
        indices = [np.zeros(0, int), *(photo.classes for photo in self.photos)]
        return np.bincount(np.concatenate(indices), minlength=len(self.classes))


def labelled_photo(
    path: Path, size: Tuple[int, int], boxes: Sequence[Sequence[float]], classes: Sequence[int]
) -> LabelledPhoto:
    """A photo with checked boxes, cut at the photo's borders.

    :raises ValueError: a box is not finite, is empty or is not in the photo
    """
    table = np.array(boxes, float).reshape(-1, 4)
    for box in table:
        check_box(box, size)
    limit = np.array([*size, *size], float)
    return LabelledPhoto(path, size, np.clip(table, 0.0, limit), np.array(classes, int).reshape(-1))


def check_box(box: Sequence[float], size: Tuple[int, int]) -> None:
    """:raises ValueError: a box (left, top, right, bottom) is not finite, is empty or is not in the photo"""
    left, top, right, bottom = box
    if not np.all(np.isfinite(box)):
        raise ValueError("its box is not finite")
    if right <= left or bottom <= top:
        raise ValueError(f"its box has {right - left:g} × {bottom - top:g} pixels, it must not be empty")
    if min(left, top) < -SLACK or right > size[0] + SLACK or bottom > size[1] + SLACK:
        where = f"x {left:.1f} to {right:.1f}, y {top:.1f} to {bottom:.1f}"
        raise ValueError(f"its box ({where}) leaves the photo of {size[0]} × {size[1]} pixels")


def box_around(points: Sequence[Sequence[float]]) -> List[float]:
    """Left, top, right, bottom of points (n, 2)."""
    table = np.asarray(points, float)
    return [*table.min(axis=0), *table.max(axis=0)]


def with_classes(photos: LabelledPhotos, names: Sequence[str], where: str) -> LabelledPhotos:
    """The same photos with the classes in another order; classes that are not named must have no objects.

    :param where: the photos' file, for the error
    :raises ValueError: an object has a class that is not named
    """
    counts = photos.counts()
    lost = [name for name, count in zip(photos.classes, counts) if count and name not in names]
    if lost:
        raise ValueError(f"{where}: has objects of {', '.join(lost)}; the classes are {', '.join(names)}")
    to = np.array([names.index(name) if name in names else -1 for name in photos.classes] or [0], int)
    moved = (photo._replace(classes=to[photo.classes]) for photo in photos.photos)
    return LabelledPhotos(tuple(names), tuple(moved))


def check_names(names: Iterable[object], where: str) -> Tuple[str, ...]:
    """Class names.

    :raises ValueError: none, an empty one, or one twice
    """
    found = tuple(str(name).strip() for name in names)
    twice = [name for name in found if found.count(name) > 1]
    if not found or not all(found) or twice:
        problem = (
            f"{twice[0]} is there twice" if twice else "there must be at least one, and none may be empty"
        )
        raise ValueError(f"{where}: class names: {problem}")
    return found
