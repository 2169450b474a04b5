# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The experience map: photos, and where in an overview picture each was taken.

Pixels of the overview count from its upper left corner, x to the right and y down; a photo's yaw counts
counterclockwise from the overview's right, as on any map that is laid out so.
"""

import math
import os
from pathlib import Path, PurePosixPath
from typing import Dict, List, NamedTuple, Optional, Tuple, Union

import numpy as np

ID_LIMIT = 2**31  # the message says ids in 32 bits


class Photo(NamedTuple):
    """One experience: a picture and where it was taken. Photos with the same x and y show one place."""

    id: int  # 0 is one like any other
    image: str  # file, relative to the map's folder, with /
    x: float  # pixels of the overview
    y: float
    yaw: Optional[float] = None  # radians; None: nobody knows where the camera looked


class Overview(NamedTuple):
    """The picture of the whole that the positions are in; the size is the map's, whatever the file's is."""

    image: str  # file, relative to the map's folder, with /
    width: int  # pixels
    height: int


class MetricFrame(NamedTuple):
    """Where the overview lies in a tf frame; the words are those of map_server's YAML."""

    frame: str
    resolution: float  # metres a pixel
    origin: Tuple[float, float, float]  # x, y, yaw of the overview's lower left corner

    def position(self, overview: Overview, x: float, y: float) -> Tuple[float, float]:
        """Metres in the frame of a pixel of the overview."""
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
        """A photo's yaw in the frame, in (-pi, pi]."""
        return _wrapped(yaw + self.origin[2])

    def photo_yaw(self, yaw: float) -> float:
        """The inverse of yaw()."""
        return _wrapped(yaw - self.origin[2])


def _wrapped(angle: float) -> float:
    """In (-pi, pi]."""
    return math.pi - (math.pi - angle) % (2 * math.pi)


class GeoCorners(NamedTuple):
    """The WGS 84 coordinates of a north-up overview's corners, (latitude, longitude) in degrees.

    Between them degrees are proportional to pixels: over a kilometre this is good to some centimetres.
    """

    north_west: Tuple[float, float]
    south_east: Tuple[float, float]

    def coordinates(self, overview: Overview, x: float, y: float) -> Tuple[float, float]:
        """Latitude and longitude of a pixel of the overview."""
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


class PlaceMap(NamedTuple):
    """What a map file says; check() tells whether it can be true."""

    folder: Path  # that the names of the pictures are relative to
    overview: Overview
    photos: Tuple[Photo, ...] = ()
    georeference: Union[MetricFrame, GeoCorners, None] = None

    def places(self) -> List[List[Photo]]:
        """The photos place by place, in the order of the map."""
        found: Dict[Tuple[float, float], List[Photo]] = {}
        for photo in self.photos:
            found.setdefault((photo.x, photo.y), []).append(photo)
        return list(found.values())

    def next_id(self) -> int:
        """Of a photo that is added."""
        return 1 + max((photo.id for photo in self.photos), default=-1)

    def path(self, photo: Photo) -> Path:
        """Of a photo's file."""
        return self.folder / photo.image

    def check(self) -> None:
        """:raises ValueError: what cannot be, and of which photo"""
        check_overview(self.overview)
        check_georeference(self.georeference)
        ids: Dict[int, Photo] = {}
        images: Dict[str, Photo] = {}
        for photo in self.photos:
            check_photo(self.overview, photo)
            if photo.id in ids:
                raise ValueError(f"photo {photo.id} is there twice: {ids[photo.id].image} and {photo.image}")
            if photo.image in images:
                first = images[photo.image].id
                raise ValueError(f"{photo.image} is there twice: as photo {first} and {photo.id}")
            ids[photo.id] = images[photo.image] = photo


def image_in(folder: Path, path: Path) -> Optional[str]:
    """What a file is called in a map of this folder; None: it lies neither there nor below."""
    try:  # a link is where it is, not where it leads
        return Path(os.path.abspath(path)).relative_to(os.path.abspath(folder)).as_posix()
    except ValueError:
        return None


def check_overview(overview: Overview) -> None:
    """:raises ValueError: no file's name, or no size"""
    check_image(overview.image)
    for name, size in (("width", overview.width), ("height", overview.height)):
        if size < 1:
            raise ValueError(f"{name} is {size}, allowed is a whole number from 1 on")


def check_photo(overview: Overview, photo: Photo) -> None:
    """:raises ValueError: an id, a file's name or a position that cannot be"""
    if not 0 <= photo.id < ID_LIMIT:
        raise ValueError(f"id is {photo.id}, allowed are 0 to {ID_LIMIT - 1}")
    check_image(photo.image)
    for name, value, size in (("x", photo.x, overview.width), ("y", photo.y, overview.height)):
        if not 0 <= value <= size:  # nan, too
            raise ValueError(f"photo {photo.id}: {name} is {value:g}, outside the overview (0 to {size})")
    if photo.yaw is not None and not math.isfinite(photo.yaw):
        raise ValueError(f"photo {photo.id}: yaw is {photo.yaw}, not finite")


def check_image(image: str) -> None:
    """:raises ValueError: a name that leads out of the map's folder, or that the file's format cannot hold"""
    path = PurePosixPath(image)
    if not path.name:
        raise ValueError("an image has no name")
    if path.is_absolute() or ".." in path.parts:
        raise ValueError(f"image '{image}' lies outside the map's folder; copy it there")
    if image != image.strip() or any(mark in image for mark in ";\n\r\0"):
        raise ValueError(
            f"image {image!r}: blanks around a name, ';' and line ends are not possible; rename it"
        )


def check_georeference(georeference: Union[MetricFrame, GeoCorners, None]) -> None:
    """:raises ValueError: a frame without extent, or coordinates that are none"""
    if isinstance(georeference, MetricFrame):
        _check_frame(georeference)
    elif isinstance(georeference, GeoCorners):
        _check_corners(georeference)


def _check_frame(frame: MetricFrame) -> None:
    if not frame.frame or frame.frame.startswith("/") or any(mark in frame.frame for mark in "; \t\r\n"):
        raise ValueError(f"frame is '{frame.frame}', no name of a tf frame")
    if not (math.isfinite(frame.resolution) and frame.resolution > 0):
        raise ValueError(f"resolution is {frame.resolution:g}, allowed are metres a pixel above 0")
    if not np.all(np.isfinite(frame.origin)):
        raise ValueError(f"origin is {frame.origin}, not finite")


def _check_corners(corners: GeoCorners) -> None:
    for name, (latitude, longitude) in corners._asdict().items():
        if not (-90 <= latitude <= 90 and -180 <= longitude <= 180):
            raise ValueError(f"{name} is {latitude:g},{longitude:g}, no latitude and longitude in degrees")
    if corners.north_west[0] <= corners.south_east[0]:
        raise ValueError("north_west has to lie north of south_east")
    if corners.north_west[1] >= corners.south_east[1]:
        raise ValueError("north_west has to lie west of south_east")
