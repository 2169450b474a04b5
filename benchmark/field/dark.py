# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poor light: how many tags are found in darkened photos and in rendered rooms, against libapriltag."""

from pathlib import Path
from typing import Iterable, List

from tables import Table, Value
from under_test import detector

from field.images import SIZES, TAGS, KnownImage, darkened, libapriltag, rendered, tag_photos

BRIGHTNESS = (1.0, 0.1, 0.05)
WHITE, READ_NOISE = 200.0, 0.7  # grey levels of the rendered images
FRAMES, QUICK_FRAMES = 60, 6
COLUMNS = ["tags", "libapriltag's", "ours", "over libapriltag's", "wrong, libapriltag's", "wrong, ours"]


def dark_tables(data: Path, quick: bool) -> List[Table]:
    """Photos and rendered images. :raises OSError: no photos"""
    photos = list(tag_photos(data).values())
    rows = []
    for brightness in BRIGHTNESS:
        dark = [photo._replace(grey=darkened(photo.grey, brightness)) for photo in photos]
        rows.append((f"photos, {100 * brightness:g} %", _cells(dark, brightness, quick)))
    for name, size in SIZES.items():
        for brightness in BRIGHTNESS[1:]:
            room = rendered(
                size,
                QUICK_FRAMES if quick else FRAMES,
                white_level=brightness * WHITE,
                noise_sigma=READ_NOISE,
            )
            cells = _cells(room, brightness, quick)
            rows.append((f"rendered, {name}, {100 * brightness:g} %", cells))
    return [Table(f"{TAGS} by brightness, full search", COLUMNS, rows)]


def _cells(images: Iterable[KnownImage], brightness: float, quick: bool) -> List[Value]:
    plain, ours = libapriltag(), detector(TAGS).detect
    known = theirs = found = wrong = theirs_wrong = 0
    for image in images:
        tags, detections = plain(image.grey), ours(image.grey)
        known += len(image.markers)
        theirs, found = theirs + image.count(tags), found + image.count(detections)
        theirs_wrong, wrong = theirs_wrong + image.wrong(tags), wrong + image.wrong(detections)
    has_bar = not quick and brightness < 1.0
    ratio = Value(found / theirs if theirs else float("nan"), 3, at_least=1.0 if has_bar else None)
    return [
        Value(known, 0),
        Value(theirs, 0),
        Value(found, 0),
        ratio,
        Value(theirs_wrong, 0),
        Value(wrong, 0),
    ]
