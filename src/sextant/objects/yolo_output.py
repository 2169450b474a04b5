# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a network of the YOLOv8 and YOLO11 families says, as boxes, scores and classes.

A full export says (1, 4 + classes, places): middle, width and height in pixels, and final scores. One that
is cut before the boxes are decoded says (1, 4 * BINS + classes, ...): for each place how far the box reaches
to the left, top, right and bottom, as weights of 0, 1, ... BINS - 1 cells before softmax (Li et al. 2020,
"Generalized focal loss", distribution focal loss), and scores before the sigmoid; of all places together, of
each grid, or boxes and scores apart.
"""

from typing import Dict, List, Sequence, Tuple

import numpy as np

from sextant.objects.detection import Detections

STRIDES = (8, 16, 32)  # pixels of the input that are a cell of each grid
BINS = 16  # of a distance, cells
SLACK = 1e-3  # of final scores, for rounding


def places_of(size: Tuple[int, int]) -> int:
    """How many boxes a network tells. :param size: width and height of its input, pixels"""
    return sum((size[0] // stride) * (size[1] // stride) for stride in STRIDES)


def joined(outputs: Sequence[np.ndarray], size: Tuple[int, int], classes: int) -> np.ndarray:
    """(channels, places), the finest grid first; 4 or 4 * BINS channels of the box, then the classes'.

    Outputs of as many places belong together, in either order; where the box has as many channels as there
    are classes, it comes first, as those networks have it. Outputs of other shapes do not matter.

    :raises ValueError: the outputs are not of such a network with so many classes
    """
    grids: Dict[int, List[np.ndarray]] = {}
    for each in outputs:
        part = (
            each.reshape(each.shape[1], -1) if each.ndim >= 3 and each.shape[0] == 1 else each.reshape(1, -1)
        )
        grids.setdefault(part.shape[1], []).append(part)
    for box in (4 * BINS, 4):
        parts = [_boxes_first(grids[cells], box, classes) for cells in sorted(grids, reverse=True)]
        found = np.concatenate(parts, axis=1)
        if found.shape == (box + classes, places_of(size)):
            return found
    raise ValueError(_not_such(outputs, size, classes))


def _boxes_first(parts: List[np.ndarray], box: int, classes: int) -> np.ndarray:
    """(box + classes, cells); no cells, if they are something else."""
    channels = [len(part) for part in parts]
    if channels in ([box + classes], [box, classes]):
        return np.concatenate(parts)
    return np.concatenate(parts[::-1]) if channels == [classes, box] else np.zeros((box + classes, 0))


def _not_such(outputs: Sequence[np.ndarray], size: Tuple[int, int], classes: int) -> str:
    shapes = ", ".join("×".join(map(str, each.shape)) or "a number" for each in outputs)
    places = places_of(size)
    return (
        f"says {shapes}; {classes} classes and {size[0]}×{size[1]} pixels need "
        f"1×{4 + classes}×{places} (a full export) or 1×{4 * BINS + classes}×{places} in one or more outputs "
        "(cut before the boxes are decoded)"
    )


def decoded(
    outputs: Sequence[np.ndarray], size: Tuple[int, int], classes: int, threshold: float
) -> Detections:
    """Boxes in pixels of the input whose best score reaches the threshold, the surest first.

    :raises ValueError: as joined(); or what the network says is no number, or no score
    """
    found = joined(outputs, size, classes)
    if not np.isfinite(found).all():
        raise ValueError("says what is no finite number")
    box, raw = found[:-classes], found[-classes:]
    final = len(box) == 4
    if final and (raw.min() < -SLACK or raw.max() > 1.0 + SLACK):
        raise ValueError(
            f"says scores of {raw.min():.3g} to {raw.max():.3g}; those of a full export are in [0, 1]"
        )
    # The threshold before the sigmoid: few places need more than a look.
    least = threshold if final else np.log(threshold / (1.0 - threshold))
    best = raw.argmax(axis=0)
    score = np.take_along_axis(raw, best[np.newaxis], axis=0)[0].astype(np.float64)
    which = np.flatnonzero(score >= least)
    which = which[np.argsort(-score[which], kind="stable")]
    scores = np.clip(score[which], 0.0, 1.0) if final else 1.0 / (1.0 + np.exp(-score[which]))
    chosen = box[:, which].astype(np.float64)
    return Detections(_corners(chosen) if final else _decoded(chosen, which, size), scores, best[which])


def _corners(box: np.ndarray) -> np.ndarray:
    """(n, 4) of middle, width and height (4, n)."""
    middle, half = box[:2], 0.5 * box[2:]
    return np.vstack([middle - half, middle + half]).T


def _decoded(box: np.ndarray, which: np.ndarray, size: Tuple[int, int]) -> np.ndarray:
    """(n, 4) of the weights (4 * BINS, n) of the places."""
    weights = box.reshape(4, BINS, -1)
    weights = np.exp(weights - weights.max(axis=1, keepdims=True))
    cells = np.einsum("kbn,b->kn", weights, np.arange(BINS)) / weights.sum(axis=1)
    middles, strides = cell_middles(size)
    reach = cells * strides[which]
    x, y = middles[which].T
    return np.vstack([x - reach[0], y - reach[1], x + reach[2], y + reach[3]]).T


def cell_middles(size: Tuple[int, int]) -> Tuple[np.ndarray, np.ndarray]:
    """(places, 2) x and y, and (places,) the stride, of every cell; row by row, the finest grid first."""
    middles: List[np.ndarray] = []
    strides: List[np.ndarray] = []
    for stride in STRIDES:
        y, x = np.mgrid[: size[1] // stride, : size[0] // stride]
        middles.append((np.stack([x, y], axis=-1).reshape(-1, 2) + 0.5) * stride)
        strides.append(np.full(x.size, float(stride)))
    return np.concatenate(middles), np.concatenate(strides)
