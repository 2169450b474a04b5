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
    """The first may come later than the second, or before it. Messages of either topic come in order.

    The synchronizers of message_filters take the first one within the slop, not the nearest, do not count
    what is left alone, and pair nothing any more after the wall's clock was set back.
    """

    def __init__(self, slop: float):
        """:param slop: seconds that two stamps may differ"""
        self._slop = round(1e9 * slop)  # nanoseconds
        self._first: Deque = deque()
        self._second: Deque = deque()
        self.alone = 0  # first ones without a second

    def add_first(self, message: Any) -> List[Pair]:
        """:returns: pairs that are complete now"""
        self.alone += _append(self._first, message)
        return self._complete()

    def add_second(self, message: Any) -> List[Pair]:
        """As add_first()."""
        _append(self._second, message)
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


def _append(messages: Deque, message: Any) -> int:
    """:returns: how many were too old to keep"""
    if messages and _stamp(message) < _stamp(messages[-1]):
        messages.clear()  # a clock was set back
    messages.append(message)
    count = len(messages)
    while _stamp(messages[0]) < _stamp(message) - LONGEST:
        messages.popleft()
    return count - len(messages)


def _stamp(message: Any) -> int:
    return message.header.stamp.to_nsec()
