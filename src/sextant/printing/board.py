# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A printed marker as coloured triangles, in its true size and with its real modules."""

from typing import Iterator, Tuple

import numpy as np

import sextant

QUIET_MODULES = 1  # white rim of the board, in modules
BACK_GREY = 0.45
BACK_DISTANCE = 0.1  # behind the front, in modules, so that the two do not flicker


def board_triangles(family: str, id: int, size: float) -> Tuple[np.ndarray, np.ndarray]:
    """The board of a marker: its modules, a white rim around them, and a grey back.

    :param size: edge length in metres, between the corners that a detector reports
    :returns: (3N, 3) corners of N triangles in the marker frame in metres, counter-clockwise as seen from the
        front (from behind for the back), and (N,) their grey levels, 0 black to 1 white
    :raises ValueError: an unknown family, or an id that it does not have
    """
    modules, begin, end = sextant.marker_image(family, id)
    modules = np.pad(modules, QUIET_MODULES, constant_values=255)
    edge = size / (end - begin)
    middle = 0.5 * (begin + end) + QUIET_MODULES
    runs = list(_runs(modules))
    faces = [_quad(left, middle - row - 1, right, middle - row, -middle) for row, left, right, _ in runs]
    back = _quad(0, middle - len(modules), len(modules), middle, -middle)[::-1] - [0.0, 0.0, BACK_DISTANCE]
    greys = [grey / 255.0 for *_, grey in runs] + [BACK_GREY]
    return edge * np.concatenate([*faces, back]), np.repeat(greys, 2)


def _runs(modules: np.ndarray) -> Iterator[Tuple[int, int, int, int]]:
    """Row, first column, one past the last column and grey level of each run of equal modules."""
    for row, line in enumerate(modules):
        bounds = [0, *(np.flatnonzero(np.diff(line.astype(int))) + 1), len(line)]
        for left, right in zip(bounds, bounds[1:]):
            yield row, left, right, int(line[left])


def _quad(left: float, bottom: float, right: float, top: float, shift: float) -> np.ndarray:
    """(6, 3) two triangles, counter-clockwise as seen from +z, moved along x."""
    a, b, c, d = (left, bottom, 0.0), (right, bottom, 0.0), (right, top, 0.0), (left, top, 0.0)
    return np.array([a, b, c, a, c, d]) + [shift, 0.0, 0.0]
