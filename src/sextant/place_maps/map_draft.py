# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A map that somebody is making photo by photo: every step is in its file at once, and can be undone.

What another program writes to the file meanwhile is never overwritten: steps are refused until it is read.
"""

from pathlib import Path
from typing import Dict, List, Optional, Tuple

from sextant.base.atomic_file import atomic_file
from sextant.place_maps.exif_map import find_photos
from sextant.place_maps.photo_file import SUFFIXES, decode_grey, geo_position, photo_size, read_grey
from sextant.place_maps.place_map import GeoCorners, Overview, Photo, PlaceMap, check_image, check_photo
from sextant.place_maps.place_map_file import place_map_text, read_place_map, write_place_map

HISTORY = 1000  # steps that can be undone


class MapDraft:
    """The map in a file; without one yet, it begins when the overview is chosen. Not thread-safe."""

    def __init__(self, path: Path, georeference: Optional[GeoCorners] = None):
        """:param georeference: of an overview that is chosen now; a map that is there has its own

        :raises OSError: the file or its folder cannot be read
        :raises ValueError: the file is no map, or lies elsewhere
        """
        self.path = path
        self._georeference = georeference
        self._map: Optional[PlaceMap] = None
        self._content: Optional[bytes] = None  # of the file, when it was read or written last
        self._history: List[PlaceMap] = []
        if not path.parent.is_dir():
            raise NotADirectoryError(20, "is no folder", str(path.parent))
        self.reload()

    def reload(self) -> None:
        """Reads the file again if another program changed it; then there is nothing to undo.

        :raises: as MapDraft(); then all is as it was
        """
        content = self._read()
        if content == self._content:
            return
        place_map = None if content is None else read_place_map(self.path)
        if place_map and self._georeference and place_map.georeference != self._georeference:
            raise ValueError(f"{self.path}: is there and lies elsewhere; its first line says where")
        self._map, self._content, self._history = place_map, content, []

    @property
    def place_map(self) -> Optional[PlaceMap]:
        """As it was in the file when it was read or written last; None: there is no overview yet."""
        return self._map

    def images(self) -> List[str]:
        """Photos in the folder and those below, and those of the map that are not there any more."""
        folder = self.path.parent
        overview = {self._map.overview.image} if self._map else set()
        found = {path.relative_to(folder).as_posix(): None for path in find_photos(folder)}
        known = [photo.image for photo in self._map.photos] if self._map else []
        return [image for image in dict.fromkeys([*found, *known]) if image not in overview]

    def placed(self) -> Dict[str, Photo]:
        """Photos of the map by image."""
        return {photo.image: photo for photo in self._map.photos} if self._map else {}

    def guess(self, image: str) -> Optional[Tuple[float, float]]:
        """Pixels of the overview where a photo was taken by its EXIF; None: it says nothing, or elsewhere.

        :param image: one of images(), which is not looked for again
        """
        if not self._map or not isinstance(self._map.georeference, GeoCorners):
            return None
        try:
            position = geo_position(self.path.parent / image)
        except (OSError, ValueError):  # said when the photo is used
            return None
        if position is None:
            return None
        overview = self._map.overview
        x, y = self._map.georeference.pixel(overview, position.latitude, position.longitude)
        return (x, y) if 0 <= x <= overview.width and 0 <= y <= overview.height else None

    def choose_overview(self, image: str) -> None:
        """Begins the map.

        :raises ValueError: the file is no picture, or the map has an overview already
        """
        if self._map:
            raise ValueError(f"{self.path}: has the overview {self._map.overview.image} already")
        width, height = photo_size(self.file(image))
        empty = PlaceMap(self.path.parent, Overview(image, width, height), (), self._georeference)
        self._save(empty)

    def place(self, image: str, x: float, y: float) -> Photo:
        """Puts a photo at a pixel of the overview, or moves it there.

        :raises ValueError: there is no overview or no such photo, or the pixel is outside
        """
        place_map = self._begun()
        if image == place_map.overview.image:
            raise ValueError(f"{image}: is the overview")
        old = self.placed().get(image)
        number = old.id if old else place_map.next_id()
        photo = Photo(number, image, x, y, old.yaw if old else None)
        check_photo(place_map.overview, photo)
        if not old:
            read_grey(self.file(image))  # all of it
        others = [photo if each.image == image else each for each in place_map.photos]
        self._step(place_map._replace(photos=tuple(others if old else [*others, photo])))
        return photo

    def remove(self, image: str) -> None:
        """Takes a photo out of the map; its file stays.

        :raises ValueError: it is not in the map
        """
        place_map = self._begun()
        if image not in self.placed():
            raise ValueError(f"{image}: is not in the map")
        self._step(place_map._replace(photos=tuple(p for p in place_map.photos if p.image != image)))

    @property
    def can_undo(self) -> bool:
        """Whether there is a step to take back."""
        return bool(self._history)

    def undo(self) -> None:
        """Takes the last step back, if there is one."""
        if self._history:
            self._save(self._history[-1])
            self._history.pop()

    def add_file(self, name: str, content: bytes) -> str:
        """Puts a picture into the map's folder.

        :returns: its name there
        :raises ValueError: it is no picture, its name leads elsewhere, or another file has it
        """
        path = self.path.parent / name
        if Path(name).name != name or name.startswith(".") or path.suffix.lower() not in SUFFIXES:
            raise ValueError(f"'{name}' is no name of a picture ({', '.join(SUFFIXES)})")
        if path.exists():
            if path.read_bytes() == content:
                return name
            raise ValueError(f"{name}: another file has this name; rename it")
        check_image(name)
        decode_grey(content, name)
        with atomic_file(path, "wb") as file:
            file.write(content)
        return name

    def _begun(self) -> PlaceMap:
        if not self._map:
            raise ValueError("choose the overview first")
        return self._map

    def file(self, image: str) -> Path:
        """:raises ValueError: it is neither the overview nor one of images()"""
        overview = self._map.overview.image if self._map else None
        if image not in (overview, *self.images()):
            raise ValueError(f"{image}: there is no such photo in {self.path.parent}")
        return self.path.parent / image

    def _step(self, changed: PlaceMap) -> None:
        before = self._begun()
        self._save(changed)
        self._history = [*self._history, before][-HISTORY:]

    def _save(self, place_map: PlaceMap) -> None:
        if self._read() != self._content:
            raise ValueError(
                f"{self.path}: another program changed it, so this step is not saved; "
                "reload the page to go on with what is there now"
            )
        write_place_map(self.path, place_map)
        self._map, self._content = place_map, place_map_text(place_map).encode()

    def _read(self) -> Optional[bytes]:
        return self.path.read_bytes() if self.path.exists() else None
