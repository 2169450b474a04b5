# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the formats share: what they are asked, what they answer, how they refuse."""

import math
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Callable, Iterator, List, Optional

import numpy as np

import sextant


class MapFileError(RuntimeError):
    """A file that is no marker map of its format, or a map that a format cannot hold; says what to do."""


@dataclass(frozen=True)
class MapFormatParams:
    """What a format leaves open; None: not said."""

    frame: Optional[str] = None  # tf frame of the map, default "map"
    family: Optional[str] = None  # of every marker
    size: Optional[float] = None  # of every marker: edge length in metres, (0, 100]
    bundle: Optional[str] = None  # the one bundle (apriltag_ros) or body (tagslam) to read

    def empty_map(self) -> sextant.MarkerMap:
        return sextant.MarkerMap(self.frame or "map")

    def known_family(self, default: str = "") -> str:
        """Canonical name of the family that was asked for.

        :raises MapFileError: no family of Sextant
        """
        try:
            return sextant.canonical_family(default if self.family is None else self.family)
        except ValueError as error:
            raise MapFileError(str(error)) from None


@dataclass(frozen=True)
class ReadMap:
    """A map, and what its file said that the map does not hold, a sentence each."""

    marker_map: sextant.MarkerMap
    warnings: List[str] = field(default_factory=list)


@dataclass(frozen=True)
class WrittenMap:
    """Text of a file, and what of the map it does not hold, a sentence each."""

    text: str
    warnings: List[str] = field(default_factory=list)


def read_text(path: str) -> str:
    """:raises MapFileError: there is no such file, or it is no text (UTF-8)"""
    try:
        with open(path, encoding="utf-8-sig") as file:
            return file.read()
    except OSError as error:
        raise MapFileError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise MapFileError(f"{path}: is no UTF-8 text (byte {error.start})") from None


@contextmanager
def told_as(mistake: Callable[[str], MapFileError]) -> Iterator[None]:
    """What is refused inside, e.g. by MarkerMap.add (an id that the family lacks, an id that is there twice,
    a size out of range), is raised as mistake(reason), which knows the place in the file."""
    try:
        yield
    except ValueError as error:
        raise mistake(str(error)) from None


def finite(word: str) -> float:
    """:raises ValueError: no number, or one that is not finite"""
    try:
        value = float(word) if "_" not in word else math.nan
    except ValueError:
        raise ValueError(f"'{word}' is not a number") from None
    if not math.isfinite(value):
        raise ValueError(f"'{word}' is not a finite number")
    return value


def decimal(value: float) -> str:
    """Shortest decimal that reads back as the same number, always with a point and never with an exponent:
    YAML 1.1 takes 1e-05 for a word, and apriltag_ros takes a size of 1 for no size."""
    return np.format_float_positional(value + 0.0, trim="0")
