# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Finds of each message the one of another topic whose stamp is nearest."""

from collections import deque
from typing import Any, Deque, List, NamedTuple

LONGEST = 2 * 10**9  # nanoseconds that a message waits for its other, at most


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
        self._second: Deque = deque()
        self.alone = 0  # first ones without a second

    def add_first(self, message: Any) -> List[Pair]:
        """:returns: pairs that are complete now"""
        if self._first and _stamp(message) < _stamp(self._first[-1]):
            self._first.clear()  # a clock was set back
        self._first.append(message)
        self.alone += _shortened(self._first)
        return self._complete()

    def add_second(self, message: Any) -> List[Pair]:
        """As add_first()."""
        if self._second and _stamp(message) < _stamp(self._second[-1]):
            self._second.clear()
        self._second.append(message)
        _shortened(self._second)
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


def _shortened(messages: Deque) -> int:
    """Without those that are too old; their number."""
    count = len(messages)
    while _stamp(messages[0]) < _stamp(messages[-1]) - LONGEST:
        messages.popleft()
    return count - len(messages)


def _stamp(message: Any) -> int:
    return message.header.stamp.to_nsec()
