# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Finds of each message the one of another topic whose stamp is nearest."""

from collections import deque
from typing import Any, Deque, List, NamedTuple

KEPT = 30  # messages of each topic


class Pair(NamedTuple):
    """Two messages with headers."""

    first: Any
    second: Any


class StampPairs:
    """The first may come later than the second, or before it. Messages of either topic come in order."""

    def __init__(self, slop: float):
        """:param slop: seconds that two stamps may differ"""
        self._slop = round(1e9 * slop)  # nanoseconds
        self._first: Deque = deque()
        self._second: Deque = deque(maxlen=KEPT)
        self.alone = 0  # first ones without a second

    def add_first(self, message: Any) -> List[Pair]:
        """:returns: pairs that are complete now"""
        if self._first and _stamp(message) < _stamp(self._first[-1]):
            self._first.clear()  # a clock was set back
        self._first.append(message)
        if len(self._first) > KEPT:
            self._first.popleft()
            self.alone += 1
        return self._complete()

    def add_second(self, message: Any) -> List[Pair]:
        """As add_first()."""
        if self._second and _stamp(message) < _stamp(self._second[-1]):
            self._second.clear()
        self._second.append(message)
        return self._complete()

    def _complete(self) -> List[Pair]:
        pairs = []
        # The nearest is known when a second one is not before it.
        while self._first and self._second and _stamp(self._second[-1]) >= _stamp(self._first[0]):
            first = self._first.popleft()
            nearest = min(self._second, key=lambda second: abs(_stamp(second) - _stamp(first)))
            if abs(_stamp(nearest) - _stamp(first)) <= self._slop:
                pairs.append(Pair(first, nearest))
            else:
                self.alone += 1
        return pairs


def _stamp(message: Any) -> int:
    return message.header.stamp.to_nsec()
