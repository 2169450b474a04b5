# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Waiting until somebody hears what would be said only once."""

import threading
import time
from typing import Callable

import rospy


def wait_for_listener(
    publisher: rospy.Publisher,
    patience: float,
    stop: threading.Event,
    meanwhile: Callable[[], None] = lambda: None,
) -> None:
    """Returns when somebody listens, the node ends, or nobody came; that is said.

    :param patience: seconds; 0: it is not waited, and nothing is said
    :param stop: set when the node ends
    """
    end = time.monotonic() + patience
    while publisher.get_num_connections() == 0 and time.monotonic() < end and not stop.is_set():
        meanwhile()
        stop.wait(0.1)
    if patience > 0.0 and publisher.get_num_connections() == 0 and not stop.is_set():
        rospy.logwarn("nobody listens to %s, it begins all the same", publisher.resolved_name)
