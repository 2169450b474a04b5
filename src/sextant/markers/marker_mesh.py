# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Triangle meshes of printed markers with their modules, in true size."""

from typing import Iterator, Tuple

import numpy as np

import sextant

QUIET_MODULES = 1  # width of the white rim, modules
BACK_GREY = 0.45  # grey level of the back, 0 black to 1 white
BACK_DISTANCE = 0.1  # from front to back, modules, so that the two do not flicker


def board_triangles(family: str, id: int, size: float) -> Tuple[np.ndarray, np.ndarray]:
    """Builds the mesh of a marker: its modules, a white rim around them, and a grey back.

    :param size: edge length in metres, between the detected corners
    :returns: (3N, 3) corners of N triangles in the marker frame in metres, counter-clockwise as seen from the
        front (from behind for the back), and (N,) grey levels, 0 black to 1 white
    :raises ValueError: unknown family, or an id that is not in the family
    """
    modules, begin, end = sextant.marker_image(family, id)
    modules = np.pad(modules, QUIET_MODULES, constant_values=255)
    edge = size / (end - begin)
    middle = 0.5 * (begin + end) + QUIET_MODULES
    runs = list(module_runs(modules))
    faces = [_quad(left, middle - row - 1, right, middle - row, -middle) for row, left, right, _ in runs]
    back = _quad(0, middle - len(modules), len(modules), middle, -middle)[::-1] - [0.0, 0.0, BACK_DISTANCE]
    greys = [grey / 255.0 for *_, grey in runs] + [BACK_GREY]
    return edge * np.concatenate([*faces, back]), np.repeat(greys, 2)


def module_runs(modules: np.ndarray) -> Iterator[Tuple[int, int, int, int]]:
    """Yields row, first column, end column (exclusive) and grey level of each run of equal modules."""
    for row, line in enumerate(modules):
        bounds = [0, *(np.flatnonzero(np.diff(line.astype(int))) + 1), len(line)]
        for left, right in zip(bounds, bounds[1:]):
            yield row, left, right, int(line[left])


def _quad(left: float, bottom: float, right: float, top: float, shift: float) -> np.ndarray:
    """Returns (6, 3) corners of two triangles, counter-clockwise as seen from +z, shifted along x."""
    a, b, c, d = (left, bottom, 0.0), (right, bottom, 0.0), (right, top, 0.0), (left, top, 0.0)
    return np.array([a, b, c, a, c, d]) + [shift, 0.0, 0.0]
