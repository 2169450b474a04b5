# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tracking against full search of the same images, from a moving camera."""

import time
from pathlib import Path
from typing import Callable, Dict, Iterable, Iterator, List

from tables import Row, Table, Value
from under_test import detector

from field.images import SIZES, TAGS, KnownImage, rendered, tag_photos, views_of

DECIMATE = (1.0, 2.0)
LEAST, MOST_CPU = 0.99, 1.0
PHOTO_SCALES = {"640 x 480": 1.5, "1280 x 720": 2.5}
FRAMES, QUICK_FRAMES = 120, 12
PHOTO_FRAMES, QUICK_PHOTO_FRAMES = 120, 12
COLUMNS = ["tags", "full", "tracking", "over full's", "CPU over full's"]


class Race:
    """Full search and tracking on the same images."""

    def __init__(self, changed: dict):
        self._searches = {
            name: detector(TAGS, search=name, **changed).detect for name in ("full", "tracking")
        }
        self.known = 0
        self.found: Dict[str, int] = dict.fromkeys(self._searches, 0)
        self.cpu: Dict[str, float] = dict.fromkeys(self._searches, 0.0)  # seconds

    def run(self, images: Iterable[KnownImage]) -> "Race":
        for image in images:
            self.known += len(image.markers)
            for name, find in self._searches.items():
                start = time.process_time()
                found = find(image.grey)
                self.cpu[name] += time.process_time() - start
                self.found[name] += image.count(found)
        return self

    @property
    def share(self) -> float:
        """Tags that tracking finds, over those of the full search."""
        return self.found["tracking"] / max(1, self.found["full"])

    @property
    def cost(self) -> float:
        """CPU time of tracking over that of the full search."""
        return self.cpu["tracking"] / self.cpu["full"]


def tracking_tables(data: Path, quick: bool) -> List[Table]:
    """A table a source of images. :raises OSError: no photos"""
    photos = list(tag_photos(data).values())
    frames = QUICK_FRAMES if quick else FRAMES
    rooms = {name: lambda size=size: rendered(size, frames) for name, size in SIZES.items()}
    count = QUICK_PHOTO_FRAMES if quick else PHOTO_FRAMES
    views = {name: lambda name=name: _all_views(photos, name, count) for name in SIZES}
    return [
        Table("Tracking in a rendered room", COLUMNS, _rows(rooms, quick)),
        Table("Tracking in front of photos", COLUMNS, _rows(views, quick)),
    ]


def _all_views(photos: List[KnownImage], size: str, count: int) -> Iterator[KnownImage]:
    for photo in photos:
        yield from views_of(photo, count, SIZES[size], PHOTO_SCALES[size])


def _rows(sources: Dict[str, Callable[[], Iterable[KnownImage]]], quick: bool) -> List[Row]:
    rows = []
    for name, source in sources.items():
        images = list(source())
        for factor in DECIMATE:
            race = Race({"decimate": factor}).run(images)
            share = Value(race.share, 3, at_least=None if quick else LEAST)
            cost = Value(race.cost, 3, at_most=None if quick else MOST_CPU)
            counts = (race.known, race.found["full"], race.found["tracking"])
            rows.append(
                (f"{TAGS}, decimate {factor:g}, {name}", [*(Value(each, 0) for each in counts), share, cost])
            )
    return rows
