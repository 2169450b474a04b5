# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A small detection network with the outputs of the YOLOv8 and YOLO11 families, cut before decoding.

Cross-stage partial blocks (Wang et al. 2020, "CSPNet"), pyramid pooling (He et al. 2015), a path aggregation
network over three grids (Liu et al. 2018) and anchor-free heads, separate for boxes and classes (Tian et al.
2019, "FCOS"), with distances as distributions (Li et al. 2020, "Generalized focal loss"). Needs PyTorch.
"""

import math
from typing import Tuple

import torch
from torch import Tensor, nn

from sextant.objects.yolo_output import BINS

# Number of channels after each halving of the image, and in the heads
WIDTHS = {"small": ((28, 56, 80, 80, 80), 48), "large": ((32, 64, 112, 144, 144), 64)}
PRIOR_SCORE = 0.01  # initial score of a class


class Conv(nn.Sequential):
    """Convolution, batch normalization, SiLU activation."""

    def __init__(self, channels_in: int, channels_out: int, size: int = 1, stride: int = 1, groups: int = 1):
        super().__init__(
            nn.Conv2d(channels_in, channels_out, size, stride, size // 2, groups=groups, bias=False),
            nn.BatchNorm2d(channels_out),
            nn.SiLU(),
        )


class Block(nn.Module):
    """Cross-stage partial block: half of the channels pass residual convolutions; joins all stages."""

    def __init__(self, channels_in: int, channels_out: int, pairs: int = 1):
        super().__init__()
        half = channels_out // 2
        self.aside, self.first = Conv(channels_in, half), Conv(channels_in, half)
        self.pairs = nn.ModuleList(
            nn.Sequential(Conv(half, half, 3), Conv(half, half, 3)) for _ in range(pairs)
        )
        self.join = Conv((2 + pairs) * half, channels_out)

    def forward(self, x: Tensor) -> Tensor:
        parts = [self.aside(x), self.first(x)]
        for pair in self.pairs:
            parts.append(parts[-1] + pair(parts[-1]))
        return self.join(torch.cat(parts, 1))


class Pooling(nn.Module):
    """Spatial pyramid pooling."""

    def __init__(self, channels: int):
        super().__init__()
        self.before = Conv(channels, channels // 2)
        self.pool = nn.MaxPool2d(5, 1, 2)
        self.after = Conv(2 * channels, channels)

    def forward(self, x: Tensor) -> Tensor:
        parts = [self.before(x)]
        for _ in range(3):
            parts.append(self.pool(parts[-1]))
        return self.after(torch.cat(parts, 1))


def _box_head(channels: int, head: int) -> nn.Sequential:
    """Distributions of the distances to the sides of the boxes, of one grid."""
    last = nn.Conv2d(head, 4 * BINS, 1)
    with torch.no_grad():
        last.bias.copy_(-0.5 * torch.arange(BINS).repeat(4))  # most objects are small
    return nn.Sequential(Conv(channels, head, 3), Conv(head, head, 3), last)


def _score_head(channels: int, head: int, classes: int) -> nn.Sequential:
    """Scores of the classes, of one grid."""
    last = nn.Conv2d(head, classes, 1)
    nn.init.constant_(last.bias, math.log(PRIOR_SCORE / (1.0 - PRIOR_SCORE)))
    return nn.Sequential(
        Conv(channels, channels, 3, groups=channels), Conv(channels, head),
        Conv(head, head, 3, groups=head), Conv(head, head), last,
    )  # fmt: skip


class YoloNetwork(nn.Module):
    """Maps RGB (n, 3, height, width) in [0, 1] to (n, 4 * BINS + classes, predictions), finest grid first."""

    def __init__(self, classes: int, kind: str = "small"):
        """:param kind: a name in WIDTHS"""
        super().__init__()
        (a, b, c, d, e), head = WIDTHS[kind]
        self.stem = nn.Sequential(Conv(3, a, 3, 2), Conv(a, b, 3, 2), Block(b, b))
        self.fine = nn.Sequential(Conv(b, c, 3, 2), Block(c, c, 2))
        self.middle = nn.Sequential(Conv(c, d, 3, 2), Block(d, d, 2))
        self.coarse = nn.Sequential(Conv(d, e, 3, 2), Block(e, e), Pooling(e))
        self.up = nn.Upsample(scale_factor=2.0, mode="nearest")
        self.down_middle, self.down_fine = Block(e + d, d), Block(d + c, c)
        self.halve_fine, self.halve_middle = Conv(c, c, 3, 2), Conv(d, d, 3, 2)
        self.up_middle, self.up_coarse = Block(c + d, d), Block(d + e, e)
        # Named as in the exports of the YOLO families, so that sextant.objects.yolo_heads finds them.
        self.cv2 = nn.ModuleList(_box_head(width, head) for width in (c, d, e))
        self.cv3 = nn.ModuleList(_score_head(width, head, classes) for width in (c, d, e))

    def forward(self, x: Tensor) -> Tensor:
        parts = zip(self.cv2, self.cv3, self._grids(x))
        return torch.cat([torch.cat([box(grid), score(grid)], 1).flatten(2) for box, score, grid in parts], 2)

    def _grids(self, x: Tensor) -> Tuple[Tensor, Tensor, Tensor]:
        """Features of the fine, middle and coarse grid: down the pyramid, then up again."""
        fine = self.fine(self.stem(x))
        middle = self.middle(fine)
        coarse = self.coarse(middle)
        middle = self.down_middle(torch.cat([self.up(coarse), middle], 1))
        fine = self.down_fine(torch.cat([self.up(middle), fine], 1))
        middle = self.up_middle(torch.cat([self.halve_fine(fine), middle], 1))
        return fine, middle, self.up_coarse(torch.cat([self.halve_middle(middle), coarse], 1))
