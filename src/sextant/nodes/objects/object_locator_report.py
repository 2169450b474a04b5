# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What object_locator tells the operator."""

from typing import Dict, Set

import rospy
from diagnostic_msgs.msg import DiagnosticStatus
from diagnostic_updater import DiagnosticStatusWrapper

WARN_EVERY = 60.0  # seconds


class ObjectLocatorReport:
    """Counters, and why the last picture was of no use."""

    def __init__(self) -> None:
        self.counts: Dict[str, int] = dict.fromkeys(
            ("pictures", "refused pictures", "objects", "located objects", "looks without odometry"), 0
        )
        self._reason, self._milliseconds = "", 0.0
        self._unknown: Set[str] = set()

    def used(self, objects: int, located: int, seconds: float) -> None:
        """A picture was. :param objects: that were detected in it. :param located: of these"""
        self._reason, self._milliseconds = "", 1e3 * seconds
        for name, count in (("pictures", 1), ("objects", objects), ("located objects", located)):
            self.counts[name] += count

    def refused(self, reason: str) -> None:
        """A picture could not be used."""
        self._reason = reason
        self.counts["refused pictures"] += 1
        rospy.logwarn_throttle_identical(WARN_EVERY, f"nothing is located: {reason}")

    def unknown(self, class_name: str) -> None:
        """A class that is not among the kinds; it is said once."""
        if class_name not in self._unknown:
            self._unknown.add(class_name)
            rospy.logwarn("a '%s' is not located: kinds has no such class", class_name)

    def tell(self, row: DiagnosticStatusWrapper, alone: int) -> DiagnosticStatusWrapper:
        """As diagnostic_updater asks. :param alone: pictures without a depth image"""
        if self._reason:
            row.summary(DiagnosticStatus.WARN, self._reason)
        elif not self.counts["pictures"]:
            row.summary(DiagnosticStatus.WARN, "no objects with a depth image yet")
        else:
            row.summary(DiagnosticStatus.OK, "objects are located")
        for name, count in self.counts.items():
            row.add(name, str(count))
        row.add("objects without a depth image", str(alone))
        row.add("classes that are not among the kinds", ", ".join(sorted(self._unknown)) or "none")
        row.add("time", f"{self._milliseconds:.1f} ms")
        return row
