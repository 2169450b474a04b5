# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A map that a user edits interactively: every step is saved at once and can be undone.

Changes of the file by other programs are never overwritten: steps are refused until reload().
"""

from pathlib import Path
from typing import Dict, List, Optional, Tuple

from sextant.base.atomic_file import atomic_file
from sextant.images.photo_file import (
    SUFFIXES,
    decode_grey,
    find_photos,
    geo_position,
    photo_size,
    read_grey,
)
from sextant.place_maps.place_map import GeoCorners, Overview, Photo, PlaceMap, check_image, check_photo
from sextant.place_maps.place_map_file import place_map_text, read_place_map, write_place_map

HISTORY = 1000  # maximum number of steps that can be undone


class PlaceMapDraft:
    """Draft of a map file, which is created when the overview is chosen. Not thread-safe."""

    path: Path  # of the map file
    place_map: Optional[PlaceMap]  # content of the file; None until the overview is chosen

    def __init__(self, path: Path, georeference: Optional[GeoCorners] = None):
        """:param path: of the map file, which may not exist yet

        :param georeference: corners of the overview, for a new map
        :raises OSError: the file or its folder cannot be read
        :raises ValueError: the file is not a map, or has another georeference
        """
        self.path = path
        self._georeference = georeference
        self._content: Optional[bytes] = None  # of the file, when it was last read or written
        self.place_map = None
        self._history: List[PlaceMap] = []
        if not path.parent.is_dir():
            raise NotADirectoryError(20, "is not a folder", str(path.parent))
        self.reload()

    def reload(self) -> None:
        """Reads the file again if another program changed it, and clears the undo history.

        :raises: as PlaceMapDraft(); then the draft is unchanged
        """
        content = self._read()
        if content == self._content:
            return
        place_map = None if content is None else read_place_map(self.path)
        if place_map and self._georeference and place_map.georeference != self._georeference:
            raise ValueError(f"{self.path}: exists with another georeference, see its first line")
        self.place_map, self._content, self._history = place_map, content, []

    def images(self) -> List[str]:
        """Photos in the folder and its subfolders, and photos of the map whose files are missing."""
        folder = self.path.parent
        overview = {self.place_map.overview.image} if self.place_map else set()
        found = {path.relative_to(folder).as_posix(): None for path in find_photos(folder)}
        known = [photo.image for photo in self.place_map.photos] if self.place_map else []
        return [image for image in dict.fromkeys([*found, *known]) if image not in overview]

    def placed(self) -> Dict[str, Photo]:
        """Photos of the map by image."""
        return {photo.image: photo for photo in self.place_map.photos} if self.place_map else {}

    def guess(self, image: str) -> Optional[Tuple[float, float]]:
        """Position of a photo from its EXIF data, pixels of the overview; None if unknown or outside.

        :param image: one of images(); this is not checked
        """
        if not self.place_map or not isinstance(self.place_map.georeference, GeoCorners):
            return None
        try:
            position = geo_position(self.path.parent / image)
        except (OSError, ValueError):  # reported when the photo is placed
            return None
        if position is None:
            return None
        overview = self.place_map.overview
        x, y = self.place_map.georeference.pixel(overview, position.latitude, position.longitude)
        return (x, y) if 0 <= x <= overview.width and 0 <= y <= overview.height else None

    def choose_overview(self, image: str) -> None:
        """Begins the map with its overview.

        :raises ValueError: the file is not an image, or the map already has an overview
        """
        if self.place_map:
            raise ValueError(f"{self.path}: already has the overview {self.place_map.overview.image}")
        width, height = photo_size(self.file(image))
        empty = PlaceMap(self.path.parent, Overview(image, width, height), (), self._georeference)
        self._save(empty)

    def place(self, image: str, x: float, y: float) -> Photo:
        """Sets the position of a photo, pixels of the overview.

        :raises ValueError: there is no overview or no such photo, or the position is outside
        """
        place_map = self._chosen()
        if image == place_map.overview.image:
            raise ValueError(f"{image}: is the overview")
        old = self.placed().get(image)
        number = old.id if old else place_map.next_id()
        photo = Photo(number, image, x, y, old.yaw if old else None)
        check_photo(place_map.overview, photo)
        if not old:
            read_grey(self.file(image))  # raises if the photo is damaged
        others = [photo if each.image == image else each for each in place_map.photos]
        self._step(place_map._replace(photos=tuple(others if old else [*others, photo])))
        return photo

    def remove(self, image: str) -> None:
        """Removes a photo from the map; its file is kept.

        :raises ValueError: the photo is not in the map
        """
        place_map = self._chosen()
        if image not in self.placed():
            raise ValueError(f"{image}: is not in the map")
        self._step(place_map._replace(photos=tuple(p for p in place_map.photos if p.image != image)))

    @property
    def can_undo(self) -> bool:
        """Whether there is a step to undo."""
        return bool(self._history)

    def undo(self) -> None:
        """Undoes the last step, if there is one."""
        if self._history:
            self._save(self._history[-1])
            self._history.pop()

    def add_file(self, name: str, content: bytes) -> str:
        """Writes an image file to the map's folder.

        :returns: its name
        :raises ValueError: it is not an image, or its name is invalid or taken by another file
        """
        path = self.path.parent / name
        if Path(name).name != name or name.startswith(".") or path.suffix.lower() not in SUFFIXES:
            raise ValueError(f"'{name}' is not a valid image name ({', '.join(SUFFIXES)})")
        if path.exists():
            if path.read_bytes() == content:
                return name
            raise ValueError(f"{name}: another file has this name; rename it")
        check_image(name)
        decode_grey(content, name)
        with atomic_file(path, "wb") as file:
            file.write(content)
        return name

    def _chosen(self) -> PlaceMap:
        """The map; raises ValueError if there is no overview yet."""
        if not self.place_map:
            raise ValueError("choose the overview first")
        return self.place_map

    def file(self, image: str) -> Path:
        """Path of an image.

        :raises ValueError: it is neither the overview nor one of images()
        """
        overview = self.place_map.overview.image if self.place_map else None
        if image not in (overview, *self.images()):
            raise ValueError(f"{image}: there is no such photo in {self.path.parent}")
        return self.path.parent / image

    def _step(self, changed: PlaceMap) -> None:
        """Saves a changed map and adds the previous one to the undo history."""
        before = self.place_map
        self._save(changed)
        self._history = [*self._history, before][-HISTORY:]

    def _save(self, place_map: PlaceMap) -> None:
        """Writes the map file, unless another program changed it."""
        if self._read() != self._content:
            raise ValueError(
                f"{self.path}: was changed by another program, so this step is not saved; "
                "reload the page to continue with the changed map"
            )
        write_place_map(self.path, place_map)
        self.place_map, self._content = place_map, place_map_text(place_map).encode()

    def _read(self) -> Optional[bytes]:
        """Content of the map file; None if it does not exist."""
        return self.path.read_bytes() if self.path.exists() else None
