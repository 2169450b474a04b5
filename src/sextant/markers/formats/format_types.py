# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters, results and errors that the marker map formats share."""

import math
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Iterator, List, Optional, Tuple

import numpy as np

import sextant


class MapFileError(RuntimeError):
    """A file is malformed, or a format cannot represent a map; the text explains what to do."""


@dataclass(frozen=True)
class MapFormatParams:
    """Information that a format may lack; None: not set."""

    frame: Optional[str] = None  # tf frame of the map; default "map"
    family: Optional[str] = None  # of every marker
    size: Optional[float] = None  # of every marker: edge length in metres, (0, 100]
    bundle: Optional[str] = None  # the bundle (apriltag_ros) or body (tagslam) to read

    def empty_map(self) -> sextant.MarkerMap:
        """Returns an empty map in the frame."""
        return sextant.MarkerMap(self.frame or "map")

    def known_family(self, default: str = "") -> str:
        """Returns the canonical name of the family.

        :param default: family if none is set
        :raises MapFileError: unknown family
        """
        try:
            return sextant.canonical_family(default if self.family is None else self.family)
        except ValueError as error:
            raise MapFileError(str(error)) from None


@dataclass(frozen=True)
class ReadMap:
    """A map that was read."""

    marker_map: sextant.MarkerMap  # its content
    warnings: List[str] = field(default_factory=list)  # content of the file that the map cannot represent


WrittenMap = Tuple[str, List[str]]  # text of a file; warnings of content that it cannot represent


def read_text(path: str) -> str:
    """Reads a text file.

    :raises MapFileError: the file cannot be read, or is not UTF-8
    """
    try:
        with open(path, encoding="utf-8-sig") as file:
            return file.read()
    except OSError as error:
        raise MapFileError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise MapFileError(f"{path}: is no UTF-8 text (byte {error.start})") from None


def fields_of(line: str) -> List[str]:
    """Returns the fields of a line of text, without its comment."""
    return line.partition("#")[0].split()


@contextmanager
def errors_located_at(place: str) -> Iterator[None]:
    """Raises a ValueError of the block, e.g. of MarkerMap.add (unknown or duplicate id, invalid size), as
    MapFileError with the location.

    :param place: "file:line"
    """
    try:
        yield
    except ValueError as error:
        raise MapFileError(f"{place}: {error}") from None


def finite(word: str) -> float:
    """Parses a finite number.

    :raises ValueError: not a number, or not finite
    """
    try:
        value = float(word) if "_" not in word else math.nan
    except ValueError:
        raise ValueError(f"'{word}' is not a number") from None
    if not math.isfinite(value):
        raise ValueError(f"'{word}' is not a finite number")
    return value


def decimal(value: float) -> str:
    """Formats a number by the shortest decimal that reads back the same, with a point and no exponent.

    YAML 1.1 reads 1e-05 as a string, and apriltag_ros does not accept a size of 1.
    """
    return np.format_float_positional(value + 0.0, trim="0")
