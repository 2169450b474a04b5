# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Diagnostics of place_localizer."""

from typing import Optional

from diagnostic_msgs.msg import DiagnosticStatus
from diagnostic_updater import DiagnosticStatusWrapper

from sextant.places.place_localizer import Localization, Status

_LEVELS = {
    Status.LOCALIZED: (DiagnosticStatus.OK, "localized"),
    Status.AMBIGUOUS: (DiagnosticStatus.OK, "several places are possible"),
    Status.UNKNOWN_PLACE: (DiagnosticStatus.WARN, "unknown place"),
    Status.UNUSABLE: (DiagnosticStatus.WARN, "the image has too little content"),
}


class PlaceReport:
    """Counters, and the statistics of the last image."""

    def __init__(self) -> None:
        self.images, self.damaged, self.late, self.odometry, self.rough = 0, 0, 0, 0, 0
        self._last: Optional[Localization] = None
        self._distance: Optional[float] = None
        self._seconds = 0.0

    @property
    def status(self) -> Optional[Status]:
        """Status of the last image; None if there was none."""
        return self._last.status if self._last else None

    def add(self, found: Localization, distance: Optional[float], seconds: float) -> None:
        """Adds the result of an image.

        :param distance: metres since the previous image, by odometry; None: unknown
        :param seconds: processing time
        """
        self.images, self._last, self._distance, self._seconds = self.images + 1, found, distance, seconds

    def fill_diagnostics(self, row: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Task for diagnostic_updater."""
        level, text = _LEVELS[self._last.status] if self._last else (DiagnosticStatus.OK, "no image yet")
        row.summary(level, text)
        row.add("images", str(self.images))
        row.add("damaged images", str(self.damaged))
        row.add("late images", str(self.late))
        row.add("odometry messages", str(self.odometry))
        row.add("images with a rough pose", str(self.rough))
        if self._last:
            self._add_last(row, self._last)
        return row

    def _add_last(self, row: DiagnosticStatusWrapper, last: Localization) -> None:
        best = last.hypotheses[0] if last.hypotheses else None
        row.add("place", str(best.photo.id) if best else "none")
        row.add("probability", f"{best.probability:.3f}" if best else "0")
        row.add("unknown probability", f"{last.unknown_probability:.3f}")
        row.add("points of the metric pose", str(last.pose.inliers) if last.pose else "none")
        row.add("odometry distance", "unknown" if self._distance is None else f"{self._distance:.2f} m")
        statistics = last.statistics
        row.add("keypoints", str(statistics.keypoints))
        row.add("matches", str(statistics.matches))
        row.add("matches within the mean distance", str(statistics.kept))
        for name in ("minimum", "mean", "maximum", "total"):
            row.add(f"{name} distance", f"{getattr(statistics, name):.4g}")
        row.add("time", f"{1000 * self._seconds:.1f} ms")
