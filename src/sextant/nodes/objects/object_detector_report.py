# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What object_detector tells the operator."""

import time
from typing import Dict

import rospy
from diagnostic_msgs.msg import DiagnosticStatus
from diagnostic_updater import DiagnosticStatusWrapper

WARN_EVERY = 60.0  # seconds


class ObjectDetectorReport:
    """Counters, the time of every stage, and why the last picture was of no use."""

    def __init__(self) -> None:
        self.is_heard = False  # whether anybody listens
        self._counts = dict.fromkeys(("pictures", "refused pictures", "objects"), 0)
        self._reason, self._since, self._told = "", time.monotonic(), 0
        self._stages: Dict[str, float] = {}  # seconds of the last picture

    def used(self, objects: int, stages: Dict[str, float]) -> None:
        """A picture was. :param objects: that are in it. :param stages: seconds of each"""
        self._reason, self._stages = "", stages
        self._counts["pictures"] += 1
        self._counts["objects"] += objects

    def refused(self, reason: str) -> None:
        """A picture could not be used."""
        self._reason = reason
        self._counts["refused pictures"] += 1
        rospy.logwarn_throttle_identical(WARN_EVERY, f"a picture is left out: {reason}")

    def tell(self, row: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """As diagnostic_updater asks."""
        if self._reason:
            row.summary(DiagnosticStatus.WARN, self._reason)
        elif not self.is_heard:
            row.summary(DiagnosticStatus.OK, "nobody listens, nothing is detected")
        elif not self._counts["pictures"]:
            row.summary(DiagnosticStatus.WARN, "no picture yet")
        else:
            row.summary(DiagnosticStatus.OK, "objects are detected")
        for name, count in self._counts.items():
            row.add(name, str(count))
        row.add("rate", f"{self._rate():.1f} Hz")
        for name, seconds in self._stages.items():
            row.add(name, f"{1e3 * seconds:.1f} ms")
        return row

    def _rate(self) -> float:
        """Pictures a second since it was told last."""
        now, count = time.monotonic(), self._counts["pictures"]
        rate = (count - self._told) / max(now - self._since, 1e-3)
        self._since, self._told = now, count
        return rate
