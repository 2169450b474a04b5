# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Waits for a subscriber before messages are published once only."""

import threading
import time
from typing import Callable

import rospy


def wait_for_subscriber(
    publisher: rospy.Publisher,
    timeout: float,
    stop: threading.Event,
    meanwhile: Callable[[], None] = lambda: None,
) -> None:
    """Returns when there is a subscriber, the timeout has passed (which is logged), or the node is shut down.

    :param timeout: seconds; 0: do not wait
    :param stop: set when the node is shut down
    :param meanwhile: called every 0.1 s while waiting
    """
    end = time.monotonic() + timeout
    while publisher.get_num_connections() == 0 and time.monotonic() < end and not stop.is_set():
        meanwhile()
        stop.wait(0.1)
    if timeout > 0.0 and publisher.get_num_connections() == 0 and not stop.is_set():
        rospy.logwarn("%s has no subscriber, continuing without", publisher.resolved_name)
