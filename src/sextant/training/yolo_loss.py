# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How wrong a network's boxes and scores are: which of its places should tell an object, and how.

Needs PyTorch."""

import math
from typing import NamedTuple, Tuple

import torch
from torch import Tensor
from torch.nn import functional

from sextant.objects.yolo_output import BINS, cell_middles

NEAREST = 10  # places that tell one object, at most
SCORE_POWER, OVERLAP_POWER = (
    0.5,
    6.0,
)  # of alignment: Feng et al. 2021, "TOOD", equation 6 (there alpha 1, beta 6)
BOX, CLASS, DISTRIBUTION = 6.0, 1.0, 1.0  # weights of the losses
TINY = 1e-9


class Targets(NamedTuple):
    """Of a batch: objects by picture, filled up with such as do not count."""

    boxes: Tensor  # (n, most, 4) left, top, right, bottom, pixels
    classes: Tensor  # (n, most)
    exists: Tensor  # (n, most) bool
    counts: Tensor  # (n, most) bool; of the others it is no matter whether they are told


class YoloLoss:
    """Of one input size."""

    def __init__(self, size: int, classes: int):
        """:param size: of the network's input, pixels a side"""
        middles, strides = cell_middles((size, size))
        self._middles = torch.tensor(middles, dtype=torch.float32)
        self._strides = torch.tensor(strides, dtype=torch.float32)
        self._classes = classes
        self._bins = torch.arange(BINS, dtype=torch.float32)

    def __call__(self, told: Tensor, targets: Targets) -> Tensor:
        """:param told: (n, 4 * BINS + classes, places) of YoloNetwork"""
        raw = told.permute(0, 2, 1)
        weights, scores = raw[..., : 4 * BINS].unflatten(-1, (4, BINS)), raw[..., 4 * BINS :]
        boxes = self._boxes(weights)
        with torch.no_grad():
            which, wanted, ignored = self._assigned(boxes, scores.sigmoid(), targets)
        cross = functional.binary_cross_entropy_with_logits(scores, wanted, reduction="none")
        total = wanted.sum().clamp(min=1.0)
        loss = CLASS * (cross * ~ignored[..., None]).sum() / total
        told_by = which >= 0
        if told_by.any():
            picture, place = told_by.nonzero(as_tuple=True)
            true = targets.boxes[picture, which[picture, place]]
            share = wanted[picture, place].sum(-1)
            loss = loss + BOX * ((1.0 - ciou(boxes[picture, place], true)) * share).sum() / total
            off = self._distribution_loss(weights[picture, place], true, place)
            loss = loss + DISTRIBUTION * (off * share).sum() / total
        return loss

    def _boxes(self, weights: Tensor) -> Tensor:
        """(n, places, 4) corners of weights (n, places, 4, BINS)."""
        reach = (weights.softmax(-1) @ self._bins) * self._strides[:, None]
        return torch.cat([self._middles - reach[..., :2], self._middles + reach[..., 2:]], -1)

    def _distribution_loss(self, weights: Tensor, true: Tensor, place: Tensor) -> Tensor:
        """(k,) cross entropy of the two bins beside each true distance, of weights (k, 4, BINS)."""
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
        """Of each place the object that it should tell (-1: none), the scores that it should have (n, places,
        classes), and whether they do not count."""
        inside = self._candidates(targets)  # (n, most, places)
        overlaps = overlap(targets.boxes[:, :, None], boxes[:, None]).clamp(min=0.0) * inside
        index = targets.classes[:, :, None].expand(-1, -1, boxes.shape[1])
        likely = scores.permute(0, 2, 1).gather(1, index)
        aligned = likely.pow(SCORE_POWER) * overlaps.pow(OVERLAP_POWER) * inside
        count = min(NEAREST, boxes.shape[1])
        best = aligned.topk(count, -1)
        chosen = torch.zeros_like(aligned).scatter_(-1, best.indices, 1.0) * (aligned > TINY * TINY)
        # A place tells the object that it overlaps most.
        owner = (chosen * (overlaps + TINY)).max(1)
        told = owner.values > 0.0
        which = torch.where(told, owner.indices, torch.full_like(owner.indices, -1))
        mine = torch.zeros_like(aligned).scatter_(1, owner.indices[:, None], 1.0) * told[:, None]
        aligned = aligned * mine
        strongest = aligned.amax(-1, keepdim=True)
        most = (overlaps * mine).amax(-1, keepdim=True)
        level = (aligned / (strongest + TINY * TINY) * most).amax(1)  # (n, places)
        classes = targets.classes.gather(1, owner.indices)
        wanted = functional.one_hot(classes, self._classes) * (level * told)[..., None]
        ignored = self._near_uncounted(targets) & ~told
        uncounted = ~targets.counts.gather(1, owner.indices) & told
        return (
            torch.where(uncounted, torch.full_like(which, -1), which),
            wanted * ~uncounted[..., None],
            ignored | uncounted,
        )

    def _candidates(self, targets: Targets) -> Tensor:
        """(n, most, places) whether a place's middle is in the box, or half a cell beside its middle."""
        middle = 0.5 * (targets.boxes[..., :2] + targets.boxes[..., 2:])
        half = 0.5 * (targets.boxes[..., 2:] - targets.boxes[..., :2])
        reach = torch.maximum(half[:, :, None], 0.5 * self._strides[:, None].expand(-1, 2))
        off = (self._middles - middle[:, :, None]).abs()
        return ((off <= reach).all(-1) & targets.exists[..., None]).float()

    def _near_uncounted(self, targets: Targets) -> Tensor:
        """(n, places)"""
        near = self._candidates(targets) * (~targets.counts)[..., None]
        return near.any(1)


def overlap(first: Tensor, second: Tensor) -> Tensor:
    """(...) intersection over union of boxes (..., 4)."""
    low, high = torch.maximum(first[..., :2], second[..., :2]), torch.minimum(first[..., 2:], second[..., 2:])
    common = (high - low).clamp(min=0.0).prod(-1)
    areas = [(each[..., 2:] - each[..., :2]).clamp(min=0.0).prod(-1) for each in (first, second)]
    return common / (areas[0] + areas[1] - common + TINY)


def ciou(told: Tensor, true: Tensor) -> Tensor:
    """(k,) complete intersection over union (Zheng et al. 2020, "Distance-IoU loss", equation 10)."""
    found = overlap(told, true)
    around = torch.maximum(told[:, 2:], true[:, 2:]) - torch.minimum(told[:, :2], true[:, :2])
    apart = 0.5 * (told[:, :2] + told[:, 2:] - true[:, :2] - true[:, 2:])
    sizes = [(each[:, 2:] - each[:, :2]).clamp(min=1e-3) for each in (told, true)]
    angles = [torch.atan(each[:, 0] / each[:, 1]) for each in sizes]
    shape = (2.0 / math.pi * (angles[0] - angles[1])) ** 2
    with torch.no_grad():
        weight = shape / (1.0 - found + shape + 1e-7)
    return found - apart.pow(2).sum(-1) / (around.pow(2).sum(-1) + 1e-7) - weight * shape
