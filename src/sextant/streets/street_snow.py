# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Snow on the uprights of a simulated street; season winter has some, season snow has much of it."""

from typing import List, Sequence, Tuple

import cv2
import numpy as np

from sextant.streets.street_surface import SNOW, TEXELS, rough_noise, smooth_noise

DEPTH = {"winter": 3, "snow": 8}  # of the snow on branches, texels
ROOF = {"winter": 1.8, "snow": 4.0}  # mean cover of roofs; 1: fully covered, less the random part


def on_roof(rng: np.random.Generator, roof: np.ndarray, season: str) -> None:
    """Adds snow where it has not slid off, in place."""
    rows, columns = roof.shape
    slid = smooth_noise(rng, rows, columns, 2 * TEXELS) + 0.4 * smooth_noise(rng, rows, columns, 0.1 * TEXELS)
    lying = np.clip(ROOF[season] + 1.5 * slid - 0.5 * np.linspace(0, 1, rows)[:, None], 0, 1)
    roof += lying * (SNOW + 4 * rough_noise(rng, rows, columns) - roof)


def on_ledges(
    rng: np.random.Generator, grey: np.ndarray, ledges: Sequence[Tuple[int, int, int]], depth: float
) -> None:
    """Adds heaps on ledges, in place.

    :param ledges: left end, right end and row of each, texels
    :param depth: mean depth, metres
    """
    for left, right, y in ledges:
        x = np.linspace(left, right, max(2, (right - left) // 8))
        heap = depth * TEXELS * rng.uniform(0.6, 1.4, len(x))
        heap *= np.sin(np.linspace(0.2, np.pi - 0.2, len(x))) ** 0.4  # slides off at the ends
        outline = np.vstack([np.c_[x, y - heap], [(right, y), (left, y)]])
        cv2.fillPoly(grey, [outline.astype(np.int32)], SNOW + float(rng.uniform(-12, 8)))


def at_foot(rng: np.random.Generator, grey: np.ndarray) -> None:
    """Adds a drift along the foot of a wall, in place."""
    rows, columns = grey.shape
    drift = 0.35 + 0.2 * smooth_noise(rng, 4, columns, 1.2 * TEXELS)[0]
    drift += 0.03 * smooth_noise(rng, 4, columns, 0.15 * TEXELS)[0]
    depth = np.clip(drift, 0.05, 1.2) * TEXELS
    below = np.clip(np.arange(rows)[:, None] - (rows - depth), 0, 8) / np.float32(8)
    grey += (below * (SNOW - 10 + 5 * rough_noise(rng, rows, columns) - grey)).astype(np.float32)


def on_outline(grey: np.ndarray, mask: np.ndarray, depth: int) -> None:
    """Adds snow on top of everything that is opaque, in place; depth: texels."""
    grey[cv2.subtract(mask, np.roll(mask, depth, axis=0)) > 0] = SNOW


def ledges_of(boxes: Sequence[Tuple[int, int, int, int]], bar: int) -> List[Tuple[int, int, int]]:
    """Sills of windows (left, top, right, bottom), whose frames are `bar` texels wide."""
    return [(left - bar, right + bar, bottom + bar) for left, _, right, bottom in boxes]
