# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Overview images for the folder of a map."""

import io
from pathlib import Path
from typing import Dict, NamedTuple, Tuple, Union

from PIL import Image, ImageOps

from sextant.images.photo_file import photo_size
from sextant.place_maps.overview import map_server_frame
from sextant.place_maps.place_map import GeoCorners, MetricFrame, Overview, PlaceMap, image_in

WEB_SUFFIXES = (".png", ".jpg", ".jpeg", ".webp")  # of formats that every browser shows


class OverviewImage(NamedTuple):
    """An overview, its position, and the files to write for it."""

    overview: Overview  # file and size
    georeference: Union[MetricFrame, GeoCorners, None]  # None: no scale
    files: Dict[str, bytes]  # files to write: content by name in the map's folder

    def empty_map(self, folder: Path) -> PlaceMap:
        """A map without photos."""
        return PlaceMap(folder, self.overview, (), self.georeference)


def drawn_overview(
    name: str, image: Image.Image, georeference: Union[MetricFrame, GeoCorners]
) -> OverviewImage:
    """Returns the overview image of a drawing, as a PNG file."""
    return OverviewImage(Overview(name, *image.size), georeference, {name: _png(image)})


def overview_from_file(
    folder: Path, path: Path, georeference: Union[MetricFrame, GeoCorners, None]
) -> OverviewImage:
    """Returns an overview image that is copied into the folder, as PNG if browsers cannot show its format.

    :raises OSError: the file cannot be read
    :raises ValueError: it is not an image
    """
    size = photo_size(path)
    name, files = _in_folder(folder, path)
    return OverviewImage(Overview(name, *size), georeference, files)


def overview_from_map_server(folder: Path, yaml: Path, frame: str) -> OverviewImage:
    """Returns the overview image of a map_server YAML file; frame: tf frame of that map.

    :raises: as map_server_frame() and overview_from_file()
    """
    return overview_from_file(folder, *map_server_frame(yaml, frame))


def _in_folder(folder: Path, path: Path) -> Tuple[str, Dict[str, bytes]]:
    """Name of the overview in the folder, and the file to write; no file if the image is in the folder."""
    if path.suffix.lower() not in WEB_SUFFIXES:
        return f"{path.stem}.png", {f"{path.stem}.png": _converted(path)}
    name = image_in(folder, path)
    return (name, {}) if name else (path.name, {path.name: path.read_bytes()})


def _converted(path: Path) -> bytes:
    try:
        with Image.open(path) as image:
            return _png(ImageOps.exif_transpose(image))
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise ValueError(f"{path}: cannot be converted to PNG: {error}") from None


def _png(image: Image.Image) -> bytes:
    file = io.BytesIO()
    image.save(file, "PNG")
    return file.getvalue()
