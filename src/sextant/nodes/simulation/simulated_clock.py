# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulated time on /clock, paced by wall time."""

import threading
import time
from contextlib import contextmanager
from typing import Iterator

import rosgraph
import rospy
from rosgraph_msgs.msg import Clock

from sextant.nodes.base.exits import until_shutdown
from sextant.nodes.base.init_node import init_node

STEP = 10_000_000  # nanoseconds of simulated time, maximum between two messages


@contextmanager
def simulated_time(name: str) -> Iterator[None]:
    """Starts the node of this name, which publishes /clock, and removes /use_sim_time when it ends.

    Otherwise nodes that start later on this master would wait for the clock forever.
    """
    init_node(name)
    try:
        with until_shutdown():
            yield
    finally:
        _end_simulated_time(rosgraph.Master(rospy.get_name()))


def _end_simulated_time(master: rosgraph.Master) -> None:
    """Delete the parameter, unless another node publishes /clock or this node's /clock is remapped."""
    try:
        publishers = dict(master.getSystemState()[0]).get("/clock", [])
        is_last = not set(publishers) - {rospy.get_name()}
        if is_last and rospy.resolve_name("/clock") == "/clock" and master.hasParam("/use_sim_time"):
            master.deleteParam("/use_sim_time")
    except OSError:  # the master has ended, and its parameters with it
        pass


class SimulatedClock:
    """Simulated time, limited by real_time_factor; it waits when the simulation is late."""

    def __init__(self, start: int, real_time_factor: float, stop: threading.Event):
        """:param start: first time, nanoseconds
        :param stop: set when the node ends; then nothing waits anymore
        """
        self._publisher = rospy.Publisher(
            "/clock", Clock, queue_size=100
        )  # late messages follow without delay
        self._now = start
        self._factor = real_time_factor
        self._stop = stop
        self._due = time.monotonic()  # earliest wall time of the next message

    def advance(self, instant: int) -> None:
        """Advances /clock to this time (nanoseconds)."""
        while self._now < instant and not self._stop.is_set():
            step = min(STEP, instant - self._now)
            self._due = max(self._due + 1e-9 * step / self._factor, time.monotonic() - 0.1)
            self._stop.wait(max(0.0, self._due - time.monotonic()))
            self._now += step
            if not self._stop.is_set():
                self.publish()

    def publish(self) -> None:
        """Publishes the present time."""
        self._publisher.publish(Clock(rospy.Time(nsecs=self._now)))

    @property
    def now(self) -> int:
        """The present simulated time, nanoseconds."""
        return self._now
