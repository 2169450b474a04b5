# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Training loss of the detection network with task-aligned label assignment. Needs PyTorch."""

import math
from typing import NamedTuple, Tuple

import torch
from torch import Tensor
from torch.nn import functional

from sextant.objects.yolo_output import BINS, cell_middles

MAX_POSITIVES = 10  # maximum number of predictions assigned to one object
# Exponents of the alignment metric: Feng et al. 2021, "TOOD", equation 6 (alpha and beta, there 1 and 6).
SCORE_POWER, OVERLAP_POWER = 0.5, 6.0
BOX, CLASS, DISTRIBUTION = 6.0, 1.0, 1.0  # weights of the losses
EPSILON = 1e-9  # avoids division by zero


class Targets(NamedTuple):
    """Ground truth of a batch of n images, padded to the same number of objects (most) per image."""

    boxes: Tensor  # (n, most, 4) left, top, right, bottom, pixels
    classes: Tensor  # (n, most)
    exists: Tensor  # (n, most) bool
    is_counted: Tensor  # (n, most) bool; predictions of the other objects are ignored


class YoloLoss:
    """Sum of the classification, box (CIoU) and distribution focal losses for one input size."""

    def __init__(self, size: int, classes: int):
        """:param size: side of the network's input, pixels"""
        middles, strides = cell_middles((size, size))
        self._middles = torch.tensor(middles, dtype=torch.float32)
        self._strides = torch.tensor(strides, dtype=torch.float32)
        self._classes = classes
        self._bins = torch.arange(BINS, dtype=torch.float32)

    def __call__(self, predicted: Tensor, targets: Targets) -> Tensor:
        """Computes the loss.

        :param predicted: (n, 4 * BINS + classes, predictions) of YoloNetwork
        """
        raw = predicted.permute(0, 2, 1)
        weights, scores = raw[..., : 4 * BINS].unflatten(-1, (4, BINS)), raw[..., 4 * BINS :]
        boxes = self._boxes(weights)
        with torch.no_grad():
            assigned, wanted, ignored = self._assigned(boxes, scores.sigmoid(), targets)
        cross = functional.binary_cross_entropy_with_logits(scores, wanted, reduction="none")
        total = wanted.sum().clamp(min=1.0)
        loss = CLASS * (cross * ~ignored[..., None]).sum() / total
        is_positive = assigned >= 0
        if is_positive.any():
            image, place = is_positive.nonzero(as_tuple=True)
            true = targets.boxes[image, assigned[image, place]]
            share = wanted[image, place].sum(-1)
            loss = loss + BOX * ((1.0 - ciou(boxes[image, place], true)) * share).sum() / total
            distribution = self._distribution_loss(weights[image, place], true, place)
            loss = loss + DISTRIBUTION * (distribution * share).sum() / total
        return loss

    def _boxes(self, weights: Tensor) -> Tensor:
        """Corners (n, predictions, 4) from weights (n, predictions, 4, BINS)."""
        reach = (weights.softmax(-1) @ self._bins) * self._strides[:, None]
        return torch.cat([self._middles - reach[..., :2], self._middles + reach[..., 2:]], -1)

    def _distribution_loss(self, weights: Tensor, true: Tensor, place: Tensor) -> Tensor:
        """Cross entropy (k,) of the two bins next to each true distance, for weights (k, 4, BINS)."""
        middles, strides = self._middles[place], self._strides[place, None]
        reach = torch.cat([middles - true[:, :2], true[:, 2:] - middles], 1) / strides
        reach = reach.clamp(0.0, BINS - 1.01)
        below = reach.floor().long()
        logs = weights.log_softmax(-1)
        share = reach - below
        low = logs.gather(-1, below[..., None])[..., 0]
        high = logs.gather(-1, below[..., None] + 1)[..., 0]
        return -((1.0 - share) * low + share * high).mean(-1)

    def _assigned(self, boxes: Tensor, scores: Tensor, targets: Targets) -> Tuple[Tensor, Tensor, Tensor]:
        """Assigns predictions to objects.

        :returns: for each prediction the index of its object (-1: none), its target scores (n, predictions,
            classes), and whether its scores are ignored
        """
        inside = self._candidates(targets)  # (n, most, predictions)
        overlaps = overlap(targets.boxes[:, :, None], boxes[:, None]).clamp(min=0.0) * inside
        index = targets.classes[:, :, None].expand(-1, -1, boxes.shape[1])
        likely = scores.permute(0, 2, 1).gather(1, index)
        aligned = likely.pow(SCORE_POWER) * overlaps.pow(OVERLAP_POWER) * inside
        count = min(MAX_POSITIVES, boxes.shape[1])
        best = aligned.topk(count, -1)
        chosen = torch.zeros_like(aligned).scatter_(-1, best.indices, 1.0) * (aligned > EPSILON * EPSILON)
        # A prediction is assigned to the object that it overlaps most.
        owner = (chosen * (overlaps + EPSILON)).max(1)
        predicted = owner.values > 0.0
        assigned = torch.where(predicted, owner.indices, torch.full_like(owner.indices, -1))
        matched = torch.zeros_like(aligned).scatter_(1, owner.indices[:, None], 1.0) * predicted[:, None]
        aligned = aligned * matched
        strongest = aligned.amax(-1, keepdim=True)
        most = (overlaps * matched).amax(-1, keepdim=True)
        level = (aligned / (strongest + EPSILON * EPSILON) * most).amax(1)  # (n, predictions)
        classes = targets.classes.gather(1, owner.indices)
        wanted = functional.one_hot(classes, self._classes) * (level * predicted)[..., None]
        ignored = self._near_uncounted(targets) & ~predicted
        uncounted = ~targets.is_counted.gather(1, owner.indices) & predicted
        return (
            torch.where(uncounted, torch.full_like(assigned, -1), assigned),
            wanted * ~uncounted[..., None],
            ignored | uncounted,
        )

    def _candidates(self, targets: Targets) -> Tensor:
        """Whether (n, most, predictions) a cell's centre is in a box or half a cell around its centre."""
        middle = 0.5 * (targets.boxes[..., :2] + targets.boxes[..., 2:])
        half = 0.5 * (targets.boxes[..., 2:] - targets.boxes[..., :2])
        reach = torch.maximum(half[:, :, None], 0.5 * self._strides[:, None].expand(-1, 2))
        offset = (self._middles - middle[:, :, None]).abs()
        return ((offset <= reach).all(-1) & targets.exists[..., None]).float()

    def _near_uncounted(self, targets: Targets) -> Tensor:
        """Whether (n, predictions) a cell is a candidate of an object that does not count."""
        near = self._candidates(targets) * (~targets.is_counted)[..., None]
        return near.any(1)


