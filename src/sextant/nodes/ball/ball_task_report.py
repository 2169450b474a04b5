# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Diagnostics and warnings of the node ball_task."""

from dataclasses import dataclass

import rospy
from diagnostic_msgs.msg import DiagnosticStatus
from diagnostic_updater import DiagnosticStatusWrapper

from sextant.ball.task_view import TaskView

WARN_EVERY = 60.0  # seconds
_LEVELS = {"waiting": DiagnosticStatus.WARN, "failed": DiagnosticStatus.ERROR}


@dataclass
class BallTaskReport:
    """Counters and the present state."""

    state: str = "stopped"  # of the task
    reason: str = ""  # of the last change of state
    kicks: int = 0  # number of kicks
    pillars: int = 0  # number of pillars in the map
    ball: str = "not seen"  # when it was seen last
    depth_images: int = 0  # number of depth images received
    without_pose: int = 0  # depth images without a pose
    rejected: int = 0  # messages
    longest_step: float = 0.0  # seconds

    def set_view(self, view: TaskView) -> None:
        """Set what is known about pillars and ball."""
        self.pillars = len(view.pillars)
        age = view.ball and view.stamp - view.ball.stamp
        self.ball = "not seen" if age is None else f"seen {age:.2f} s ago"

    def reject(self, topic: str, error: ValueError) -> None:
        """Count a rejected message and log the reason."""
        self.rejected += 1
        rospy.logwarn_throttle_identical(WARN_EVERY, f"{rospy.resolve_name(topic)} rejected: {error}")

    def fill_diagnostics(self, row: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Fill a row of diagnostic_updater."""
        row.summary(_LEVELS.get(self.state, DiagnosticStatus.OK), f"{self.state}: {self.reason}")
        row.add("kicks", str(self.kicks))
        row.add("pillars", str(self.pillars))
        row.add("ball", self.ball)
        row.add("depth images", str(self.depth_images))
        row.add("depth images without pose", str(self.without_pose))
        row.add("rejected messages", str(self.rejected))
        row.add("longest step", f"{1e3 * self.longest_step:.0f} ms")
        return row
