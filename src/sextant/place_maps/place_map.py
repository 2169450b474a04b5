# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Place map: photos with their positions in an overview image.

Positions are pixels from the upper left corner of the overview, x to the right and y down. A photo's yaw is
counterclockwise from the x axis of the overview.
"""

import math
import os
from pathlib import Path, PurePosixPath
from typing import Dict, List, NamedTuple, Optional, Tuple, Union

import numpy as np

ID_LIMIT = 2**31  # messages have 32-bit ids
METRES_PER_DEGREE = 111_320.0  # of latitude, correct within half a percent everywhere


class Photo(NamedTuple):
    """A photo and where it was taken. Photos with the same x and y show the same place."""

    id: int  # unique, 0 is valid
    image: str  # file, relative to the map's folder, with /
    x: float  # pixels of the overview
    y: float  # pixels of the overview
    yaw: Optional[float] = None  # direction of the camera, radians; None: unknown


class Overview(NamedTuple):
    """The overview image; positions are in pixels of this size, even if the file has another size."""

    image: str  # file, relative to the map's folder, with /
    width: int  # pixels
    height: int  # pixels


class MetricFrame(NamedTuple):
    """Pose and scale of the overview in a tf frame, as in map_server's YAML files."""

    frame: str  # tf frame
    resolution: float  # metres per pixel
    origin: Tuple[float, float, float]  # x, y, yaw of the overview's lower left corner; metres, radians

    def position(self, overview: Overview, x: float, y: float) -> Tuple[float, float]:
        """Position of a pixel of the overview in the frame, metres."""
        right, up = x * self.resolution, (overview.height - y) * self.resolution
        cosine, sine = math.cos(self.origin[2]), math.sin(self.origin[2])
        return self.origin[0] + cosine * right - sine * up, self.origin[1] + sine * right + cosine * up

    def pixel(self, overview: Overview, x: float, y: float) -> Tuple[float, float]:
        """The inverse of position()."""
        east, north = x - self.origin[0], y - self.origin[1]
        cosine, sine = math.cos(self.origin[2]), math.sin(self.origin[2])
        right, up = cosine * east + sine * north, cosine * north - sine * east
        return right / self.resolution, overview.height - up / self.resolution

    def yaw(self, yaw: float) -> float:
        """A photo's yaw relative to the frame, radians in (-pi, pi]."""
        return _wrapped(yaw + self.origin[2])

    def photo_yaw(self, yaw: float) -> float:
        """The inverse of yaw()."""
        return _wrapped(yaw - self.origin[2])

    def check(self) -> None:
        """Checks the values.

        :raises ValueError: an invalid frame name, resolution or origin
        """
        if not self.frame or self.frame.startswith("/") or any(mark in self.frame for mark in "; \t\r\n"):
            raise ValueError(f"frame is '{self.frame}', not a valid tf frame name")
        if not (math.isfinite(self.resolution) and self.resolution > 0):
            raise ValueError(f"resolution is {self.resolution:g}, it must be above 0 metres per pixel")
        if not np.all(np.isfinite(self.origin)):
            raise ValueError(f"origin is {self.origin}, not finite")


def _wrapped(angle: float) -> float:
    """The angle wrapped to (-pi, pi], radians."""
    return math.pi - (math.pi - angle) % (2 * math.pi)


class GeoCorners(NamedTuple):
    """WGS 84 coordinates of the corners of a north-up overview.

    Degrees are proportional to pixels: the error is some centimetres per kilometre.
    """

    north_west: Tuple[float, float]  # latitude, longitude in degrees
    south_east: Tuple[float, float]  # latitude, longitude in degrees

    def coordinates(self, overview: Overview, x: float, y: float) -> Tuple[float, float]:
        """Latitude and longitude of a pixel of the overview, degrees."""
        north, west = self.north_west
        south, east = self.south_east
        return north + (south - north) * y / overview.height, west + (east - west) * x / overview.width

    def pixel(self, overview: Overview, latitude: float, longitude: float) -> Tuple[float, float]:
        """The inverse of coordinates()."""
        north, west = self.north_west
        south, east = self.south_east
        return (
            (longitude - west) / (east - west) * overview.width,
            (latitude - north) / (south - north) * overview.height,
        )

    def extent(self) -> Tuple[float, float]:
        """Extent in metres from west to east and from south to north."""
        (north, west), (south, east) = self
        up = (north - south) * METRES_PER_DEGREE
        return (east - west) * METRES_PER_DEGREE * math.cos(math.radians((north + south) / 2)), up

    def check(self) -> None:
        """Checks the values.

        :raises ValueError: invalid coordinates, or corners in the wrong order
        """
        for name, (latitude, longitude) in self._asdict().items():
            if not (-90 <= latitude <= 90 and -180 <= longitude <= 180):
                raise ValueError(
                    f"{name} is {latitude:g},{longitude:g}, not a latitude and longitude in degrees"
                )
        if self.north_west[0] <= self.south_east[0]:
            raise ValueError("north_west must be north of south_east")
        if self.north_west[1] >= self.south_east[1]:
            raise ValueError("north_west must be west of south_east")