def overlap(first: Tensor, second: Tensor) -> Tensor:
    """Intersection over union (...) of boxes (..., 4)."""
    low, high = torch.maximum(first[..., :2], second[..., :2]), torch.minimum(first[..., 2:], second[..., 2:])
    common = (high - low).clamp(min=0.0).prod(-1)
    areas = [(each[..., 2:] - each[..., :2]).clamp(min=0.0).prod(-1) for each in (first, second)]
    return common / (areas[0] + areas[1] - common + EPSILON)


def ciou(predicted: Tensor, true: Tensor) -> Tensor:
    """Complete intersection over union (k,) (Zheng et al. 2020, "Distance-IoU loss", equation 10)."""
    iou = overlap(predicted, true)
    around = torch.maximum(predicted[:, 2:], true[:, 2:]) - torch.minimum(predicted[:, :2], true[:, :2])
    between = 0.5 * (predicted[:, :2] + predicted[:, 2:] - true[:, :2] - true[:, 2:])
    sizes = [(each[:, 2:] - each[:, :2]).clamp(min=1e-3) for each in (predicted, true)]
    angles = [torch.atan(each[:, 0] / each[:, 1]) for each in sizes]
    shape = (2.0 / math.pi * (angles[0] - angles[1])) ** 2
    with torch.no_grad():
        weight = shape / (1.0 - iou + shape + 1e-7)
    return iou - between.pow(2).sum(-1) / (around.pow(2).sum(-1) + 1e-7) - weight * shape
