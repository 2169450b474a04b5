# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Findings about a new map and what to do about them, as sentences for the terminal and for a report."""

from dataclasses import dataclass
from typing import Any, Sequence, Tuple

NAMED = 8  # maximum number of names in a sentence


@dataclass(frozen=True)
class Finding:
    """A problem of one or more parts of a map."""

    keys: Tuple[Any, ...]  # of the markers or landmarks concerned
    word: str  # the problem in a few words, for a table
    fact: str  # the problem in a sentence
    advice: str  # what to do

    def __str__(self) -> str:
        return f"{self.fact}: {self.advice}"


def listed_names(names: Sequence[str]) -> str:
    """Lists names, e.g. 3, 4 and 7."""
    listed = list(names)
    if len(listed) > NAMED:
        listed = [*listed[: NAMED - 1], f"{len(listed) - NAMED + 1} more"]
    return " and ".join(filter(None, [", ".join(listed[:-1]), *listed[-1:]]))


def count_text(number: int, noun: str) -> str:
    """Formats a count, e.g. 1 image, 2 images."""
    return f"{number} {plural(noun, number)}"


def plural(noun: str, number: int) -> str:
    """The noun, with an s if there is more than one, or none."""
    return noun if number == 1 else f"{noun}s"


def verdict_text(what: str, named: int, noun: str) -> str:
    """Summarizes a map in one line. :param what: what was mapped; named: number of those in findings"""
    return f"{what}; {f'check {count_text(named, noun)} named below' if named else 'no problem found'}"