class PlaceMap(NamedTuple):
    """Content of a map file; not validated, see check()."""

    folder: Path  # file names are relative to it
    overview: Overview  # file and size
    photos: Tuple[Photo, ...] = ()  # in the order of the file
    georeference: Union[MetricFrame, GeoCorners, None] = None  # None: the map has no scale

    def places(self) -> List[List[Photo]]:
        """The photos of each place, in the order of the map."""
        of_place: Dict[Tuple[float, float], List[Photo]] = {}
        for photo in self.photos:
            of_place.setdefault((photo.x, photo.y), []).append(photo)
        return list(of_place.values())

    def positions(self) -> np.ndarray:
        """Positions (places, 2) in the order of places(), pixels of the overview."""
        return np.array([(photos[0].x, photos[0].y) for photos in self.places()], float).reshape(-1, 2)

    def next_id(self) -> int:
        """Id for a new photo."""
        return 1 + max((photo.id for photo in self.photos), default=-1)

    def path(self, photo: Photo) -> Path:
        """Path of a photo's file."""
        return self.folder / photo.image

    def check(self) -> None:
        """Checks the map.

        :raises ValueError: names what is invalid, and in which photo
        """
        check_overview(self.overview)
        if self.georeference:
            self.georeference.check()
        ids: Dict[int, Photo] = {}
        images: Dict[str, Photo] = {}
        for photo in self.photos:
            check_photo(self.overview, photo)
            if photo.id in ids:
                raise ValueError(f"duplicate photo id {photo.id}: {ids[photo.id].image} and {photo.image}")
            if photo.image in images:
                first = images[photo.image].id
                raise ValueError(f"duplicate image {photo.image}: photos {first} and {photo.id}")
            ids[photo.id] = images[photo.image] = photo


def image_in(folder: Path, path: Path) -> Optional[str]:
    """File name relative to a map's folder; None if the file is not in the folder or a subfolder."""
    try:  # without resolving links
        return Path(os.path.abspath(path)).relative_to(os.path.abspath(folder)).as_posix()
    except ValueError:
        return None


def check_overview(overview: Overview) -> None:
    """Checks an overview.

    :raises ValueError: an invalid file name or size
    """
    check_image(overview.image)
    for name, size in (("width", overview.width), ("height", overview.height)):
        if size < 1:
            raise ValueError(f"{name} is {size}, it must be at least 1")


def check_photo(overview: Overview, photo: Photo) -> None:
    """Checks a photo.

    :raises ValueError: an invalid id, file name, position or yaw
    """
    if not 0 <= photo.id < ID_LIMIT:
        raise ValueError(f"id is {photo.id}, allowed are 0 to {ID_LIMIT - 1}")
    check_image(photo.image)
    for name, value, size in (("x", photo.x, overview.width), ("y", photo.y, overview.height)):
        if not 0 <= value <= size:  # nan, too
            raise ValueError(f"photo {photo.id}: {name} is {value:g}, outside the overview (0 to {size})")
    if photo.yaw is not None and not math.isfinite(photo.yaw):
        raise ValueError(f"photo {photo.id}: yaw is {photo.yaw}, not finite")


def check_image(image: str) -> None:
    """Checks an image's file name.

    :raises ValueError: it leads out of the map's folder, or has characters that the map file cannot contain
    """
    path = PurePosixPath(image)
    if not path.name:
        raise ValueError("an image has no file name")
    if path.is_absolute() or ".." in path.parts:
        raise ValueError(f"image '{image}' is outside of the map's folder; copy it there")
    if image != image.strip() or any(mark in image for mark in ";\n\r\0"):
        raise ValueError(
            f"image {image!r}: ';', line ends and blanks at the ends are not allowed; rename the file"
        )
