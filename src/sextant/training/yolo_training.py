# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Teaches a YoloNetwork on pictures whose objects are known. Needs PyTorch."""

import copy
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import List, Tuple

import numpy as np
import torch
from torch import Tensor, nn
from tqdm import tqdm

from sextant.base.atomic_file import atomic_file
from sextant.base.strict_params import StrictParams, param, within
from sextant.objects.letter_box import GREY
from sextant.training.object_pictures import PictureSet
from sextant.training.yolo_loss import Targets, YoloLoss
from sextant.training.yolo_network import YoloNetwork

LEAST_SIDE = 3.0  # pixels of a box; of smaller ones it is no matter whether they are told
WARM_UP, LAST_RATE = 300, 0.02  # batches; share of the learning rate that is left at the end
MOST_CHANGE = 10.0  # of the gradient's norm
KEPT = 0.3  # share of an object that has to be in a changed picture for it to be told there


@dataclass(frozen=True)
class TrainingParams(StrictParams):
    """How long, and how pictures are changed each time they are shown."""

    epochs: int = param(15, within(1, 10000))  # times that every picture is shown
    batch: int = param(16, within(1, 1024))  # pictures
    rate: float = param(2e-3, within(1e-9, 1))  # the highest learning rate
    decay: float = param(0.02, within(0, 1))  # of weights
    average: float = param(0.998, within(0, 1))  # of weights from batch to batch, in those that are kept
    zoom: float = param(0.3, within(0, 0.95))  # share by which a picture becomes larger or smaller
    shift: float = param(0.15, within(0, 1))  # of its side
    light: float = param(0.35, within(0, 1))  # share by which brightness and contrast change
    tint: float = param(0.08, within(0, 1))  # share by which a colour's channel changes
    noise: float = param(0.03, within(0, 1))  # of the range
    seed: int = param(0, within(0, 2**31 - 1))


def train(
    pictures: PictureSet, classes: int, params: TrainingParams, checkpoint: Path, progress: str = ""
) -> YoloNetwork:
    """The network that was learnt, ready to be used.

    :param checkpoint: written after each epoch; where it is there, training goes on from it
    :raises OSError: it cannot be read or written
    :raises ValueError: a setting out of range, or the checkpoint is of another training
    """
    torch.manual_seed(params.seed)
    state = _State(pictures, classes, params)
    state.load(checkpoint)
    for epoch in range(state.epoch, params.epochs):
        loss = state.show_all(epoch, progress)
        state.save(checkpoint)
        if progress:
            print(f"epoch {epoch + 1} of {params.epochs}: loss {loss:.3f}", flush=True)
    return state.kept.eval()


class _State:
    """Of a training."""

    def __init__(self, pictures: PictureSet, classes: int, params: TrainingParams):
        self._pictures, self._params = pictures, params
        self._network = YoloNetwork(classes).to(memory_format=torch.channels_last)
        self._loss = YoloLoss(pictures.images.shape[1], classes)
        self.kept = copy.deepcopy(self._network).requires_grad_(False)  # averaged
        self._optimizer = torch.optim.AdamW(_groups(self._network, params.decay), params.rate)
        self._steps = math.ceil(len(pictures.images) / params.batch)
        self.epoch = 0
        pictures_of = dict(zip(("pictures", "size"), pictures.images.shape))
        # A checkpoint is of one training. As text: PyTorch reads no real numbers without running a file.
        self._about = {name: str(value) for name, value in {**asdict(params), **pictures_of}.items()}

    def show_all(self, epoch: int, progress: str) -> float:
        """Every picture once; the mean loss."""
        random = np.random.default_rng([self._params.seed, epoch])
        order, batch, losses = random.permutation(len(self._pictures.images)), self._params.batch, []
        self._network.train()
        for step in tqdm(range(self._steps), disable=None if progress else True, desc=progress):
            chosen = _chosen(self._pictures, order[step * batch :][:batch])
            losses.append(self._learn(chosen, random, epoch * self._steps + step))
        self.epoch = epoch + 1
        return float(np.mean(losses))

    def _learn(self, pictures: PictureSet, random: np.random.Generator, step: int) -> float:
        """From one batch; its loss."""
        for group in self._optimizer.param_groups:
            group["lr"] = self._rate(step)
        images, targets = changed(pictures, self._params, random)
        loss = self._loss(self._network(images), targets)
        self._optimizer.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(self._network.parameters(), MOST_CHANGE)
        self._optimizer.step()
        self._keep(step)
        return loss.item()

    def _rate(self, step: int) -> float:
        """It grows, and then falls as a cosine (Loshchilov and Hutter 2017, "SGDR")."""
        share = step / (self._params.epochs * self._steps)
        fall = LAST_RATE + (1.0 - LAST_RATE) * 0.5 * (1.0 + math.cos(math.pi * share))
        return self._params.rate * fall * min(1.0, (step + 1) / WARM_UP)

    def _keep(self, step: int) -> None:
        share = min(self._params.average, (1 + step) / (10 + step))
        for kept, now in zip(self.kept.state_dict().values(), self._network.state_dict().values()):
            if kept.dtype.is_floating_point:
                kept.mul_(share).add_(now.detach(), alpha=1.0 - share)
            else:
                kept.copy_(now)

    def save(self, path: Path) -> None:
        """Everything that is needed to go on, as tensors, whole numbers and text."""
        saved = {
            "network": self._network.state_dict(),
            "kept": self.kept.state_dict(),
            "moments": self._optimizer.state_dict()["state"],
            "epoch": self.epoch,
            "about": self._about,
        }
        with atomic_file(path, "wb") as file:
            torch.save(saved, file)

    def load(self, path: Path) -> None:
        """Nothing, where it is not there. Nothing that is in it is run."""
        if not path.exists():
            return
        try:
            saved = torch.load(path, weights_only=True)
            other = [name for name, value in self._about.items() if saved["about"][name] != value]
            self._network.load_state_dict(saved["network"])
            self.kept.load_state_dict(saved["kept"])
            self._optimizer.load_state_dict({**self._optimizer.state_dict(), "state": saved["moments"]})
            self.epoch = int(saved["epoch"])
        except OSError:
            raise
        except Exception as error:  # what is no checkpoint raises nearly anything
            raise ValueError(f"{path}: is of no such training, remove it: {error}") from None
        if other:
            raise ValueError(f"{path}: is of a training with another {', '.join(other)}: take another folder")


