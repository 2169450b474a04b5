# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks the stamps of recordings, and counts skipped messages."""

from collections import Counter
from typing import Dict, List, Set

from sextant.bags.bag_file import BagFile, Recorded
from sextant.base.stamp_jump import jumps_back
from sextant.messages.damaged_message import DamagedMessage


class StampOrder:
    """Checks the stamps of topics."""

    def __init__(self, bag: BagFile):
        self._bag = bag
        self._newest: Dict[str, int] = {}
        self._seen: Dict[str, Set[int]] = {}

    def check(self, recorded: Recorded, stamp: int) -> None:
        """Checks the stamp of a message, nanoseconds; messages may be out of order.

        :raises DamagedMessage: the stamp is zero, or a duplicate
        :raises BagError: the clock jumps back
        """
        if stamp <= 0:
            raise DamagedMessage("the stamp is zero")
        newest = self._newest.get(recorded.topic, stamp)
        if jumps_back(stamp, newest):
            second = self._bag.seconds(recorded.received)
            back = (newest - stamp) / 1e9
            what = f"the clock of {recorded.topic} jumps back by {back:.3f} s at {second:.3f} s"
            advice = f"was a bag played twice? Read the parts one by one: `end` or `start` at {second:.3f} s"
            raise self._bag.error(what, advice)
        seen = self._seen.setdefault(recorded.topic, set())
        if stamp in seen:
            raise DamagedMessage("the same stamp came before")
        seen.add(stamp)
        self._newest[recorded.topic] = max(newest, stamp)


class Losses:
    """Counts skipped messages by topic and reason."""

    def __init__(self) -> None:
        self._used: Counter = Counter()
        self._lost: Dict[str, Counter] = {}

    def used(self, topic: str) -> None:
        """Counts a usable message."""
        self._used[topic] += 1

    def lost(self, topic: str, reason: str) -> None:
        """Counts a skipped message."""
        self._lost.setdefault(topic, Counter())[reason] += 1

    def check(self, bag: BagFile, topic: str) -> None:
        """:raises BagError: no message of the topic was usable; names the most frequent reason"""
        if self._used[topic]:
            return
        if topic not in self._lost:
            raise bag.error(
                f"there is no message on {topic} in the part that is read", "look at start and end"
            )
        reason, count = self._lost[topic].most_common(1)[0]
        what = f"nothing on {topic} can be used: {reason} ({count} times)"
        raise bag.error(what, "name another topic or calibration, or record again")

    def notes(self) -> List[str]:
        """One line per topic and reason."""
        all_of = {topic: sum(lost.values()) + self._used[topic] for topic, lost in self._lost.items()}
        return [
            f"{topic}: {count} of {all_of[topic]} messages were left out: {reason}"
            for topic, reasons in sorted(self._lost.items())
            for reason, count in reasons.most_common()
        ]
