# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A bag that is read without a master, and every way in which one can be broken, named."""

import os
from typing import Any, Callable, Dict, Iterator, NamedTuple, Optional, Sequence, Tuple

import genpy
import rosbag

REINDEX = (
    "a recording that was cut off is made whole by `rosbag reindex FILE`; if it was copied, copy it again"
)
NANOSECONDS = 10**9


class BagError(RuntimeError):
    """What is wrong with a file, and what to do about it. It can be pickled: workers hand it back."""

    def __init__(self, path: str, what: str, advice: str):
        super().__init__(str(path), what, advice)
        self.path, self.what, self.advice = str(path), what, advice

    def __str__(self) -> str:
        return f"{self.path}: {self.what}; {self.advice}"


class DamagedMessage(ValueError):
    """One message that cannot be used, and why; the others of its topic may be good."""


class Recorded(NamedTuple):
    """A message as it lies in the bag."""

    topic: str
    received: int  # nanoseconds
    data: bytes
    type: Callable[[], Any]

    def message(self) -> Any:
        """:raises DamagedMessage: its bytes are no message of its type"""
        try:
            message = self.type()
            message.deserialize(self.data)
        except Exception as error:  # genpy raises what the damage happens to lead to
            raise DamagedMessage(f"the message is damaged ({error})") from None
        return message


class BagFile:
    """An open bag, or a part of one; a context manager.

    :param start, end: seconds after the bag's first message, by the time of reception
    :raises BagError: it is not there, is no bag, is not whole, is encrypted, or holds no message
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
        self._window = {}  # a float of today's seconds is good to 0.2 us only: none where all is read
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
            return self.error(f"cannot be read ({error.strerror or error})", "is it yours to read?")
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
        """A BagError of this file."""
        return BagError(self.path, what, advice)

    def __enter__(self) -> "BagFile":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def close(self) -> None:
        """Closes the file."""
        bag = getattr(self, "_bag", None)
        if bag is not None:
            bag.close()

    def topics(self, *types: str) -> Tuple[str, ...]:
        """Names of all topics of these types, e.g. "sensor_msgs/Image"."""
        return tuple(topic for topic, each in self.types.items() if each in types)

    def find(self, topic: str) -> Optional[str]:
        """The topic as the bag spells it: with or without its first slash."""
        return next((each for each in self.types if each.strip("/") == topic.strip("/")), None)

    def seconds(self, received: int) -> float:
        """Seconds after the bag's first message, as `start` and `end` count."""
        return received / NANOSECONDS - self._first

    def share_read(self, received: int) -> float:
        """How much of what is to be read lies before this reception, 0 to 1."""
        length = max(self.end - self.start, 1e-9)
        return min(max((received / NANOSECONDS - self.start) / length, 0.0), 1.0)

    def messages(self, topics: Sequence[str], whole: bool = False) -> Iterator[Recorded]:
        """In the order of their reception.

        :param whole: also those outside of start and end
        :raises BagError: the file is damaged; names the second up to which it can be read
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
            except Exception as error:  # each compression and each broken record has its own
                readable = f"from {last:.2f} s on ({type(error).__name__}: {error})"
                advice = f"`end` at {last:.2f} s reads what comes before; " + REINDEX
                raise self.error("is damaged " + readable, advice) from error
            last = self.seconds(time.to_nsec())
            yield Recorded(topic, time.to_nsec(), data, message_type)

    def first_received(self) -> int:
        """Of all messages of the bag, nanoseconds."""
        _, _, time = next(self._bag.read_messages(raw=True))
        return time.to_nsec()

    def first(self, topic: str, whole: bool = False) -> Any:
        """The topic's first message that is not damaged, None if there is none."""
        for recorded in self.messages([topic], whole):
            try:
                return recorded.message()
            except DamagedMessage:
                continue
        return None
