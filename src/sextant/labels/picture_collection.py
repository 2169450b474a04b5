# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Collects pictures for labelling: sharp ones that differ in view and light, spread over a drive."""

import json
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional

import cv2
import numpy as np

from sextant.base.atomic_file import atomic_file
from sextant.base.strict_params import StrictParams, param, within
from sextant.images.photo_depth import depth_path
from sextant.images.photo_file import find_photos, read_rgb
from sextant.images.sharpness import sharpness

GRID = (16, 12)  # cells of a thumbnail: smaller changes are no other view
JPEG_QUALITY = 95
REPORT = "collected.json"  # numbers of pictures, kept and dropped
RECENT = 50  # pictures whose median sharpness is the usual one
KEPT, BLURRED, DARK, ALIKE, THINNED = "kept", "blurred", "dark or white", "like another one", "thinned out"
ALREADY = "already there"


@dataclass(frozen=True)
class CollectionParams(StrictParams):
    """Which pictures are kept."""

    count: int = param(500, "maximum number of new pictures", within(1, 100000))
    difference: float = param(
        8.0, "minimum difference from every other picture, root mean square over a thumbnail", within(0, 255),
        "grey levels",
    )  # fmt: skip
    min_sharpness: float = param(
        0.5, "minimum sharpness, as a fraction of the median of the last pictures", within(0, 1)
    )
    min_contrast: float = param(8.0, "minimum standard deviation of a picture", within(0, 128), "grey levels")


class _Picture(NamedTuple):
    path: Path
    thumbnail: np.ndarray  # float32 (height * width * 3,)
    is_new: bool = False  # whether this collection wrote it


class PictureCollection:
    """A folder of pictures, which may have some from an earlier collection. Not thread-safe.

    When there are too many new ones, the required difference grows, and those that are too similar are
    deleted: the others are spread over all views and lights of the drive, however long it is. Pictures that
    were in the folder before stay, as they may have labels; new ones must differ from them, too.
    """

    def __init__(self, folder: Path, params: Optional[CollectionParams] = None):
        """:raises OSError, ValueError: the folder cannot be written, or a picture in it cannot be read"""
        self._params = params or CollectionParams()
        self._folder, self._difference = folder, self._params.difference
        folder.mkdir(parents=True, exist_ok=True)
        self._pictures = [
            _Picture(path, _thumbnail(read_rgb(path)[:, :, ::-1]))
            for path in find_photos(folder)
            if path.parent == folder
        ]
        self._sharpness: List[float] = []
        self.counts: Dict[str, int] = Counter(_read_counts(folder / REPORT))  # of pictures, by outcome

    def __len__(self) -> int:
        return len(self._pictures)

    def offer(self, name: str, image: np.ndarray) -> bool:
        """Writes a picture, unless it is of no use. Returns whether it was written; it may be deleted later.

        :param name: unique, without suffix; a picture that is there already is not offered again
        :param image: uint8 (height, width, 3), BGR
        :raises OSError: it cannot be written
        """
        path = self._folder / f"{name}.jpg"
        if path.exists():
            self.counts[ALREADY] += 1
            return False
        thumbnail = _thumbnail(image)
        reason = self._reason(image, thumbnail)
        self.counts[reason] += 1
        if reason != KEPT:
            return False
        _write(path, cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])[1].tobytes())
        self._pictures.append(_Picture(path, thumbnail, True))
        self._thin_out()
        return path.exists()

    def has(self, name: str) -> bool:
        """Whether there is a picture of this name."""
        return (self._folder / f"{name}.jpg").exists()

    def add_depth(self, name: str, depth: bytes) -> None:
        """Writes the depth of a picture beside it.

        :param depth: of encoded_depth()
        :raises OSError: it cannot be written
        """
        _write(depth_path(self._folder / f"{name}.jpg"), depth)

    def write_counts(self) -> None:
        """Writes the numbers of pictures beside them, so that a later collection continues them."""
        with atomic_file(self._folder / REPORT) as file:
            json.dump(dict(self.counts), file, indent=1)
            file.write("\n")

    def summary(self) -> List[str]:
        """What became of the pictures, in lines."""
        parts = [
            f"{count} {reason}" for reason, count in sorted(self.counts.items()) if reason != KEPT and count
        ]
        dropped = f"; dropped: {', '.join(parts)}" if parts else ""
        return [f"{self._folder}: {len(self)} pictures{dropped}"]

    def _reason(self, image: np.ndarray, thumbnail: np.ndarray) -> str:
        if image.std() <= self._params.min_contrast:
            return DARK
        sharp = sharpness(image) / float(np.var(image))  # which does not depend on the light
        usual = float(np.median(self._sharpness)) if self._sharpness else 0.0
        self._sharpness = [*self._sharpness[1 - RECENT :], sharp]
        if sharp < self._params.min_sharpness * usual:
            return BLURRED
        return ALIKE if self._nearest(thumbnail, self._pictures) < self._difference else KEPT

    @staticmethod
    def _nearest(thumbnail: np.ndarray, pictures: List[_Picture]) -> float:
        if not pictures:
            return np.inf
        others = np.stack([each.thumbnail for each in pictures])
        return float(np.sqrt(np.mean((others - thumbnail) ** 2, axis=1)).min())

    def _thin_out(self) -> None:
        """Keeps at most as many new pictures as wanted, with a difference that just suffices."""
        while sum(each.is_new for each in self._pictures) > self._params.count:
            self._difference = max(1.1 * self._difference, 1e-3)
            kept = [each for each in self._pictures if not each.is_new]
            for each in (each for each in self._pictures if each.is_new):
                if self._nearest(each.thumbnail, kept) >= self._difference:
                    kept.append(each)
                else:
                    self._drop(each)
            self._pictures = kept

    def _drop(self, picture: _Picture) -> None:
        self.counts[KEPT] -= 1
        self.counts[THINNED] += 1
        for path in (picture.path, depth_path(picture.path)):
            if path.exists():
                path.unlink()


def _thumbnail(image: np.ndarray) -> np.ndarray:
    return cv2.resize(image, GRID, interpolation=cv2.INTER_AREA).astype(np.float32).ravel()


def _write(path: Path, content: bytes) -> None:
    with atomic_file(path, "wb") as file:
        file.write(content)


def _read_counts(path: Path) -> Dict[str, int]:
    if not path.exists():
        return {}
    try:
        table = json.loads(path.read_text(encoding="utf-8"))
        if not all(type(value) is int for value in table.values()):
            raise ValueError
        return table
    except (ValueError, AttributeError):
        raise ValueError(f"{path}: is damaged, remove it; the pictures beside it are not affected") from None
