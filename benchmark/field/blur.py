# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Motion blur of 12 pixels: how many tags are found, against libapriltag at full resolution with a decision
margin of 20, which was the search before there was a second scale and a comparison of grey levels."""

from pathlib import Path
from typing import Iterable, Iterator, List

import cv2
import numpy as np
from tables import Table, Value
from under_test import detector

from field.images import SIZES, TAGS, KnownImage, blurred, libapriltag, rendered, tag_photos

LENGTH = 12  # pixels
FORMER_MARGIN = 20.0  # grey levels
GAIN = 1.5
# Bars by side, pixels. Smaller tags cannot be read under this blur; nearly all larger ones can.
GAINS = {(30.0, 60.0): GAIN, (60.0, 120.0): 1.0}
FRAMES, QUICK_FRAMES = 120, 6
SCALES = (1.0, 1.6, 2.4)  # of the photos, whose tags have sides of 13 to 45 pixels
DIRECTIONS = 6
COLUMNS = ["tags", "libapriltag, d 1", "libapriltag, d 2", "ours", "over d 1's", "wrong, d 1", "wrong, ours"]


def blur_tables(data: Path, quick: bool) -> List[Table]:
    """Rendered images and photos. :raises OSError: no photos"""
    photos = list(tag_photos(data).values())
    rows = []
    room = list(
        blurred_rooms(rendered(SIZES["640 x 480"], QUICK_FRAMES if quick else FRAMES, noise_sigma=2.0))
    )
    for (least, most), gain in GAINS.items():
        images = [sized(image, least, most) for image in room]
        name = f"rendered, sides of {least:g} to {most:g} pixels"
        rows.append((name, _cells(images, None if quick else gain)))
    scales = SCALES[-1:] if quick else SCALES
    rows.append(("photos", _cells(blurred_photos(photos, scales), None if quick else GAIN)))
    return [Table(f"{TAGS}, motion blur of {LENGTH} pixels, full search", COLUMNS, rows)]


def blurred_rooms(images: Iterable[KnownImage]) -> Iterator[KnownImage]:
    """The images, each blurred in another direction."""
    random = np.random.default_rng(11)
    for image in images:
        yield image._replace(grey=blurred(image.grey, LENGTH, random.uniform(0, np.pi)))


def sized(image: KnownImage, least: float, most: float) -> KnownImage:
    """The image; of its markers, those with sides (pixels) between these limits are known."""
    return image._replace(markers=[marker for marker in image.markers if least <= marker[2] < most])


def blurred_photos(photos: List[KnownImage], scales: Iterable[float]) -> Iterator[KnownImage]:
    """The photos at several scales, blurred in several directions."""
    for photo in photos:
        for scale in scales:
            large = cv2.resize(photo.grey, None, fx=scale, fy=scale, interpolation=cv2.INTER_CUBIC)
            markers = [(id, scale * centre, scale * side) for id, centre, side in photo.markers]
            for k in range(DIRECTIONS):
                yield KnownImage(blurred(large, LENGTH, (k + 0.5) * np.pi / DIRECTIONS), markers, photo.ids)


def _cells(images: Iterable[KnownImage], bar) -> List[Value]:
    finds = [libapriltag(1.0, FORMER_MARGIN), libapriltag(2.0), detector(TAGS).detect]
    known, counts, wrong = 0, [0, 0, 0], [0, 0, 0]
    for image in images:
        known += len(image.markers)
        for k, find in enumerate(finds):
            found = find(image.grey)
            counts[k] += image.count(found)
            wrong[k] += image.wrong(found)
    gain = Value(counts[2] / counts[0] if counts[0] else float("nan"), 2, at_least=bar)
    return [*(Value(each, 0) for each in (known, *counts)), gain, Value(wrong[0], 0), Value(wrong[2], 0)]
