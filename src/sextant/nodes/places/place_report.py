# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What place_localizer tells the operator."""

from typing import Optional

from diagnostic_msgs.msg import DiagnosticStatus
from diagnostic_updater import DiagnosticStatusWrapper

from sextant.places.place_localization import Localization, Status

_LEVELS = {
    Status.LOCALIZED: (DiagnosticStatus.OK, "localized"),
    Status.AMBIGUOUS: (DiagnosticStatus.OK, "several places are possible"),
    Status.NOWHERE: (DiagnosticStatus.WARN, "nowhere that the map knows"),
    Status.UNUSABLE: (DiagnosticStatus.WARN, "the picture shows too little"),
}


class PlaceReport:
    """Counters, and the statistics of the last picture."""

    def __init__(self) -> None:
        self.pictures, self.damaged, self.late, self.odometry = 0, 0, 0, 0
        self._last: Optional[Localization] = None
        self._gone: Optional[float] = None
        self._seconds = 0.0

    @property
    def status(self) -> Optional[Status]:
        """Of the last picture; None: there was none."""
        return self._last.status if self._last else None

    def add(self, found: Localization, gone: Optional[float], seconds: float) -> None:
        """:param gone: metres since the picture before; None: odometry does not tell it

        :param seconds: that the picture took
        """
        self.pictures, self._last, self._gone, self._seconds = self.pictures + 1, found, gone, seconds

    def tell(self, row: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """As diagnostic_updater asks."""
        level, text = _LEVELS[self._last.status] if self._last else (DiagnosticStatus.OK, "no picture yet")
        row.summary(level, text)
        row.add("pictures", str(self.pictures))
        row.add("damaged pictures", str(self.damaged))
        row.add("late pictures", str(self.late))
        row.add("odometry messages", str(self.odometry))
        if self._last:
            self._add_last(row, self._last)
        return row

    def _add_last(self, row: DiagnosticStatusWrapper, last: Localization) -> None:
        best = last.answers[0] if last.answers else None
        row.add("place", str(best.photo.id) if best else "none")
        row.add("probability", f"{best.probability:.3f}" if best else "0")
        row.add("nowhere", f"{last.nowhere:.3f}")
        row.add("gone by odometry", "unknown" if self._gone is None else f"{self._gone:.2f} m")
        statistics = last.statistics
        row.add("keypoints", str(statistics.keypoints))
        row.add("matches", str(statistics.matches))
        row.add("matches not farther than the mean", str(statistics.kept))
        for name in ("minimum", "mean", "maximum", "total"):
            row.add(f"{name} distance", f"{getattr(statistics, name):.4g}")
        row.add("time", f"{1000 * self._seconds:.1f} ms")
