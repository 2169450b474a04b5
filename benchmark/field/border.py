# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tags at the image border: photos cut so that a corner lies outside, against libapriltag."""

from pathlib import Path
from typing import Iterator, List

import numpy as np
from tables import Table, Value
from under_test import detector

from field.images import TAGS, KnownImage, libapriltag, tag_photos

OUTSIDE = np.arange(-3.0, 4.0)  # pixels from the outermost corner to the border
COLUMNS = ["views", "libapriltag's", "ours", "over libapriltag's"]


def border_tables(data: Path, quick: bool) -> List[Table]:
    """One table. :raises OSError: no photos"""
    photos = list(tag_photos(data).values())
    plain, ours = libapriltag(), detector(TAGS).detect
    views = theirs = found = 0
    for view in cut_views(photos[:1] if quick else photos, plain):
        views += 1
        theirs += view.count(plain(view.grey))
        found += view.count(ours(view.grey))
    ratio = Value(found / theirs, 3, at_least=None if quick else 1.0)
    rows = [(TAGS, [*(Value(count, 0) for count in (views, theirs, found)), ratio])]
    return [Table("Tags of photos that the border of the image touches", COLUMNS, rows)]


def cut_views(photos: List[KnownImage], find) -> Iterator[KnownImage]:
    """The photos without what is left of, or above, a line near a corner of a tag."""
    for photo in photos:
        for tag in find(photo.grey):
            for axis in (0, 1):
                for outside in OUTSIDE:
                    yield _cut(photo, tag, axis, int(round(tag.corners[:, axis].min() + outside)))


def _cut(photo: KnownImage, tag, axis: int, at: int) -> KnownImage:
    at = max(0, at)
    grey = photo.grey[:, at:] if axis == 0 else photo.grey[at:]
    centre = tag.corners.mean(axis=0) - at * np.eye(2)[axis]
    side = float(np.linalg.norm(tag.corners - np.roll(tag.corners, 1, axis=0), axis=1).mean())
    return KnownImage(np.ascontiguousarray(grey), [(tag.id, centre, side)], photo.ids)
