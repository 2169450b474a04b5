# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Map file: text with fields separated by ';', compatible with older programs.

First line, then one line per photo; file names are relative to the map file:

    overview.png;width;height[;NAME=VALUE...]
    id;image.jpg;x;y[;yaw=radians]

x and y are pixels of the overview, from its upper left corner. Optional fields of the first line, which older
programs ignore; all of one group:

    frame=NAME;resolution=METRES_PER_PIXEL;origin=x,y,yaw
    north_west=lat,lon;south_east=lat,lon
"""

from pathlib import Path
from typing import Dict, Iterator, List, Sequence, Tuple, Union

import numpy as np

from sextant.base.atomic_file import atomic_file
from sextant.place_maps.place_map import (
    GeoCorners,
    MetricFrame,
    Overview,
    Photo,
    PlaceMap,
    check_overview,
    check_photo,
)

METRIC = ("frame", "resolution", "origin")
CORNERS = ("north_west", "south_east")


def read_place_map(path: Union[str, Path]) -> PlaceMap:
    """Reads a map file.

    :raises OSError: it cannot be read
    :raises ValueError: "file:line: reason"
    """
    path = Path(path)
    lines = _lines(path)
    number, fields = next(lines, (1, []))
    try:
        place_map = _header(path.parent, fields)
    except ValueError as error:
        raise ValueError(f"{path}:{number}: {error}") from None
    return place_map._replace(photos=tuple(_photos(path, lines, place_map.overview)))


def write_place_map(path: Union[str, Path], place_map: PlaceMap) -> None:
    """Writes a map to a file in its folder, atomically.

    :raises OSError: it cannot be written
    :raises ValueError: the map is invalid, see PlaceMap.check(), or the path is in another folder
    """
    path = Path(path)
    place_map.check()
    if path.resolve().parent != place_map.folder.resolve():
        raise ValueError(f"{path}: the map must be in {place_map.folder}, the folder of its photos")
    with atomic_file(path) as file:
        file.write(place_map_text(place_map))


def place_map_text(place_map: PlaceMap) -> str:
    """Text of the map file."""
    lines = [_header_line(place_map), *(_photo_line(photo) for photo in place_map.photos)]
    return "".join(f"{line}\n" for line in lines)


def _lines(path: Path) -> Iterator[Tuple[int, List[str]]]:
    """Yields the line number and the fields of every line that is not blank."""
    try:
        with open(path, encoding="utf-8-sig") as file:
            for number, line in enumerate(file, 1):
                if line.strip():
                    yield number, [field.strip() for field in line.split(";")]
    except UnicodeDecodeError:
        raise ValueError(f"{path}: is not UTF-8 text") from None


def _header(folder: Path, fields: Sequence[str]) -> PlaceMap:
    if len(fields) < 3:
        raise ValueError("the first line must be overview.png;width;height")
    overview = Overview(fields[0], _whole("width", fields[1]), _whole("height", fields[2]))
    georeference = _georeference(_named(fields[3:], (*METRIC, *CORNERS)))
    check_overview(overview)
    if georeference:
        georeference.check()
    return PlaceMap(folder, overview, (), georeference)


def _georeference(named: Dict[str, str]) -> Union[MetricFrame, GeoCorners, None]:
    if not named:
        return None
    if set(named) == set(METRIC):
        x, y, yaw = _numbers("origin", named["origin"], "x,y,yaw")
        return MetricFrame(named["frame"], _number("resolution", named["resolution"]), (x, y, yaw))
    if set(named) == set(CORNERS):
        (north, west), (south, east) = (_numbers(name, named[name], "latitude,longitude") for name in CORNERS)
        return GeoCorners((north, west), (south, east))
    allowed = " or ".join(f"({', '.join(names)})" for names in (METRIC, CORNERS))
    raise ValueError(f"the fields after the size must be all of {allowed}; found {', '.join(named)}")


def _photos(path: Path, lines: Iterator[Tuple[int, List[str]]], overview: Overview) -> Iterator[Photo]:
    line_of: Dict[Union[int, str], int] = {}
    for number, fields in lines:
        try:
            photo = _photo(fields)
            check_photo(overview, photo)
            if photo.id in line_of:
                raise ValueError(f"duplicate id {photo.id}, see line {line_of[photo.id]}")
            if photo.image in line_of:
                raise ValueError(f"duplicate image {photo.image}, see line {line_of[photo.image]}")
        except ValueError as error:
            raise ValueError(f"{path}:{number}: {error}") from None
        line_of[photo.id] = line_of[photo.image] = number
        yield photo


def _photo(fields: Sequence[str]) -> Photo:
    if len(fields) < 4:
        raise ValueError(f"{len(fields)} fields, expected id;image;x;y")
    x, y = _number("x", fields[2]), _number("y", fields[3])
    named = _named(fields[4:], ("yaw",))
    yaw = _number("yaw", named["yaw"]) if named else None
    return Photo(_whole("id", fields[0]), fields[1], x, y, yaw)


def _named(fields: Sequence[str], allowed: Sequence[str]) -> Dict[str, str]:
    """Values of NAME=VALUE fields by name; the last field may be empty: some programs end lines with ';'."""
    named: Dict[str, str] = {}
    for field in fields[:-1] if fields and not fields[-1] else fields:
        name, equals, value = field.partition("=")
        if not equals or name not in allowed:
            raise ValueError(
                f"'{field}' is not a field, allowed are {', '.join(f'{each}=' for each in allowed)}"
            )
        if name in named:
            raise ValueError(f"duplicate field {name}")
        named[name] = value
    return named


def _whole(name: str, text: str) -> int:
    if not text.isascii() or not text.isdigit():
        raise ValueError(f"{name} is '{text}', not a whole number")
    return int(text)


def _number(name: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise ValueError(f"{name} is '{text}', not a number") from None


def _numbers(name: str, text: str, form: str) -> List[float]:
    texts = text.split(",")
    if len(texts) != len(form.split(",")):
        raise ValueError(f"{name} is '{text}', expected {form}")
    return [_number(name, each) for each in texts]


def _header_line(place_map: PlaceMap) -> str:
    fields = [place_map.overview.image, str(place_map.overview.width), str(place_map.overview.height)]
    if place_map.georeference is not None:
        fields += [f"{name}={_text(value)}" for name, value in place_map.georeference._asdict().items()]
    return ";".join(fields)


def _photo_line(photo: Photo) -> str:
    fields = [str(photo.id), photo.image, _text(photo.x), _text(photo.y)]
    return ";".join(fields if photo.yaw is None else [*fields, f"yaw={_text(photo.yaw)}"])


def _text(value: Union[str, float, Sequence[float]]) -> str:
    """A value as text: numbers without exponent, sequences separated by commas."""
    if isinstance(value, str):
        return value
    if isinstance(value, (int, float)):
        return np.format_float_positional(value, trim="-")
    return ",".join(_text(each) for each in value)
