# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The black parts of a marker in its true size."""

from dataclasses import dataclass
from typing import List, Tuple

import numpy as np

import sextant
from sextant.printing.print_layout import SMALLEST
from sextant.printing.print_page import Box

LARGEST = 10.0  # metres


@dataclass(frozen=True)
class MarkerShape:
    """How far the prints of a family reach, in modules."""

    border: int  # what `size` measures
    outside: int  # beyond it on every side; some AprilTag families have modules there

    @property
    def reach(self) -> int:
        """Modules along an edge from the first that may be black to the last."""
        return self.border + 2 * self.outside

    @property
    def measured(self) -> str:
        """What `size` measures, for people."""
        return (
            "square between the black and the white frame"
            if self.outside
            else "outer edge of the black square"
        )


def marker_shape(family: str) -> MarkerShape:
    """:raises ValueError: lists the families where there is none of the name."""
    modules, begin, end = sextant.marker_image(family, 0)
    rim = np.concatenate([modules[0], modules[-1], modules[:, 0], modules[:, -1]])
    # Where libapriltag's picture has a white rim, that is a quiet zone and not a part of the marker.
    return MarkerShape(end - begin, 0 if np.all(rim == 255) else begin)


def check_size(size: float) -> None:
    """:raises ValueError: it is no size of a marker."""
    if not SMALLEST <= size <= LARGEST:
        raise ValueError(f"size is {size} m, allowed is [{SMALLEST}, {LARGEST}]")


def black_boxes(family: str, id: int, size: float, x: float, y: float) -> List[Box]:
    """The runs of black modules of a marker with its middle at (x, y), upright; metres.

    :param size: edge length in metres, between the corners that a detector reports
    :raises ValueError: an unknown family, or an id that it does not have
    """
    modules, begin, end = sextant.marker_image(family, id)
    edges = (np.arange(len(modules) + 1) - 0.5 * (begin + end)) * (size / (end - begin))
    return [
        (x + edges[left], y - edges[row + 1], x + edges[right], y - edges[row])
        for row, line in enumerate(modules)
        for left, right in _black_runs(line)
    ]


def _black_runs(line: np.ndarray) -> List[Tuple[int, int]]:
    """First column and one past the last one of each run of black modules."""
    changes = np.flatnonzero(np.diff(np.concatenate([[0], line < 128, [0]]).astype(int)))
    return list(zip(changes[::2], changes[1::2]))
