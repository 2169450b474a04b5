# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The overview's picture as a map's folder holds it."""

import io
from pathlib import Path
from typing import Dict, NamedTuple, Tuple, Union

from PIL import Image, ImageOps

from sextant.place_maps.overview import map_server_frame
from sextant.place_maps.photo_file import photo_size
from sextant.place_maps.place_map import GeoCorners, MetricFrame, Overview, PlaceMap, image_in

SHOWN = (".png", ".jpg", ".jpeg", ".webp")  # by every browser


class OverviewPicture(NamedTuple):
    """An overview, where it lies, and what has to be written for it."""

    overview: Overview
    georeference: Union[MetricFrame, GeoCorners, None]
    files: Dict[str, bytes]  # by name in the map's folder

    def empty_map(self, folder: Path) -> PlaceMap:
        """A map without photos."""
        return PlaceMap(folder, self.overview, (), self.georeference)


def drawn_picture(
    name: str, image: Image.Image, georeference: Union[MetricFrame, GeoCorners]
) -> OverviewPicture:
    """Of a drawing."""
    return OverviewPicture(Overview(name, *image.size), georeference, {name: _png(image)})


def taken_picture(
    folder: Path, picture: Path, georeference: Union[MetricFrame, GeoCorners, None]
) -> OverviewPicture:
    """Of a file; it is copied into the folder if it lies elsewhere, as PNG if browsers do not show it.

    :raises OSError: it cannot be read
    :raises ValueError: it is no picture
    """
    size = photo_size(picture)
    name, files = _in_folder(folder, picture)
    return OverviewPicture(Overview(name, *size), georeference, files)


def map_server_picture(folder: Path, yaml: Path, frame: str) -> OverviewPicture:
    """Of a map_server YAML; raises as map_server_frame()."""
    picture, place, _ = map_server_frame(yaml, frame)
    return taken_picture(folder, picture, place)


def _in_folder(folder: Path, picture: Path) -> Tuple[str, Dict[str, bytes]]:
    if picture.suffix.lower() not in SHOWN:
        return f"{picture.stem}.png", {f"{picture.stem}.png": _copied(picture)}
    name = image_in(folder, picture)
    return (name, {}) if name else (picture.name, {picture.name: picture.read_bytes()})


def _copied(picture: Path) -> bytes:
    try:
        with Image.open(picture) as image:
            return _png(ImageOps.exif_transpose(image))
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise ValueError(f"{picture}: cannot be made a PNG: {error}") from None


def _png(image: Image.Image) -> bytes:
    file = io.BytesIO()
    image.save(file, "PNG")
    return file.getvalue()
