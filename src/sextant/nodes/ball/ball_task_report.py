# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What ball_task tells the operator."""

from dataclasses import dataclass

import rospy
from diagnostic_msgs.msg import DiagnosticStatus
from diagnostic_updater import DiagnosticStatusWrapper

from sextant.ball.task_view import TaskView

WARN_EVERY = 60.0  # seconds
_LEVELS = {"waiting": DiagnosticStatus.WARN, "failed": DiagnosticStatus.ERROR}


@dataclass
class BallTaskReport:
    """Counters, and what is the case now."""

    state: str = "stopped"
    reason: str = ""
    kicks: int = 0
    pillars: int = 0
    ball: str = "not seen"
    depth_images: int = 0
    without_pose: int = 0  # of these
    refused: int = 0  # messages
    slowest: float = 0.0  # seconds, of a step

    def see(self, view: TaskView) -> None:
        """What is known."""
        self.pillars = len(view.pillars)
        age = view.ball and view.stamp - view.ball.stamp
        self.ball = "not seen" if age is None else f"seen {age:.2f} s ago"

    def refuse(self, topic: str, error: ValueError) -> None:
        """A message could not be used."""
        self.refused += 1
        rospy.logwarn_throttle_identical(WARN_EVERY, f"{rospy.resolve_name(topic)} is not used: {error}")

    def tell(self, row: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """As diagnostic_updater asks."""
        row.summary(_LEVELS.get(self.state, DiagnosticStatus.OK), f"{self.state}: {self.reason}")
        row.add("kicks", str(self.kicks))
        row.add("pillars", str(self.pillars))
        row.add("ball", self.ball)
        row.add("depth images", str(self.depth_images))
        row.add("depth images without pose", str(self.without_pose))
        row.add("refused messages", str(self.refused))
        row.add("slowest step", f"{1e3 * self.slowest:.0f} ms")
        return row
