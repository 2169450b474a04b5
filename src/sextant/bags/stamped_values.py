# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the messages of one topic say, by their stamps."""

from typing import Any, Callable, Dict, List, NamedTuple

from sextant.bags.bag_file import BagFile
from sextant.bags.stamps import Losses, StampOrder


class StampedValues(NamedTuple):
    """Of one topic."""

    values: Dict[int, Any]  # by stamp in nanoseconds, growing
    first: Any  # message
    notes: List[str]  # how many messages were left out, and why


def stamped_values(bag: BagFile, topic: str, value: Callable[[Any, Any], Any]) -> StampedValues:
    """value(message, the topic's first message) of all messages that can be used.

    :param value: raises ValueError for a message that cannot be
    :raises BagError: none can be used, or the clock jumps back
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
