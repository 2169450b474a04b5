# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""World files: six lines beside a picture that say where its pixels lie (ESRI's format)."""

from pathlib import Path
from typing import Optional

from sextant.place_maps.photo_file import photo_size
from sextant.place_maps.place_map import GeoCorners, check_georeference


def corners_beside(picture: Path) -> Optional[GeoCorners]:
    """What map.jgw, map.jpgw or map.wld beside map.jpg says; None: there is none of them.

    :raises OSError, ValueError: as read_world_file()
    """
    suffix = picture.suffix
    names = [f"{suffix[:2]}{suffix[-1]}w", f"{suffix}w"] if suffix else []
    beside = map(picture.with_suffix, [*names, ".wld"])
    world_file = next((path for path in beside if path.is_file()), None)
    return read_world_file(world_file, picture) if world_file else None


def read_world_file(path: Path, picture: Path) -> GeoCorners:
    """The corners of a picture whose world file is in degrees of WGS 84.

    :raises OSError: a file cannot be read
    :raises ValueError: it is no world file, or a picture that is turned, or not in degrees
    """
    try:
        right, *turned, down, west, north = (float(word) for word in path.read_text().split())
        if len(turned) != 2:
            raise ValueError
    except (ValueError, UnicodeDecodeError):
        raise ValueError(f"{path}: is no world file of six numbers") from None
    if any(turned):
        raise ValueError(f"{path}: the picture is turned; name corners of one whose north is up")
    width, height = photo_size(picture)
    north, west = north - down / 2, west - right / 2  # it says the middle of the first pixel
    corners = GeoCorners((north, west), (north + height * down, west + width * right))
    try:
        check_georeference(corners)
    except ValueError as error:
        raise ValueError(f"{path}: {error}; only those in degrees of WGS 84 can be used") from None
    return corners
