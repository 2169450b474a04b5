# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Diagnostics and warnings of the node object_detector."""

import time
from typing import Dict

import rospy
from diagnostic_msgs.msg import DiagnosticStatus
from diagnostic_updater import DiagnosticStatusWrapper

WARN_EVERY = 60.0  # seconds


class ObjectDetectorReport:
    """Counters, processing times of all stages, and the reason why the last image was rejected."""

    def __init__(self) -> None:
        self.has_subscribers = False
        self._counts = dict.fromkeys(("images", "rejected images", "objects"), 0)
        self._reason, self._since, self._counted = "", time.monotonic(), 0
        self._stages: Dict[str, float] = {}  # processing time of each stage, last image

    def processed(self, objects: int, stages: Dict[str, float]) -> None:
        """Count a processed image. :param objects: detections. :param stages: seconds of each stage"""
        self._reason, self._stages = "", stages
        self._counts["images"] += 1
        self._counts["objects"] += objects

    def rejected(self, reason: str) -> None:
        """Count a rejected image and log the reason."""
        self._reason = reason
        self._counts["rejected images"] += 1
        rospy.logwarn_throttle_identical(WARN_EVERY, f"image rejected: {reason}")

    def fill_diagnostics(self, row: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Fill a row of diagnostic_updater."""
        if self._reason:
            row.summary(DiagnosticStatus.WARN, self._reason)
        elif not self.has_subscribers:
            row.summary(DiagnosticStatus.OK, "no subscribers, nothing is detected")
        elif not self._counts["images"]:
            row.summary(DiagnosticStatus.WARN, "no image yet")
        else:
            row.summary(DiagnosticStatus.OK, "objects are detected")
        for name, count in self._counts.items():
            row.add(name, str(count))
        row.add("rate", f"{self._rate():.1f} Hz")
        for name, seconds in self._stages.items():
            row.add(name, f"{1e3 * seconds:.1f} ms")
        return row

    def _rate(self) -> float:
        """Images per second since the last call."""
        now, count = time.monotonic(), self._counts["images"]
        rate = (count - self._counted) / max(now - self._since, 1e-3)
        self._since, self._counted = now, count
        return rate
