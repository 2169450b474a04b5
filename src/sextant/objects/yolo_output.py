# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Decoding of the outputs of YOLO networks to boxes, scores and classes.

A full export outputs (1, 4 + classes, predictions): centre, width and height in pixels, and final scores.
One that is cut before decoding outputs (1, 4 * BINS + classes, ...): for each prediction the distances from
the cell's centre to the left, top, right and bottom of the box, each a distribution over 0, 1, ... BINS - 1
cells before softmax (Li et al. 2020, "Generalized focal loss", distribution focal loss), and scores before
the sigmoid; for all grids together, for each grid, or boxes and scores in separate outputs. A network without
distributions outputs the distances themselves. An end-to-end export outputs a row (left, top, right, bottom,
score, class) for each selected object.
"""

from typing import Callable, Dict, List, NamedTuple, Sequence, Tuple

import numpy as np

from sextant.objects.detections import Detections

ROW = 6  # numbers of an object in an end-to-end export
STRIDES = (8, 16, 32)  # pixels of the input per cell of each grid
BINS = 16  # of a distance distribution, one cell each
SLACK = 1e-3  # by which rounding may move final scores out of [0, 1]


class HeadLayout(NamedTuple):
    """Channels of the joined outputs of a network's heads, in this order."""

    bins: int  # of each of the four distance distributions; 1: four distances
    classes: int  # number of classes
    angle: str = ""  # of the box, in one more channel: radians, or logits of [-45, 135] degrees; empty: none
    is_end_to_end: bool = (
        False  # whether an object has one prediction: one for each class above the threshold
    )


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
    if len(outputs) == 1 and outputs[0].ndim == 3 and outputs[0].shape[2] == ROW:
        return _of_rows(outputs[0][0], classes, threshold)
    found = joined(outputs, size, classes)
    if not np.isfinite(found).all():
        raise ValueError("outputs are not finite")
    box, raw = found[:-classes], found[-classes:]
    if len(box) > 4:
        return decoded_heads(found, size, HeadLayout(BINS, classes), threshold)
    _check_final(raw)
    which, best, scores = _selected(raw, threshold)
    return Detections(_corners(box[:, which].astype(np.float64)), np.clip(scores, 0.0, 1.0), best)


def decoded_heads(
    found: np.ndarray, size: Tuple[int, int], layout: HeadLayout, threshold: float
) -> Detections:
    """Decode the outputs of heads (channels, predictions), the finest grid first, as decoded().

    :raises ValueError: outputs that are not finite
    """
    if not np.isfinite(found).all():
        raise ValueError("outputs are not finite")
    box, raw, angle = np.split(found, np.cumsum([4 * layout.bins, layout.classes]))
    # Apply the threshold before the sigmoid, so that only few predictions are decoded.
    least = np.log(threshold / (1.0 - threshold))
    which, classes, logits = (_selected_of_each_class if layout.is_end_to_end else _selected)(raw, least)
    distances = _distances(box[:, which].astype(np.float64), layout.bins)
    middles, strides = (each[which] for each in cell_middles(size))
    boxes = _around(distances * strides, middles, _ANGLES[layout.angle](angle[:1, which]))
    return Detections(boxes, _sigmoid(logits), classes)


_ANGLES: Dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "": lambda channel: np.zeros(channel.shape[1]),
    "radians": lambda channel: channel[0].astype(np.float64),
    "logits": lambda channel: (_sigmoid(channel[0]) - 0.25) * np.pi,
}


def _selected(raw: np.ndarray, least: float) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Predictions whose highest score is at least this, with its class and score; the highest first."""
    best = raw.argmax(axis=0)
    score = np.take_along_axis(raw, best[np.newaxis], axis=0)[0].astype(np.float64)
    which = np.flatnonzero(score >= least)
    which = which[np.argsort(-score[which], kind="stable")]
    return which, best[which], score[which]


def _selected_of_each_class(raw: np.ndarray, least: float) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As _selected(), but a prediction may have several classes."""
    classes, which = np.nonzero(raw >= least)
    order = np.argsort(-raw[classes, which], kind="stable")
    classes, which = classes[order], which[order]
    return which, classes, raw[classes, which].astype(np.float64)


def _check_final(scores: np.ndarray) -> None:
    if scores.size and (scores.min() < -SLACK or scores.max() > 1.0 + SLACK):
        raise ValueError(
            f"outputs scores of {scores.min():.3g} to {scores.max():.3g}; a full export has scores in [0, 1]"
        )


def _of_rows(rows: np.ndarray, classes: int, threshold: float) -> Detections:
    """Detections from the rows (n, ROW) of an end-to-end export."""
    if not np.isfinite(rows).all():
        raise ValueError("outputs are not finite")
    _check_final(rows[:, 4])
    found = rows[rows[:, 4] >= threshold].astype(np.float64)
    found = found[np.argsort(-found[:, 4], kind="stable")]
    if np.any(found[:, 2:4] < found[:, :2]):
        raise ValueError("outputs rows whose right is left of left; export the network by a newer program")
    numbers = found[:, 5].astype(int)
    if np.any((numbers < 0) | (numbers >= classes)):
        raise ValueError(f"outputs class {numbers.max()}, there are {classes} classes")
    return Detections(found[:, :4], np.clip(found[:, 4], 0.0, 1.0), numbers)


def _sigmoid(values: np.ndarray) -> np.ndarray:
    return 1.0 / (1.0 + np.exp(-values.astype(np.float64)))


def _corners(box: np.ndarray) -> np.ndarray:
    """Corners (n, 4) from centre, width and height (4, n)."""
    middle, half = box[:2], 0.5 * box[2:]
    return np.vstack([middle - half, middle + half]).T


def _distances(box: np.ndarray, bins: int) -> np.ndarray:
    """Distances (4, n) in cells from the box channels (4 * bins, n) of predictions."""
    if bins == 1:
        return box
    weights = box.reshape(4, bins, -1)
    weights = np.exp(weights - weights.max(axis=1, keepdims=True))
    return np.einsum("kbn,b->kn", weights, np.arange(bins)) / weights.sum(axis=1)


def _around(distances: np.ndarray, middles: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Corners (n, 4) of upright boxes around boxes turned by angles (n,), radians from x to y.

    :param distances: (4, n) of the left, top, right and bottom side from the middles, along the box's axes
    :param middles: (n, 2)
    """
    low, high = distances[:2], distances[2:]
    cosine, sine = np.cos(angles), np.sin(angles)
    turn = np.array([[cosine, -sine], [sine, cosine]])
    centre = middles.T + np.einsum("ijn,jn->in", turn, 0.5 * (high - low))
    half = np.einsum("ijn,jn->in", np.abs(turn), 0.5 * (low + high))
    return np.vstack([centre - half, centre + half]).T


def cell_middles(size: Tuple[int, int]) -> Tuple[np.ndarray, np.ndarray]:
    """Centres (predictions, 2) and strides (predictions,) of all cells, row by row, the finest grid first."""
    middles: List[np.ndarray] = []
    strides: List[np.ndarray] = []
    for stride in STRIDES:
        y, x = np.mgrid[: size[1] // stride, : size[0] // stride]
        middles.append((np.stack([x, y], axis=-1).reshape(-1, 2) + 0.5) * stride)
        strides.append(np.full(x.size, float(stride)))
    return np.concatenate(middles), np.concatenate(strides)
