# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulated time on /clock, paced by the wall's clock."""

import threading
import time
from contextlib import contextmanager
from typing import Iterator

import rosgraph
import rospy
from rosgraph_msgs.msg import Clock

from sextant.nodes.base.exits import until_shutdown

STEP = 10_000_000  # nanoseconds of simulated time between two ticks at most


@contextmanager
def simulated_time(name: str) -> Iterator[None]:
    """Starts the node of this name, which publishes /clock, and removes /use_sim_time when it ends.

    Nodes that start later on this master would wait for a time for ever.
    """
    rospy.init_node(name)
    try:
        with until_shutdown():
            yield
    finally:
        _end_simulated_time(rosgraph.Master(rospy.get_name()))


def _end_simulated_time(master: rosgraph.Master) -> None:
    """Unless another node goes on to publish /clock, or this one has published a clock of its own."""
    try:
        publishers = dict(master.getSystemState()[0]).get("/clock", [])
        is_last = not set(publishers) - {rospy.get_name()}
        if is_last and rospy.resolve_name("/clock") == "/clock" and master.hasParam("/use_sim_time"):
            master.deleteParam("/use_sim_time")
    except OSError:  # the master has ended, and its parameters with it
        pass


class SimulatedClock:
    """Time that never runs ahead of real_time_factor, and waits where the simulation is late."""

    def __init__(self, start: int, real_time_factor: float, stop: threading.Event):
        """:param start: first instant, nanoseconds
        :param stop: set when the node ends; then nothing here waits any more
        """
        self._publisher = rospy.Publisher("/clock", Clock, queue_size=100)  # late ticks come at once
        self._now = start
        self._factor = real_time_factor
        self._stop = stop
        self._due = time.monotonic()  # when the next tick may be at the earliest

    def advance(self, instant: int) -> None:
        """Ticks until /clock has told this instant (nanoseconds)."""
        while self._now < instant and not self._stop.is_set():
            step = min(STEP, instant - self._now)
            self._due = max(self._due + 1e-9 * step / self._factor, time.monotonic() - 0.1)
            self._stop.wait(max(0.0, self._due - time.monotonic()))
            self._now += step
            if not self._stop.is_set():
                self.tell()

    def tell(self) -> None:
        """Publishes the present instant."""
        self._publisher.publish(Clock(rospy.Time(nsecs=self._now)))

    @property
    def now(self) -> int:
        """Nanoseconds."""
        return self._now
