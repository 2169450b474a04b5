# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The index of a map as it is now: from the cache what is still right, the rest from the photos."""

from dataclasses import dataclass
from pathlib import Path
from typing import Callable, Dict, Iterable, List, Optional, Set

from sextant.place_maps.place_map import PlaceMap
from sextant.places.place_cache import CacheError, cache_path, read_cache, write_cache
from sextant.places.place_index import (
    NAMED_AT_MOST,
    IndexedPhoto,
    IndexParams,
    PhotoFeatures,
    PlaceIndex,
    content_digest,
    extract_all,
    file_state,
)

GROWTH = 4  # an index of more than this many times the photos that it learned from is made anew

Report = Callable[[str], None]


@dataclass(frozen=True)
class Library:
    """A map's photos, and who describes them."""

    map_path: Path
    place_map: PlaceMap
    params: IndexParams
    jobs: int = 1  # and scheduler: as in sextant.base.jobs.run_jobs()
    scheduler: str = ""
    report: Report = lambda line: None  # gets lines: what is built, and why

    def index(self) -> PlaceIndex:
        """From the cache beside the map, brought up to date with the photos; the cache, too.

        :raises OSError: the global descriptor's model cannot be read
        :raises ValueError: settings or photos that cannot be used, by name
        """
        self.params.validate()
        images = list(dict.fromkeys(photo.image for photo in self.place_map.photos))
        self._check_there(images)
        index = self._cached()
        if index is None or len(images) > GROWTH * index.learned_from:
            self.report(f"{self.map_path}: describing {len(images)} photos")
            index = self._built(images)
        elif not self._update(index, images):
            return index
        self._check_keypoints(photo.count for photo in index.photos)
        self._store(index)
        return index

    def _check_there(self, images: List[str]) -> None:
        if not images:
            raise ValueError(f"{self.map_path}: there is no photo in the map")
        lacking = [image for image in images if not (self.place_map.folder / image).is_file()]
        if lacking:
            raise ValueError(f"{self.map_path}: photos that are not there: {_named(lacking)}")

    def _cached(self) -> Optional[PlaceIndex]:
        try:
            return read_cache(cache_path(self.map_path), self.params)
        except FileNotFoundError:
            return None
        except (OSError, CacheError) as error:
            self.report(f"{error}; building it anew")
            return None

    def _built(self, images: List[str]) -> PlaceIndex:
        features = self._describe(images)
        self._check_keypoints(len(each.keypoints) for each in features)
        return PlaceIndex.built(self.params, images, features)

    def _update(self, index: PlaceIndex, images: List[str]) -> bool:
        """Whether anything had to be changed; the state of a file that is the same one, too."""
        before, kept = index.photos, self._kept(index, set(images))
        index.photos = [kept.get(photo.image, photo) for photo in before]
        is_refreshed = index.photos != before
        gone = [photo for photo in before if photo.image not in kept]
        new = [image for image in images if image not in kept]
        self._tell("gone or changed", [photo.image for photo in gone])
        self._tell("to be described", new)
        features = self._describe(new)
        index.remove(gone)
        index.add(new, features)
        return bool(gone or new or is_refreshed)

    def _tell(self, what: str, names: List[str]) -> None:
        if names:
            self.report(f"{self.map_path}: {len(names)} photos {what}: {_named(names)}")

    def _kept(self, index: PlaceIndex, wanted: Set[str]) -> Dict[str, IndexedPhoto]:
        """Photos that need not be described again, by image."""
        found = [self._refreshed(photo) for photo in index.photos if photo.image in wanted]
        return {photo.image: photo for photo in found if photo}

    def _refreshed(self, photo: IndexedPhoto) -> Optional[IndexedPhoto]:
        """With the state that its file has now; None: the content is another one."""
        path = self.place_map.folder / photo.image
        state = file_state(path)  # before the content: a change after it is seen by the next start
        if state == photo.state:
            return photo
        return photo._replace(state=state) if content_digest(path.read_bytes()) == photo.digest else None

    def _describe(self, images: List[str]) -> List[PhotoFeatures]:
        paths = [self.place_map.folder / image for image in images]
        features = extract_all(self.params, paths, self.jobs, self.scheduler)
        empty = [image for image, each in zip(images, features) if not len(each.keypoints)]
        self._tell("without a keypoint", empty)
        return features

    def _check_keypoints(self, counts: Iterable[int]) -> None:
        if not any(counts):
            raise ValueError(f"{self.map_path}: no keypoint in any photo of the map")

    def _store(self, index: PlaceIndex) -> None:
        if self.params.matcher != "faiss":
            return
        try:
            write_cache(cache_path(self.map_path), index)
        except OSError as error:
            self.report(f"the index is not stored, every start takes this long: {error}")


def _named(names: List[str]) -> str:
    more = f" and {len(names) - NAMED_AT_MOST} more" if len(names) > NAMED_AT_MOST else ""
    return ", ".join(names[:NAMED_AT_MOST]) + more
