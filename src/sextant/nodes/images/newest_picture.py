# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Work on the newest picture of a topic, in the main thread, while somebody listens to what comes of it."""

import threading
import time
from collections import deque
from typing import Any, Callable, Deque, Optional

import rospy
from diagnostic_updater import Updater

PAUSE = 0.2  # seconds, between two looks at who listens
REPORT_EVERY = 1.0  # seconds, to diagnostics
BUFFER = 2**24  # bytes, of a connection


class NewestPicture:
    """Of pictures that come faster than they are worked on, the newest wins."""

    def __init__(self, topic: str, kind: type, is_wanted: Callable[[], bool], work: Callable[[Any], None]):
        """:param kind: of the messages
        :param is_wanted: whether somebody listens
        :param work: on one message
        """
        self._topic, self._kind, self._is_wanted, self._work = topic, kind, is_wanted, work
        self._news, self._stop = threading.Event(), threading.Event()
        self._waiting: Deque = deque(maxlen=1)
        self._subscriber: Optional[rospy.Subscriber] = None
        rospy.on_shutdown(self._stop.set)

    def run(self, updater: Updater) -> None:
        """Until the node ends."""
        due = 0.0
        while not self._stop.is_set():
            self._listen()
            if self._news.wait(PAUSE):
                self._news.clear()
                if self._waiting:  # not where the news was of one that is done
                    self._work(self._waiting.pop())
            if time.monotonic() >= due:  # update() asks the master for the period, and fails without it
                due = time.monotonic() + REPORT_EVERY
                updater.force_update()

    def _listen(self) -> None:
        """Not in a call by rospy, whose locks would meet ours."""
        wanted = self._is_wanted()
        if wanted and self._subscriber is None:
            self._subscriber = rospy.Subscriber(
                self._topic, self._kind, self._hear, queue_size=1, buff_size=BUFFER
            )
        elif not wanted and self._subscriber is not None:
            self._subscriber.unregister()
            self._subscriber = None
            self._waiting.clear()

    def _hear(self, message: Any) -> None:
        self._waiting.append(message)
        self._news.set()
