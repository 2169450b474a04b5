# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads one value per message of a topic, by stamp."""

from typing import Any, Callable, Dict, List, NamedTuple

from sextant.bags.bag_file import BagFile
from sextant.bags.stamps import Losses, StampOrder


class StampedValues(NamedTuple):
    """Values of one topic."""

    values: Dict[int, Any]  # by stamp in nanoseconds, increasing
    first: Any  # first message
    notes: List[str]  # numbers of skipped messages, with the reasons


def stamped_values(bag: BagFile, topic: str, value: Callable[[Any, Any], Any]) -> StampedValues:
    """Computes value(message, first message of the topic) for all usable messages.

    :param value: raises ValueError for an unusable message
    :raises BagError: no message is usable, or the clock jumps back
    """
    order, losses = StampOrder(bag), Losses()
    values: Dict[int, Any] = {}
    first = None
    for recorded in bag.messages([topic]):
        try:
            message = recorded.message()
            first = message if first is None else first
            read, stamp = value(message, first), message.header.stamp.to_nsec()
            order.check(recorded, stamp)
        except ValueError as error:
            losses.lost(topic, str(error))
            continue
        losses.used(topic)
        values[stamp] = read
    losses.check(bag, topic)
    return StampedValues({stamp: values[stamp] for stamp in sorted(values)}, first, losses.notes())
