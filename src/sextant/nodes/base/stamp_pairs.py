# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pairs messages of two topics by the nearest stamp."""

from collections import deque
from typing import Any, Deque, List, NamedTuple

MAX_WAIT = 2 * 10**9  # nanoseconds that a message waits for its counterpart


class Pair(NamedTuple):
    """Two messages with headers."""

    first: Any  # of the first topic
    second: Any  # of the second topic


class StampPairs:
    """Pairs messages. Messages of one topic arrive in order; the topics may arrive in any order.

    The synchronizers of message_filters use the first message within the slop instead of the nearest, do not
    count unmatched messages, and stop working when the wall clock is set back.
    """

    def __init__(self, slop: float):
        """:param slop: maximum difference of two stamps, seconds"""
        self._slop = round(1e9 * slop)  # nanoseconds
        self._first: Deque = deque()
        self._second: Deque = deque()
        self.unmatched = 0  # number of messages of the first topic without a counterpart

    def add_first(self, message: Any) -> List[Pair]:
        """Adds a message of the first topic; returns the new pairs."""
        self.unmatched += _append(self._first, message)
        return self._complete()

    def add_second(self, message: Any) -> List[Pair]:
        """Adds a message of the second topic; returns the new pairs."""
        _append(self._second, message)
        return self._complete()

    def _complete(self) -> List[Pair]:
        pairs = []
        # The nearest one is known once a message of the second topic is not older.
        while self._first and self._second and _stamp(self._second[-1]) >= _stamp(self._first[0]):
            first = self._first.popleft()
            nearest = min(self._second, key=lambda second: abs(_stamp(second) - _stamp(first)))
            if abs(_stamp(nearest) - _stamp(first)) <= self._slop:
                pairs.append(Pair(first, nearest))
            else:
                self.unmatched += 1
        return pairs


def _append(messages: Deque, message: Any) -> int:
    """Adds a message; returns the number of dropped old messages."""
    if messages and _stamp(message) < _stamp(messages[-1]):
        messages.clear()  # the clock was set back
    messages.append(message)
    count = len(messages)
    while _stamp(messages[0]) < _stamp(message) - MAX_WAIT:
        messages.popleft()
    return count - len(messages)


def _stamp(message: Any) -> int:
    return message.header.stamp.to_nsec()
