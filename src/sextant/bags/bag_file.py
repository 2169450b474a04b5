# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads bags without a master, and reports precisely how one is broken."""

import os
from typing import Any, Callable, Dict, Iterable, Iterator, NamedTuple, Optional, Sequence, Tuple

import genpy
import rosbag

from sextant.messages.damaged_message import DamagedMessage

REINDEX = "`rosbag reindex FILE` repairs a recording that was interrupted; if it was copied, copy it again"
NANOSECONDS = 10**9


class BagError(RuntimeError):
    """What is wrong with a file, and what to do about it. It can be pickled, for worker processes."""

    def __init__(self, path: str, what: str, advice: str):
        super().__init__(str(path), what, advice)
        self.path, self.what, self.advice = str(path), what, advice

    def __str__(self) -> str:
        return f"{self.path}: {self.what}; {self.advice}"


def listed(names: Iterable[str]) -> str:
    """Sorted names as text for a BagError; the word none if there are no names."""
    return ", ".join(sorted(set(names))) or "none"


class Recorded(NamedTuple):
    """A message as it is stored in the bag."""

    topic: str  # its name
    received: int  # time of reception, nanoseconds
    data: bytes  # serialized message
    type: Callable[[], Any]  # message class

    def message(self) -> Any:
        """Deserializes the message. :raises DamagedMessage: the bytes are not a message of its type"""
        try:
            message = self.type()
            message.deserialize(self.data)
        except Exception as error:  # genpy raises various exceptions
            raise DamagedMessage(f"the message is damaged ({error})") from None
        return message


class BagFile:
    """An open bag, or a part of one; a context manager.

    :param start, end: seconds after the first message of the bag, by the time of reception
    :raises BagError: it does not exist, is not a bag, is incomplete or encrypted, or contains no message
    """

    def __init__(self, path: str, start: float = 0.0, end: float = float("inf")):
        self.path = str(path)
        self._bag = self._opened()
        try:
            topics = self._bag.get_type_and_topic_info().topics
            self.types: Dict[str, str] = {name: info.msg_type for name, info in sorted(topics.items())}
            first, last = (self._bag.get_start_time(), self._bag.get_end_time()) if topics else (0.0, -1.0)
        except Exception as error:
            self.close()
            raise self._unreadable(error) from error
        if last < first:
            self.close()
            raise self.error("there is no message in it", "record again: were the topics' names right?")
        self._first = first
        self.start, self.end = first + start, min(first + end, last)
        # No limits where all is read: rounded to a float (0.2 us), they may exclude the first or last one.
        self._window = {}
        if start > 0.0:
            self._window["start_time"] = genpy.Time.from_sec(self.start)
        if self.end < last:
            self._window["end_time"] = genpy.Time.from_sec(self.end)

    def _opened(self) -> rosbag.Bag:
        if not os.path.isfile(self.path):
            what = "is a folder" if os.path.isdir(self.path) else "there is no such file"
            raise self.error(what, "name the file of a bag (.bag)")
        if os.path.getsize(self.path) == 0:
            raise self.error("the file is empty", "was the disk full? Record or copy it again")
        try:
            return rosbag.Bag(self.path)
        except Exception as error:
            raise self._unreadable(error) from error

    def _unreadable(self, error: Exception) -> BagError:
        if isinstance(error, OSError):
            return self.error(
                f"cannot be read ({error.strerror or error})", "check its permissions and the disk"
            )
        if isinstance(error, rosbag.ROSBagUnindexedException):
            return self.error(
                "has no index, or a broken one: its recording was cut off or not ended", REINDEX
            )
        if isinstance(error, rosbag.ROSBagException) and not isinstance(error, rosbag.ROSBagFormatException):
            return self.error(
                f"is no bag of ROS 1 that can be read ({error})", "name a file of `rosbag record`"
            )
        return self.error(f"is a broken bag ({error})", REINDEX)

    def error(self, what: str, advice: str) -> BagError:
        """Creates a BagError of this file."""
        return BagError(self.path, what, advice)

    def __enter__(self) -> "BagFile":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def close(self) -> None:
        """Closes the file."""
        self._bag.close()

    def topics(self, *types: str) -> Tuple[str, ...]:
        """Names of all topics of these types, for instance "sensor_msgs/Image"."""
        return tuple(topic for topic, each in self.types.items() if each in types)

    def find(self, topic: str) -> Optional[str]:
        """The topic as named in the bag, with or without leading slash; None if there is none."""
        return next((each for each in self.types if each.strip("/") == topic.strip("/")), None)

    def named(self, topic: str, what: str, *types: str) -> str:
        """The topic as named in the bag. :raises BagError: it does not exist, or has none of these types"""
        found, there = self.find(topic), self.topics(*types)
        if found not in there:
            raise self.error(f"there is no {what} on {topic}", f"topics with this type: {listed(there)}")
        return found

    def seconds(self, received: int) -> float:
        """Seconds after the first message of the bag."""
        return received / NANOSECONDS - self._first

    def fraction_read(self, received: int) -> float:
        """How far a time of reception is between start and end of the part to read, 0 to 1."""
        length = max(self.end - self.start, 1e-9)
        return min(max((received / NANOSECONDS - self.start) / length, 0.0), 1.0)

    def messages(self, topics: Sequence[str], whole: bool = False) -> Iterator[Recorded]:
        """Messages in the order of their reception.

        :param whole: also messages outside of start and end
        :raises BagError: the file is damaged; reports the second up to which it can be read
        """
        if not topics:
            return
        window = {} if whole else self._window
        messages = self._bag.read_messages(topics=list(topics), raw=True, **window)
        last = 0.0
        while True:
            try:
                topic, (_, data, _, _, message_type), time = next(messages)
            except StopIteration:
                return
            except Exception as error:  # various exceptions by compression and damage
                where = f"from {last:.2f} s on ({type(error).__name__}: {error})"
                advice = f"`end` at {last:.2f} s reads what comes before; " + REINDEX
                raise self.error("is damaged " + where, advice) from error
            last = self.seconds(time.to_nsec())
            yield Recorded(topic, time.to_nsec(), data, message_type)

    def first_received(self) -> int:
        """Time of reception of the first message of the bag, nanoseconds."""
        _, _, time = next(self._bag.read_messages(raw=True))
        return time.to_nsec()

    def first(self, topic: str, whole: bool = False) -> Any:
        """First message of the topic that is not damaged; None if there is none."""
        for recorded in self.messages([topic], whole):
            try:
                return recorded.message()
            except DamagedMessage:
                continue
        return None
