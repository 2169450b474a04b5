# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Shape of markers printed true to size."""

from dataclasses import dataclass
from typing import List

import numpy as np

import sextant
from sextant.markers.marker_mesh import module_runs
from sextant.printing.print_layout import MIN_SIZE
from sextant.printing.print_page import Box

MAX_SIZE = 10.0  # metres


@dataclass(frozen=True)
class MarkerShape:
    """Dimensions of the markers of a family, in modules."""

    width_at_border: int  # edge length between the detected corners, which is the marker's size
    outside: int  # modules outside of it on each side; some AprilTag families have them

    @property
    def total_width(self) -> int:
        """Total edge length, modules."""
        return self.width_at_border + 2 * self.outside

    @property
    def measured(self) -> str:
        """Describes what the size of a marker measures."""
        return (
            "square edge between the black and the white frame"
            if self.outside
            else "outer edge of the black square"
        )


def marker_shape(family: str) -> MarkerShape:
    """Returns the dimensions of the markers of a family.

    :raises ValueError: unknown family; lists the known families
    """
    modules, begin, end = sextant.marker_image(family, 0)
    rim = np.concatenate([modules[0], modules[-1], modules[:, 0], modules[:, -1]])
    # A white rim in the image from libapriltag is a quiet zone, not a part of the marker.
    return MarkerShape(end - begin, 0 if np.all(rim == 255) else begin)


def check_size(size: float) -> None:
    """Checks the edge length of a marker, metres.

    :raises ValueError: it is out of range
    """
    if not MIN_SIZE <= size <= MAX_SIZE:
        raise ValueError(f"size is {size} m, allowed is [{MIN_SIZE}, {MAX_SIZE}]")


def black_boxes(family: str, id: int, size: float, x: float, y: float) -> List[Box]:
    """Returns the runs of black modules of an upright marker centred at (x, y); metres.

    :param size: edge length in metres, between the detected corners
    :raises ValueError: unknown family or id
    """
    modules, begin, end = sextant.marker_image(family, id)
    edges = (np.arange(len(modules) + 1) - 0.5 * (begin + end)) * (size / (end - begin))
    return [
        (x + edges[left], y - edges[row + 1], x + edges[right], y - edges[row])
        for row, left, right, grey in module_runs(modules)
        if grey == 0
    ]
