# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Results of a sweep of marker_design, written by hand for tests of its report."""

import numpy as np

from sextant.evaluation.marker_design import Cell, CellResult, Setup

SETUP = Setup((640, 480), "tag36h11", 4.0, 200.0)
# by size and number in view: position error in metres by distance; NaN: the markers do not fit into the image
ERRORS = {
    (0.1, 1): {0.5: 0.001, 1.0: 0.005, 2.0: 0.05, 4.0: 0.015},
    (0.1, 2): {0.5: np.nan, 1.0: 0.002, 2.0: 0.012, 4.0: 0.2},
    (0.2, 1): {0.5: 0.001, 1.0: 0.002, 2.0: 0.02, 4.0: 0.4},
    (0.2, 2): {0.5: np.nan, 1.0: 0.001, 2.0: 0.003, 4.0: 0.019},
}


def made_results(setup=SETUP, factor=1.0):
    """At 45 degrees with the errors above times a factor, at 0 with half of them; a marker is detected from
    25 px on (f = 500 px)."""
    results = []
    for (size, in_view), errors in ERRORS.items():
        for distance, error in errors.items():
            for angle, part in ((0.0, 0.5), (45.0, 1.0)):
                cell = Cell(setup, size, in_view, distance, angle)
                pixels, seen = 500.0 * size / distance, not np.isnan(error)
                figures = [float(pixels >= 25.0), 1.0, 0.5 * part * error, part * factor * error, 0.01, 0.03]
                results.append(CellResult(cell, pixels, 20 * seen, *(figures if seen else [np.nan] * 6)))
    return results
