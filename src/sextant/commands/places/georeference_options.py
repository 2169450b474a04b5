# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Options for the geographic corners of an overview."""

import argparse
from typing import Optional, Tuple

from sextant.place_maps.place_map import GeoCorners

NAMES = ("north_west", "south_east")


def add_corner_options(parser: argparse.ArgumentParser) -> None:
    """Adds --north-west and --south-east."""
    group = parser.add_argument_group("geographic position of a north-up overview")
    for name in NAMES:
        option = f"--{name.replace('_', '-')}"
        help_text = f"its {option[2:]} corner, degrees; with = before a minus: {option}=-33.4,-70.6"
        group.add_argument(option, metavar="LAT,LON", help=help_text)


def corners_of(options: argparse.Namespace) -> Optional[GeoCorners]:
    """Corners by the options; None if they are not set.

    :raises ValueError: only one of them is set, or the coordinates are invalid
    """
    given = [getattr(options, name) for name in NAMES]
    if not any(given):
        return None
    if not all(given):
        raise ValueError("an overview has two corners: --north-west and --south-east")
    corners = GeoCorners(*(_coordinates(name, text) for name, text in zip(NAMES, given)))
    corners.check()
    return corners


def _coordinates(name: str, text: str) -> Tuple[float, float]:
    try:
        latitude, longitude = (float(part) for part in text.split(","))
    except ValueError:
        raise ValueError(f"--{name.replace('_', '-')} is '{text}', expected LATITUDE,LONGITUDE") from None
    return latitude, longitude
