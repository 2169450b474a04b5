# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Builds the index of a map, or updates the cached one with new and changed photos."""

from dataclasses import dataclass
from pathlib import Path
from typing import Callable, Dict, Iterable, List, Optional, Set

import sextant
from sextant.place_maps.place_map import PlaceMap
from sextant.places.place_index import (
    MAX_NAMES,
    IndexedPhoto,
    IndexParams,
    PhotoFeatures,
    PlaceIndex,
    content_digest,
    extract_all,
    file_state,
)
from sextant.places.place_index_file import CacheError, cache_path, read_cache, write_cache

MANY = 100_000  # descriptors; searching this number exactly takes about a second per image
GROWTH = 4  # the index is rebuilt if the map has more than this times the photos that trained it

Report = Callable[[str], None]


@dataclass(frozen=True)
class PlaceIndexer:
    """Builds and caches the index of one map."""

    map_path: Path  # of the map file, for messages
    place_map: PlaceMap  # content of the map file
    params: IndexParams  # features and index
    jobs: int = 1  # processes, see sextant.base.jobs.run_jobs()
    scheduler: str = ""  # of a Dask cluster, see sextant.base.jobs.run_jobs()
    report: Report = lambda line: None  # called with each progress message
    cache: Optional[Path] = None  # file of the cache; None: beside the map

    def index(self) -> PlaceIndex:
        """Returns the index of the current photos; reads and updates the cache beside the map.

        :raises OSError: the global descriptor's model cannot be read
        :raises ValueError: names the parameters or photos that cannot be used
        """
        self.params.validate()
        images = list(dict.fromkeys(photo.image for photo in self.place_map.photos))
        self._check_there(images)
        index = self._indexed(images)
        if self.params.matcher == "faiss" and not sextant.has_faiss() and len(index.descriptors) > MANY:
            self.report(
                f"{self.map_path}: the exact search of {len(index.descriptors)} descriptors is slow"
                " (built without faiss): use fewer photos, a lower max_features, or matcher FlannBased"
            )
        return index

    def _indexed(self, images: List[str]) -> PlaceIndex:
        """The cached index after an update, or a new one; stores it if it changed."""
        index = self._cached()
        if index is None or len(images) > GROWTH * index.learned_from:
            self.report(f"{self.map_path}: describing {len(images)} photos")
            index = PlaceIndex.built(self.params, images, self._describe(images))
        elif not self._update(index, images):
            return index
        self._store(index)
        return index

    def _check_there(self, images: List[str]) -> None:
        if not images:
            raise ValueError(f"{self.map_path}: the map has no photos")
        missing = [image for image in images if not (self.place_map.folder / image).is_file()]
        if missing:
            raise ValueError(f"{self.map_path}: missing photos: {_listed(missing)}")

    def _cached(self) -> Optional[PlaceIndex]:
        try:
            return read_cache(self._cache_path(), self.params)
        except FileNotFoundError:
            return None
        except (OSError, CacheError) as error:
            self.report(f"{error}; the index is rebuilt")
            return None

    def _cache_path(self) -> Path:
        return self.cache or cache_path(self.map_path)

    def _update(self, index: PlaceIndex, images: List[str]) -> bool:
        """Adds and removes photos. Returns whether the cache is outdated, if only by the state of a file."""
        before, kept = index.photos, self._kept(index, set(images))
        index.photos = [kept.get(photo.image, photo) for photo in before]
        is_refreshed = index.photos != before
        removed = [photo for photo in before if photo.image not in kept]
        new = [image for image in images if image not in kept]
        self._report_photos("removed or changed", [photo.image for photo in removed])
        self._report_photos("to be described", new)
        features = self._describe(new, kept.values())
        index.remove(removed)
        index.add(new, features)
        return bool(removed or new or is_refreshed)

    def _report_photos(self, what: str, names: List[str]) -> None:
        if names:
            self.report(f"{self.map_path}: {len(names)} photos {what}: {_listed(names)}")

    def _kept(self, index: PlaceIndex, wanted: Set[str]) -> Dict[str, IndexedPhoto]:
        """Indexed photos whose content is unchanged, by image."""
        refreshed = [self._refreshed(photo) for photo in index.photos if photo.image in wanted]
        return {photo.image: photo for photo in refreshed if photo}

    def _refreshed(self, photo: IndexedPhoto) -> Optional[IndexedPhoto]:
        """The photo with the current state of its file; None if the content changed."""
        path = self.place_map.folder / photo.image
        state = file_state(path)  # before reading the content: the next start then detects a later change
        if state == photo.state:
            return photo
        return photo._replace(state=state) if content_digest(path.read_bytes()) == photo.digest else None

    def _describe(self, images: List[str], kept: Iterable[IndexedPhoto] = ()) -> List[PhotoFeatures]:
        """Extracts the features of new photos.

        :raises ValueError: neither these photos nor the kept ones have a keypoint
        """
        paths = [self.place_map.folder / image for image in images]
        features = extract_all(self.params, paths, self.jobs, self.scheduler)
        empty = [image for image, each in zip(images, features) if not len(each.keypoints)]
        self._report_photos("without a keypoint", empty)
        if len(empty) == len(images) and not any(photo.count for photo in kept):
            raise ValueError(f"{self.map_path}: no keypoint in any photo of the map")
        return features

    def _store(self, index: PlaceIndex) -> None:
        try:
            write_cache(self._cache_path(), index)
        except OSError as error:
            self.report(f"the index cannot be cached, every start has to rebuild it: {error}")


def _listed(names: List[str]) -> str:
    more = f" and {len(names) - MAX_NAMES} more" if len(names) > MAX_NAMES else ""
    return ", ".join(names[:MAX_NAMES]) + more
