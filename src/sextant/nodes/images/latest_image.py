# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Processes the latest image of a topic in the main thread, while the node's output has a subscriber."""

import threading
import time
from collections import deque
from typing import Any, Callable, Deque, Optional

import rospy
from diagnostic_updater import Updater

POLL_PERIOD = 0.2  # seconds between checks for subscribers
REPORT_PERIOD = 1.0  # seconds between diagnostics
BUFFER = 2**24  # size of the input buffer, bytes


class LatestImage:
    """Processes the latest image; of images that arrive before the next one is due, only the last is kept."""

    def __init__(
        self,
        topic: str,
        kind: type,
        is_wanted: Callable[[], bool],
        work: Callable[[Any], None],
        rate: float = 0.0,
    ):
        """
        :param kind: message type
        :param is_wanted: returns whether the output has a subscriber
        :param work: processes one message
        :param rate: maximum rate of images that are processed, by wall time, Hz; 0: no limit
        """
        self._topic, self._kind, self._is_wanted, self._work = topic, kind, is_wanted, work
        self._period = 1 / rate if rate else 0.0  # seconds between two images
        self._news, self._stop = threading.Event(), threading.Event()
        self._waiting: Deque = deque(maxlen=1)
        self._subscriber: Optional[rospy.Subscriber] = None
        rospy.on_shutdown(self._stop.set)

    def run(self, updater: Updater) -> None:
        """Processes images until the node is shut down."""
        due = next_image = 0.0
        while not self._stop.is_set():
            self._subscribe()
            early = next_image - time.monotonic()
            if early > 0:
                self._stop.wait(min(early, POLL_PERIOD))
            elif self._news.wait(POLL_PERIOD):
                self._news.clear()
                if self._waiting:  # empty if the image was processed already
                    next_image = time.monotonic() + self._period
                    self._work(self._waiting.pop())
            if time.monotonic() >= due:  # update() would query the master for the period, and fail without it
                due = time.monotonic() + REPORT_PERIOD
                updater.force_update()

    def _subscribe(self) -> None:
        """Subscribes or unsubscribes. Not in a callback of rospy, to avoid a deadlock with its locks."""
        wanted = self._is_wanted()
        if wanted and self._subscriber is None:
            self._subscriber = rospy.Subscriber(
                self._topic, self._kind, self._on_image, queue_size=1, buff_size=BUFFER
            )
        elif not wanted and self._subscriber is not None:
            self._subscriber.unregister()
            self._subscriber = None
            self._waiting.clear()

    def _on_image(self, message: Any) -> None:
        self._waiting.append(message)
        self._news.set()
