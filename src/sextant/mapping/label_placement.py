# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Placement of labels in a drawing without overlaps."""

from typing import Dict, Hashable, List, Mapping, Tuple

import numpy as np
from matplotlib.axes import Axes

POINTS_PER_INCH = 72.0
WIDTH = 0.62  # of a character, in font sizes
HEIGHT = 1.0  # of a character, in font sizes
ANGLES = (0.0, 0.6, -0.6, 1.2, -1.2, 2.0, -2.0, np.pi)  # candidates, radians from the preferred direction
DISTANCES = (1.25, 2.2, 3.2)  # candidates from the point, in font sizes


def place_labels(
    axes: Axes,
    wanted: Mapping[Hashable, Tuple[np.ndarray, np.ndarray]],
    texts: Mapping[Hashable, str],
    font_size: float,
    drawn: np.ndarray,
) -> Dict[Hashable, np.ndarray]:
    """Places labels greedily where they overlap neither each other nor the drawing.

    :param axes: its limits must be final
    :param wanted: by key: (2,) labelled point and (2,) preferred direction of the label, data coordinates
    :param texts: labels by key
    :param font_size: points
    :param drawn: (N, 2) points in data coordinates to keep free
    :returns: by key: (2,) offset from the point to the centre of the label, points
    """
    per_point = axes.figure.dpi / POINTS_PER_INCH
    points = {key: axes.transData.transform(at) / per_point for key, (at, _) in wanted.items()}
    dot = 0.5 * font_size * np.ones(2)
    taken: List[Tuple[np.ndarray, np.ndarray]] = [
        (point, dot) for point in axes.transData.transform(drawn) / per_point
    ]
    placed = {}
    for key, (_, direction) in wanted.items():
        size = font_size * np.array([WIDTH * len(texts[key]), HEIGHT])
        offsets = _candidates(direction, font_size, size)
        free = [_overlap(points[key] + offset, size, taken) for offset in offsets]
        best = offsets[int(np.argmin(free))]
        taken.append((points[key] + best, size))
        placed[key] = best
    return placed


def _candidates(direction: np.ndarray, font_size: float, size: np.ndarray) -> List[np.ndarray]:
    """Returns offsets, the best first; long labels are placed farther to the side."""
    angle = np.arctan2(direction[1], direction[0])
    offsets = []
    for distance in DISTANCES:
        for turn in ANGLES:
            towards = np.array([np.cos(angle + turn), np.sin(angle + turn)])
            sideways = 0.5 * (size[0] - size[1]) * towards[0]
            offsets.append(distance * font_size * towards + [sideways, 0.0])
    return offsets


def _overlap(middle: np.ndarray, size: np.ndarray, taken: List[Tuple[np.ndarray, np.ndarray]]) -> float:
    """Returns the area of a box that overlaps the others, square points."""
    middles, sizes = (np.array(part) for part in zip(*taken))
    common = 0.5 * (size + sizes) - np.abs(middle - middles)
    return float(np.sum(np.prod(np.clip(common, 0.0, None), axis=1)))
