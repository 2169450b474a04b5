# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""World files: text files beside an image with six numbers that georeference it (ESRI's format)."""

from pathlib import Path
from typing import Optional

from sextant.images.photo_file import photo_size
from sextant.place_maps.place_map import GeoCorners


def corners_beside(image: Path) -> Optional[GeoCorners]:
    """Corners from the world file map.jgw, map.jpgw or map.wld beside map.jpg; None if there is none.

    :raises OSError, ValueError: as read_world_file()
    """
    suffix = image.suffix
    names = [f"{suffix[:2]}{suffix[-1]}w", f"{suffix}w"] if suffix else []
    beside = map(image.with_suffix, [*names, ".wld"])
    world_file = next((path for path in beside if path.is_file()), None)
    return read_world_file(world_file, image) if world_file else None


def read_world_file(path: Path, image: Path) -> GeoCorners:
    """Reads the corners of an image from a world file in degrees of WGS 84.

    :raises OSError: a file cannot be read
    :raises ValueError: not a world file, or the image is rotated, or the coordinates are not in degrees
    """
    try:
        right, *rotation, down, west, north = (float(word) for word in path.read_text().split())
        if len(rotation) != 2:
            raise ValueError
    except (ValueError, UnicodeDecodeError):
        raise ValueError(f"{path}: is not a world file of six numbers") from None
    if any(rotation):
        raise ValueError(f"{path}: the image is rotated; set the corners of a north-up one")
    width, height = photo_size(image)
    north, west = north - down / 2, west - right / 2  # from the centre of the first pixel to its corner
    corners = GeoCorners((north, west), (north + height * down, west + width * right))
    try:
        corners.check()
    except ValueError as error:
        raise ValueError(f"{path}: {error}; world files must be in degrees of WGS 84") from None
    return corners