def _groups(network: nn.Module, decay: float) -> List[dict]:
    """Only weights of convolutions decay."""
    shrink = [each for each in network.parameters() if each.ndim > 1]
    keep = [each for each in network.parameters() if each.ndim <= 1]
    return [{"params": shrink, "weight_decay": decay}, {"params": keep, "weight_decay": 0.0}]


def _chosen(pictures: PictureSet, which: np.ndarray) -> PictureSet:
    return PictureSet(*(each[which] for each in pictures))


def changed(
    pictures: PictureSet, params: TrainingParams, random: np.random.Generator
) -> Tuple[Tensor, Targets]:
    """Mirrored, moved, larger or smaller, in another light; float (n, 3, size, size) in [0, 1]."""
    count, size = len(pictures.images), pictures.images.shape[1]
    images = torch.from_numpy(pictures.images).permute(0, 3, 1, 2).float() / 255.0
    zoom = np.exp(random.uniform(np.log(1.0 - params.zoom), np.log(1.0 + params.zoom), count))
    mirror = np.where(random.random(count) < 0.5, -1.0, 1.0)
    shift = random.uniform(-params.shift, params.shift, (count, 2)) * size
    images = _moved(images, zoom, mirror, shift)
    boxes, inside = _moved_boxes(pictures.boxes, zoom, mirror, shift, size)
    targets = Targets(
        torch.from_numpy(boxes).float(), torch.from_numpy(pictures.classes).long(),
        torch.from_numpy(pictures.exists & (inside > 0.0)),
        torch.from_numpy(pictures.counts & _is_enough(boxes, inside)),
    )  # fmt: skip
    return _lit(images, params, random), targets


def _moved(images: Tensor, zoom: np.ndarray, mirror: np.ndarray, shift: np.ndarray) -> Tensor:
    """Grey where there was no picture."""
    count, size = len(images), images.shape[-1]
    matrix = np.zeros((count, 2, 3))
    matrix[:, 0, 0], matrix[:, 1, 1] = mirror / zoom, 1.0 / zoom
    matrix[:, 0, 2] = -mirror * shift[:, 0] / zoom * 2.0 / size
    matrix[:, 1, 2] = -shift[:, 1] / zoom * 2.0 / size
    grid = nn.functional.affine_grid(
        torch.from_numpy(matrix).float(), list(images.shape), align_corners=False
    )
    grey = GREY / 255.0
    return nn.functional.grid_sample(images - grey, grid, align_corners=False) + grey


def _moved_boxes(
    boxes: np.ndarray, zoom: np.ndarray, mirror: np.ndarray, shift: np.ndarray, size: int
) -> Tuple[np.ndarray, np.ndarray]:
    """Cut at the borders, and the share of each that is left (n, most)."""
    middle = 0.5 * size
    scale = np.stack([mirror * zoom, zoom], axis=1)[:, np.newaxis]
    ends = [
        (part - middle) * scale + middle + shift[:, np.newaxis] for part in (boxes[..., :2], boxes[..., 2:])
    ]
    moved = np.concatenate([np.minimum(*ends), np.maximum(*ends)], axis=-1)
    cut = np.clip(moved, 0.0, size)
    areas = [np.prod(each[..., 2:] - each[..., :2], axis=-1) for each in (cut, moved)]
    return cut, areas[0] / np.maximum(areas[1], 1e-9)


def _is_enough(boxes: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """(n, most) whether what is left of an object should be found."""
    return (inside >= KEPT) & ((boxes[..., 2:] - boxes[..., :2]).min(axis=-1) >= LEAST_SIDE)


def _lit(images: Tensor, params: TrainingParams, random: np.random.Generator) -> Tensor:
    """Brightness, contrast, tint, noise."""
    count = len(images)
    bright = np.exp(random.uniform(-params.light, params.light, (count, 1, 1, 1)))
    contrast = np.exp(random.uniform(-params.light, params.light, (count, 1, 1, 1)))
    tint = np.exp(random.uniform(-params.tint, params.tint, (count, 3, 1, 1)))
    mean = images.mean((1, 2, 3), keepdim=True)
    images = (images - mean) * torch.from_numpy(contrast).float() + mean
    images = images * torch.from_numpy(bright * tint).float()
    sigma = torch.from_numpy(random.uniform(0.0, params.noise, (count, 1, 1, 1))).float()
    return (images + sigma * torch.randn_like(images)).clamp(0.0, 1.0)
