# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Decoding of the outputs of the YOLOv8 and YOLO11 families to boxes, scores and classes.

A full export outputs (1, 4 + classes, predictions): centre, width and height in pixels, and final scores.
One that is cut before decoding outputs (1, 4 * BINS + classes, ...): for each prediction the distances from
the cell's centre to the left, top, right and bottom of the box, each a distribution over 0, 1, ... BINS - 1
cells before softmax (Li et al. 2020, "Generalized focal loss", distribution focal loss), and scores before
the sigmoid; for all grids together, for each grid, or boxes and scores in separate outputs.
"""

from typing import Dict, List, Sequence, Tuple

import numpy as np

from sextant.objects.detections import Detections

STRIDES = (8, 16, 32)  # pixels of the input per cell of each grid
BINS = 16  # of a distance distribution, one cell each
SLACK = 1e-3  # by which rounding may move final scores out of [0, 1]


def prediction_count(size: Tuple[int, int]) -> int:
    """Number of predictions of a network. :param size: width and height of its input, pixels"""
    return sum((size[0] // stride) * (size[1] // stride) for stride in STRIDES)


def joined(outputs: Sequence[np.ndarray], size: Tuple[int, int], classes: int) -> np.ndarray:
    """Join outputs to (channels, predictions), finest grid first: 4 or 4 * BINS box channels, then classes.

    Outputs with the same number of predictions belong together, in either order. If the box has as many
    channels as there are classes, it comes first. Outputs of other shapes are ignored.

    :raises ValueError: the outputs do not match this input size and number of classes
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
        if found.shape == (box + classes, prediction_count(size)):
            return found
    raise ValueError(_mismatch(outputs, size, classes))


def _boxes_first(parts: List[np.ndarray], box: int, classes: int) -> np.ndarray:
    """(box + classes, cells); no cells if the channels do not match."""
    channels = [len(part) for part in parts]
    if channels in ([box + classes], [box, classes]):
        return np.concatenate(parts)
    return np.concatenate(parts[::-1]) if channels == [classes, box] else np.zeros((box + classes, 0))


def _mismatch(outputs: Sequence[np.ndarray], size: Tuple[int, int], classes: int) -> str:
    shapes = ", ".join("×".join(map(str, each.shape)) or "a number" for each in outputs)
    predictions = prediction_count(size)
    return (
        f"outputs {shapes}; {classes} classes and {size[0]}×{size[1]} pixels need "
        f"1×{4 + classes}×{predictions} (a full export) or 1×{4 * BINS + classes}×{predictions} "
        "in one or more outputs (cut before the boxes are decoded)"
    )


def decoded(
    outputs: Sequence[np.ndarray], size: Tuple[int, int], classes: int, threshold: float
) -> Detections:
    """Decode boxes in pixels of the input with scores from the threshold on, the highest score first.

    :raises ValueError: as joined(); outputs that are not finite; final scores outside [0, 1]
    """
    found = joined(outputs, size, classes)
    if not np.isfinite(found).all():
        raise ValueError("outputs are not finite")
    box, raw = found[:-classes], found[-classes:]
    final = len(box) == 4
    if final and (raw.min() < -SLACK or raw.max() > 1.0 + SLACK):
        raise ValueError(
            f"outputs scores of {raw.min():.3g} to {raw.max():.3g}; a full export has scores in [0, 1]"
        )
    # Apply the threshold before the sigmoid, so that only few predictions are decoded.
    least = threshold if final else np.log(threshold / (1.0 - threshold))
    best = raw.argmax(axis=0)
    score = np.take_along_axis(raw, best[np.newaxis], axis=0)[0].astype(np.float64)
    which = np.flatnonzero(score >= least)
    which = which[np.argsort(-score[which], kind="stable")]
    scores = np.clip(score[which], 0.0, 1.0) if final else 1.0 / (1.0 + np.exp(-score[which]))
    chosen = box[:, which].astype(np.float64)
    return Detections(_corners(chosen) if final else _decoded(chosen, which, size), scores, best[which])


def _corners(box: np.ndarray) -> np.ndarray:
    """Corners (n, 4) from centre, width and height (4, n)."""
    middle, half = box[:2], 0.5 * box[2:]
    return np.vstack([middle - half, middle + half]).T


def _decoded(box: np.ndarray, which: np.ndarray, size: Tuple[int, int]) -> np.ndarray:
    """Corners (n, 4) from the weights (4 * BINS, n) of the selected predictions."""
    weights = box.reshape(4, BINS, -1)
    weights = np.exp(weights - weights.max(axis=1, keepdims=True))
    cells = np.einsum("kbn,b->kn", weights, np.arange(BINS)) / weights.sum(axis=1)
    middles, strides = cell_middles(size)
    reach = cells * strides[which]
    x, y = middles[which].T
    return np.vstack([x - reach[0], y - reach[1], x + reach[2], y + reach[3]]).T


def cell_middles(size: Tuple[int, int]) -> Tuple[np.ndarray, np.ndarray]:
    """Centres (predictions, 2) and strides (predictions,) of all cells, row by row, the finest grid first."""
    middles: List[np.ndarray] = []
    strides: List[np.ndarray] = []
    for stride in STRIDES:
        y, x = np.mgrid[: size[1] // stride, : size[0] // stride]
        middles.append((np.stack([x, y], axis=-1).reshape(-1, 2) + 0.5) * stride)
        strides.append(np.full(x.size, float(stride)))
    return np.concatenate(middles), np.concatenate(strides)
