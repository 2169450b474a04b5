# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Start and end of a simulated drive."""

import time
from typing import Callable, List

import rospy
from std_msgs.msg import Bool
from std_srvs.srv import SetBool

SETTLE = 1.0  # seconds without a new pose, after which the last image is considered processed


class DriveWatch:
    """Starts a simulated drive when its topics are connected, and waits for its end on the topic finished."""

    def __init__(self, start_service: str, timeout: float):
        """:param start_service: of type std_srvs/SetBool; empty: none

        :param timeout: maximum time to wait for the topics, for the service, and for the next pose, seconds
        """
        self._service, self._timeout = start_service, timeout
        self._finished, self._received = False, time.monotonic()
        rospy.Subscriber("finished", Bool, self._on_finished)

    def _on_finished(self, message: Bool) -> None:
        self._finished = message.data

    def pose_received(self) -> None:
        """Notes that the drive continues."""
        self._received = time.monotonic()

    def start(self, missing: Callable[[], List[str]]) -> None:
        """Starts the drive when no topic is missing.

        :raises RuntimeError: a topic or the service is not available in time
        """
        end = time.monotonic() + self._timeout
        while missing():
            if time.monotonic() > end or rospy.is_shutdown():
                raise RuntimeError("nothing is published on " + ", ".join(missing()))
            time.sleep(0.1)
        if self._service:
            time.sleep(SETTLE)  # the locators may receive the map a little later
            rospy.wait_for_service(self._service, self._timeout)
            rospy.ServiceProxy(self._service, SetBool)(True)
        self.pose_received()

    def wait(self) -> bool:
        """Waits; returns whether the drive has ended, False if the node is shut down before.

        :raises RuntimeError: no pose was received for too long
        """
        while not rospy.is_shutdown():
            idle = time.monotonic() - self._received
            if self._finished and idle > SETTLE:
                return True
            if idle > self._timeout:
                raise RuntimeError(f"no pose for {idle:.0f} s, and the drive has not ended")
            time.sleep(0.1)
        return False
