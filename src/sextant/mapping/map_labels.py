# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Room for names in a drawing."""

from typing import Dict, Hashable, List, Mapping, Tuple

import numpy as np
from matplotlib.axes import Axes

POINTS_PER_INCH = 72.0
WIDTH = 0.62  # of a character, in font sizes
HEIGHT = 1.0
TURNS = (0.0, 0.6, -0.6, 1.2, -1.2, 2.0, -2.0, np.pi)  # radians from where a name belongs
DISTANCES = (1.25, 2.2, 3.2)  # from its point, in font sizes


def place_labels(
    axes: Axes,
    wanted: Mapping[Hashable, Tuple[np.ndarray, np.ndarray]],
    texts: Mapping[Hashable, str],
    font_size: float,
    drawn: np.ndarray,
) -> Dict[Hashable, np.ndarray]:
    """Where names cover neither one another nor what is drawn: each takes the first place that is free.

    :param axes: with its limits as they stay
    :param wanted: of each: (2,) its point in data, (2,) the direction in which the name belongs
    :param font_size: points; drawn: (N, 2) points in data that are to stay free
    :returns: (2,) of each: from its point to the middle of its name, points
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
    """Offsets, the best first; a long name keeps farther off sideways."""
    angle = np.arctan2(direction[1], direction[0])
    offsets = []
    for distance in DISTANCES:
        for turn in TURNS:
            towards = np.array([np.cos(angle + turn), np.sin(angle + turn)])
            sideways = 0.5 * (size[0] - size[1]) * towards[0]
            offsets.append(distance * font_size * towards + [sideways, 0.0])
    return offsets


def _overlap(middle: np.ndarray, size: np.ndarray, taken: List[Tuple[np.ndarray, np.ndarray]]) -> float:
    """Area that a box has in common with others, square points."""
    middles, sizes = (np.array(part) for part in zip(*taken))
    common = 0.5 * (size + sizes) - np.abs(middle - middles)
    return float(np.sum(np.prod(np.clip(common, 0.0, None), axis=1)))
