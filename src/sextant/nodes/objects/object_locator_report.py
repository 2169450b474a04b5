# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Diagnostics and warnings of the node object_locator."""

from typing import Dict, Set

import rospy
from diagnostic_msgs.msg import DiagnosticStatus
from diagnostic_updater import DiagnosticStatusWrapper

WARN_EVERY = 60.0  # seconds


class ObjectLocatorReport:
    """Counters, and the reason why the last image was rejected."""

    def __init__(self) -> None:
        self.counts: Dict[str, int] = dict.fromkeys(
            ("images", "rejected images", "objects", "located objects"), 0
        )
        # Set by the node: images that the ball filter could not use.
        self.counts["images without odometry"] = 0
        self._reason, self._milliseconds = "", 0.0
        self._unknown: Set[str] = set()

    def processed(self, objects: int, located: int, seconds: float) -> None:
        """Count a processed image.

        :param objects: number of detected objects. :param located: number of these that were located
        """
        self._reason, self._milliseconds = "", 1e3 * seconds
        for name, count in (("images", 1), ("objects", objects), ("located objects", located)):
            self.counts[name] += count

    def rejected(self, reason: str) -> None:
        """Count a rejected image and log the reason."""
        self._reason = reason
        self.counts["rejected images"] += 1
        rospy.logwarn_throttle_identical(WARN_EVERY, f"nothing is located: {reason}")

    def unknown(self, class_name: str) -> None:
        """Warn once about a class that is not among the kinds."""
        if class_name not in self._unknown:
            self._unknown.add(class_name)
            rospy.logwarn("objects of class '%s' are not located: kinds contains no such class", class_name)

    def fill_diagnostics(self, row: DiagnosticStatusWrapper, unpaired: int) -> DiagnosticStatusWrapper:
        """Fill a row of diagnostic_updater.

        :param unpaired: number of Objects messages for which no depth image came
        """
        if self._reason:
            row.summary(DiagnosticStatus.WARN, self._reason)
        elif not self.counts["images"]:
            row.summary(DiagnosticStatus.WARN, "no Objects message with a matching depth image yet")
        else:
            row.summary(DiagnosticStatus.OK, "objects are located")
        for name, count in self.counts.items():
            row.add(name, str(count))
        row.add("Objects messages without a depth image", str(unpaired))
        row.add("classes that are not among the kinds", ", ".join(sorted(self._unknown)) or "none")
        row.add("time", f"{self._milliseconds:.1f} ms")
        return row
