# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Finds and reads photo files: grey or colour, optionally reduced, and their EXIF data's GPS position."""

import math
from io import BytesIO
from pathlib import Path
from typing import Any, List, Mapping, NamedTuple, Optional, Tuple, Union

import numpy as np
from PIL import ExifTags, Image, ImageOps, UnidentifiedImageError

SUFFIXES = (".jpg", ".jpeg", ".png", ".tif", ".tiff", ".webp", ".bmp", ".pgm", ".ppm")
# that Pillow decodes without running another program; MPO: several JPEGs in one file
FORMATS = ("JPEG", "MPO", "PNG", "TIFF", "WEBP", "BMP", "PPM", "GIF", "JPEG2000")

# tags of the GPS fields, EXIF 2.32, table 15
_LATITUDE_REF, _LATITUDE, _LONGITUDE_REF, _LONGITUDE, _DIRECTION = 1, 2, 3, 4, 17
_GPS = next(tag for tag, name in ExifTags.TAGS.items() if name == "GPSInfo")


class GeoPosition(NamedTuple):
    """Position where a photo was taken, WGS 84."""

    latitude: float  # degrees
    longitude: float  # degrees
    yaw: Optional[float] = None  # radians, counterclockwise from east (REP-103); None: unknown


def find_photos(folder: Path) -> List[Path]:
    """Image files in a folder and its subfolders, sorted by name."""
    return sorted(path for path in folder.rglob("*") if path.suffix.lower() in SUFFIXES and path.is_file())


def read_grey(path: Union[str, Path], max_side: int = 0) -> np.ndarray:
    """Reads a photo as uint8 (height, width), rotated by its EXIF orientation; transparent pixels are white.

    :param max_side: pixels; a larger JPEG is decoded at 1/2, 1/4 or 1/8 of its size, but with no side
        smaller than this; 0: full size
    :raises OSError: it cannot be read
    :raises ValueError: it is not an image, or is damaged
    """
    return decode_grey(Path(path).read_bytes(), path, max_side)


def decode_grey(content: bytes, path: Union[str, Path], max_side: int = 0) -> np.ndarray:
    """As read_grey(), but from the content of the file; path is only for error messages."""
    return np.asarray(_opaque(_decoded(content, path, "L", max_side)).convert("L"))


def decode_colour(content: bytes, path: Union[str, Path], max_side: int = 0) -> np.ndarray:
    """As decode_grey(), but returns uint8 (height, width, 3) BGR."""
    image = _opaque(_decoded(content, path, "RGB", max_side))
    return np.ascontiguousarray(np.asarray(image.convert("RGB"))[:, :, ::-1])


def read_rgb(path: Union[str, Path], max_side: int = 0) -> np.ndarray:
    """As read_grey(), but returns uint8 (height, width, 3) RGB."""
    return np.asarray(_opaque(_decoded(Path(path).read_bytes(), path, "RGB", max_side)).convert("RGB"))


def _opaque(image: Image.Image) -> Image.Image:
    """The image; if it can be transparent, on white."""
    if "A" in image.getbands() or "transparency" in image.info:
        image = image.convert("RGBA")
        image = Image.alpha_composite(Image.new("RGBA", image.size, "white"), image)
    return image


def _decoded(content: bytes, path: Union[str, Path], mode: str, max_side: int) -> Image.Image:
    """Decodes an image and rotates it; mode (L or RGB) is a hint that lets Pillow decode a JPEG faster."""
    with _opened(path, BytesIO(content)) as image:
        if max_side:
            image.draft(mode, (max_side, max_side))
        try:
            image.load()
            upright = ImageOps.exif_transpose(image)
        except Exception as error:  # Pillow raises many types for damaged EXIF data
            raise ValueError(f"{path}: the image is damaged: {error}") from None
    return _of_bytes(upright, path)


def _of_bytes(image: Image.Image, path: Union[str, Path]) -> Image.Image:
    """Converts 16-bit grey to 8 bits; Pillow would clip values above 255."""
    if image.mode == "F":
        raise ValueError(f"{path}: its pixels are floating-point numbers; save it with 8 or 16 bits")
    if not image.mode.startswith("I"):
        return image
    pixels = np.asarray(image)
    if pixels.min() < 0 or pixels.max() > 65535:
        raise ValueError(f"{path}: its pixels have more than 16 bits; save it with 8 or 16")
    return Image.fromarray((pixels >> 8).astype(np.uint8))


def photo_size(path: Union[str, Path]) -> Tuple[int, int]:
    """Width and height in pixels after rotation by the EXIF orientation.

    :raises: as read_grey()
    """
    with _opened(path) as image:
        is_transposed = image.getexif().get(0x0112, 1) >= 5
        return (image.height, image.width) if is_transposed else (image.width, image.height)


def geo_position(path: Union[str, Path]) -> Optional[GeoPosition]:
    """GPS position in the EXIF data of a photo; None if there is none.

    :raises OSError: the photo cannot be read
    :raises ValueError: it is not an image, or its coordinates are invalid
    """
    with _opened(path) as image:
        exif = image.getexif()
        gps = exif.get(_GPS)
        if not isinstance(gps, dict):  # Pillow 8.1 of Debian 11 has it here, and its get_ifd() fails
            gps = exif.get_ifd(_GPS)
    if _LATITUDE not in gps or _LONGITUDE not in gps:
        return None
    try:
        latitude = _degrees(gps[_LATITUDE], gps.get(_LATITUDE_REF), "NS", 90)
        longitude = _degrees(gps[_LONGITUDE], gps.get(_LONGITUDE_REF), "EW", 180)
        return GeoPosition(latitude, longitude, _yaw(gps))
    except (TypeError, ValueError, ZeroDivisionError):
        raise ValueError(f"{path}: the coordinates in its EXIF are invalid") from None


def _opened(path: Union[str, Path], content: Optional[BytesIO] = None) -> Image.Image:
    """Opens a photo in one of FORMATS.

    :raises: as read_grey()
    """
    try:
        image = Image.open(content or path)
    except UnidentifiedImageError:
        raise ValueError(f"{path}: is not an image") from None
    # Pillow of Debian 11 raises RuntimeError for a damaged WebP
    except (OSError, RuntimeError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        if isinstance(error, OSError) and error.errno is not None:
            raise
        raise ValueError(f"{path}: is not an image: {error}") from None
    if image.format not in FORMATS:
        image.close()
        raise ValueError(f"{path}: has format {image.format}; allowed are {', '.join(FORMATS)}")
    return image


def _degrees(parts: Any, reference: Any, signs: str, limit: float) -> float:
    """Signed degrees from degrees, minutes and seconds and the hemisphere."""
    degrees, minutes, seconds = (float(part) for part in parts)
    value = degrees + minutes / 60 + seconds / 3600
    if not abs(value) <= limit:
        raise ValueError
    return -value if str(reference).strip("\0 ").upper() == signs[1] else value


def _yaw(gps: Mapping[int, Any]) -> Optional[float]:
    """Yaw from the EXIF direction, which is in degrees clockwise from north."""
    if _DIRECTION not in gps:
        return None
    direction = math.radians(float(gps[_DIRECTION]))
    return math.pi - (math.pi / 2 + direction) % (2 * math.pi) if math.isfinite(direction) else None
