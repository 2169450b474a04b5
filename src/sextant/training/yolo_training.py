# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Training of a YoloNetwork on images with ground truth. Needs PyTorch."""

import copy
import math
import zlib
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Dict, List, Optional, Tuple

import numpy as np
import torch
from torch import Tensor, nn
from tqdm import tqdm

from sextant.base.atomic_file import atomic_file
from sextant.base.strict_params import StrictParams, one_of, param, within
from sextant.objects.letter_box import GREY
from sextant.training.image_set import ImageSet
from sextant.training.network_score import network_score
from sextant.training.yolo_export import exported_weights
from sextant.training.yolo_loss import Targets, YoloLoss
from sextant.training.yolo_network import WIDTHS, YoloNetwork

MIN_SIDE = 3.0  # minimum side of a box, pixels; smaller objects do not count
WARM_UP, FINAL_RATE = 300, 0.02  # batches; final learning rate as a fraction of the maximum
MAX_GRADIENT = 10.0  # maximum norm of the gradient
BFLOAT16 = "avx512_bf16", "amx_bf16"  # flags of x86 in /proc/cpuinfo
COUNTER = "num_batches_tracked"  # of a normalization, which is not used; exports do not have it
MIN_VISIBLE = 0.3  # fraction of an object that must remain in an augmented image for it to count


@dataclass(frozen=True)
class TrainingParams(StrictParams):
    """Schedule, optimizer and augmentation."""

    epochs: int = param(15, "passes over all images", within(1, 10000))
    batch: int = param(16, "number of images in a batch", within(1, 1024))
    rate: float = param(2e-3, "maximum learning rate", within(1e-9, 1))
    decay: float = param(0.02, "weight decay", within(0, 1))
    average: float = param(0.998, "decay of the exponential moving average of the weights", within(0, 1))
    zoom: float = param(0.3, "maximum relative change of size", within(0, 0.95))
    shift: float = param(0.15, "maximum shift, fraction of the image's side", within(0, 1))
    light: float = param(0.35, "maximum relative change of brightness and contrast", within(0, 1))
    tint: float = param(0.08, "maximum relative change of a colour channel", within(0, 1))
    noise: float = param(0.03, "maximum standard deviation of the noise, fraction of the range", within(0, 1))
    mosaic: float = param(0.0, "fraction of the images that are joined of four", within(0, 1))
    seed: int = param(0, "random seed of initial weights, order and augmentation", within(0, 2**31 - 1))
    network: str = param("small", "size of the network", one_of(*WIDTHS))
    patience: int = param(
        30, "epochs without a better score after which training ends, with a validation set", within(1, 10000)
    )


def train(
    pictures: ImageSet,
    classes: int,
    params: TrainingParams,
    checkpoint: Path,
    progress: str = "",
    validation: Optional[ImageSet] = None,
    start: Optional[Path] = None,
) -> YoloNetwork:
    """Trains a network; returns the average of its weights, in evaluation mode.

    :param checkpoint: written after each epoch; if it exists, training resumes from it
    :param progress: title of the progress bar; empty: none
    :param validation: with it training ends early, with the weights of the epoch with the best score
    :param start: checkpoint or export() of another training, whose weights are the initial ones
    :raises OSError: a checkpoint cannot be read or written
    :raises ValueError: a parameter is out of range, or a checkpoint is from another training
    """
    torch.manual_seed(params.seed)
    state = _State(pictures, classes, params, validation)
    if checkpoint.exists():
        state.load(checkpoint)
    elif start:
        state.start_from(start)
    while state.epoch < params.epochs and not state.is_stuck(params.patience):
        loss = state.train_epoch(state.epoch, progress)
        score = state.score(validation) if validation else 0.0
        state.save(checkpoint)
        if progress:
            scored = f", mAP50 {score:.3f}, best {state.best_score:.3f}" if validation else ""
            print(f"epoch {state.epoch} of {params.epochs}: loss {loss:.3f}{scored}", flush=True)
    return state.result()


class _State:
    """State of a training, which is saved after each epoch."""

    def __init__(
        self, pictures: ImageSet, classes: int, params: TrainingParams, validation: Optional[ImageSet]
    ):
        self._pictures, self._params = pictures, params
        self._classes = classes
        self._network = YoloNetwork(classes, params.network).to(memory_format=torch.channels_last)
        self._uses_bfloat16 = has_fast_bfloat16()
        self._loss = YoloLoss(pictures.images.shape[1], classes)
        self.kept = copy.deepcopy(self._network).requires_grad_(False)  # moving average
        self._best = copy.deepcopy(self.kept)  # of the epoch with the best score
        self.best_epoch, self.best_score = 0, 0.0
        self._optimizer = torch.optim.AdamW(_groups(self._network, params.decay), params.rate)
        self._steps = math.ceil(len(pictures.images) / params.batch)
        self.epoch = 0
        # Identifies the training. As text: PyTorch reads no real numbers without executing the file.
        about = {**asdict(params), "classes": classes, **_sums("", pictures)}
        about.update(_sums("validation ", validation) if validation else {})
        self._about = {name: str(value) for name, value in about.items()}

    def train_epoch(self, epoch: int, progress: str) -> float:
        """Trains with every image once; returns the mean loss."""
        random = np.random.default_rng([self._params.seed, epoch])
        torch.manual_seed(int(random.integers(2**31)))  # of the noise: the same after an interruption
        order, batch, losses = random.permutation(len(self._pictures.images)), self._params.batch, []
        self._network.train()
        for step in tqdm(range(self._steps), disable=None if progress else True, desc=progress):
            chosen = _selected(self._pictures, order[step * batch :][:batch])
            if self._params.mosaic and random.random() < self._params.mosaic:
                chosen = mosaic(self._pictures, len(chosen.images), random)
            losses.append(self._train_batch(chosen, random, epoch * self._steps + step))
        self.epoch = epoch + 1
        return float(np.mean(losses))

    def score(self, validation: ImageSet) -> float:
        """Scores the averaged weights, and remembers the best ones. :returns: mAP50"""
        score = network_score(self.kept.eval(), validation, self._classes).mean
        if score > self.best_score:
            self.best_epoch, self.best_score = self.epoch, score
            self._best = copy.deepcopy(self.kept)
        return score

    def is_stuck(self, patience: int) -> bool:
        """Whether there were scores, but no better one for so many epochs."""
        return self.best_score > 0 and self.epoch - self.best_epoch >= patience

    def result(self) -> YoloNetwork:
        """The weights with the best score; without scores the last ones."""
        return (self._best if self.best_score else self.kept).eval()

    def start_from(self, path: Path) -> None:
        """Takes the weights of another training; those of classes only if their number is the same."""
        saved = exported_weights(path) if path.suffix == ".onnx" else _loaded(path).get("kept", {})
        own = self._network.state_dict()
        fitting = {
            name: each for name, each in saved.items() if name in own and own[name].shape == each.shape
        }
        if not all(name in fitting or name.startswith("cv3.") or name.endswith(COUNTER) for name in own):
            raise ValueError(f"{path}: is not of a network of this size")
        for network in (self._network, self.kept):
            network.load_state_dict({**own, **fitting})

    def _train_batch(self, pictures: ImageSet, random: np.random.Generator, step: int) -> float:
        """Trains with one batch; returns its loss."""
        for group in self._optimizer.param_groups:
            group["lr"] = self._rate(step)
        images, targets = augmented(pictures, self._params, random)
        with torch.autocast("cpu", torch.bfloat16, enabled=self._uses_bfloat16):
            predicted = self._network(images)
        loss = self._loss(predicted.float(), targets)
        self._optimizer.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(self._network.parameters(), MAX_GRADIENT)
        self._optimizer.step()
        self._update_average(step)
        return loss.item()

    def _rate(self, step: int) -> float:
        """Learning rate: linear warm-up, then cosine decay (Loshchilov and Hutter 2017, "SGDR")."""
        progress = step / (self._params.epochs * self._steps)
        fall = FINAL_RATE + (1.0 - FINAL_RATE) * 0.5 * (1.0 + math.cos(math.pi * progress))
        return self._params.rate * fall * min(1.0, (step + 1) / WARM_UP)

    def _update_average(self, step: int) -> None:
        """Updates the moving average of the weights, with a smaller decay in the first batches."""
        decay = min(self._params.average, (1 + step) / (10 + step))
        for kept, now in zip(self.kept.state_dict().values(), self._network.state_dict().values()):
            if kept.dtype.is_floating_point:
                kept.mul_(decay).add_(now.detach(), alpha=1.0 - decay)
            else:
                kept.copy_(now)

    def save(self, path: Path) -> None:
        """Writes everything needed to resume, as tensors, integers and text."""
        saved = {
            "network": self._network.state_dict(),
            "kept": self.kept.state_dict(),
            "best": self._best.state_dict(),
            "scores": torch.tensor([self.best_epoch, self.best_score]),
            "moments": self._optimizer.state_dict()["state"],
            "epoch": self.epoch,
            "about": self._about,
        }
        with atomic_file(path, "wb") as file:
            torch.save(saved, file)

    def load(self, path: Path) -> None:
        """Resumes from a checkpoint."""
        saved = _loaded(path)
        try:
            names = dict.fromkeys([*self._about, *saved["about"]])
            other = [name for name in names if self._about.get(name) != saved["about"].get(name)]
            self._network.load_state_dict(saved["network"])
            self.kept.load_state_dict(saved["kept"])
            self._best.load_state_dict(saved["best"])
            self.best_epoch, self.best_score = int(saved["scores"][0]), float(saved["scores"][1])
            self._optimizer.load_state_dict({**self._optimizer.state_dict(), "state": saved["moments"]})
            self.epoch = int(saved["epoch"])
        except Exception as error:  # an invalid file may raise any exception
            raise ValueError(f"{path}: is not a checkpoint of this training, remove it: {error}") from None
        if other:
            raise ValueError(
                f"{path}: is of a training that differs in {', '.join(other)}: choose another folder"
            )


def _loaded(path: Path) -> Dict[str, Any]:
    """Reads a checkpoint, without executing code from it."""
    try:
        return dict(torch.load(path, weights_only=True))
    except OSError:
        raise
    except Exception as error:  # an invalid file may raise any exception
        raise ValueError(f"{path}: is not a checkpoint: {error}") from None


def _sums(of: str, pictures: ImageSet) -> Dict[str, int]:
    """Check sums of images and labels, by name."""
    labels = b"".join(each.tobytes() for each in pictures[1:])
    return {f"{of}images": zlib.crc32(pictures.images.tobytes()), f"{of}labels": zlib.crc32(labels)}


def _groups(network: nn.Module, decay: float) -> List[dict]:
    """Parameter groups: weight decay applies only to the weights of convolutions."""
    decayed = [each for each in network.parameters() if each.ndim > 1]
    others = [each for each in network.parameters() if each.ndim <= 1]
    return [{"params": decayed, "weight_decay": decay}, {"params": others, "weight_decay": 0.0}]


def _selected(pictures: ImageSet, indices: np.ndarray) -> ImageSet:
    return ImageSet(*(each[indices] for each in pictures))


def augmented(
    pictures: ImageSet, params: TrainingParams, random: np.random.Generator
) -> Tuple[Tensor, Targets]:
    """Mirrors, shifts, scales and relights images; returns float (n, 3, size, size) in [0, 1] and targets."""
    count, size = len(pictures.images), pictures.images.shape[1]
    images = torch.from_numpy(pictures.images).permute(0, 3, 1, 2).float() / 255.0
    zoom = np.exp(random.uniform(np.log(1.0 - params.zoom), np.log(1.0 + params.zoom), count))
    mirror = np.where(random.random(count) < 0.5, -1.0, 1.0)
    shift = random.uniform(-params.shift, params.shift, (count, 2)) * size
    images = _transformed(images, zoom, mirror, shift)
    boxes, inside = _transformed_boxes(pictures.boxes, zoom, mirror, shift, size)
    targets = Targets(
        torch.from_numpy(boxes).float(), torch.from_numpy(pictures.classes).long(),
        torch.from_numpy(pictures.exists & (inside > 0.0)),
        torch.from_numpy(pictures.is_counted & _is_large_enough(boxes, inside)),
    )  # fmt: skip
    return _relit(images, params, random), targets


def has_fast_bfloat16() -> bool:
    """Whether the processor has bfloat16 instructions; without them mixed precision is slow."""
    try:
        known = Path("/proc/cpuinfo").read_text()
    except OSError:
        return False
    return any(each in known for each in BFLOAT16)


def mosaic(pictures: ImageSet, count: int, random: np.random.Generator) -> ImageSet:
    """Images that are each joined of four random ones of half the size (Bochkovskiy 2020, "YOLOv4")."""
    size, most = pictures.images.shape[1], pictures.boxes.shape[1]
    half = size // 2
    images = np.full((count, size, size, 3), GREY, np.uint8)
    chosen = random.integers(len(pictures.images), size=(count, 4))
    for quarter in range(4):
        top, left = half * (quarter // 2), half * (quarter % 2)
        parts = pictures.images[chosen[:, quarter], : 2 * half, : 2 * half].astype(np.uint16)
        small = parts.reshape(count, half, 2, half, 2, 3).sum(axis=(2, 4)) // 4
        images[:, top : top + half, left : left + half] = small
    boxes = pictures.boxes[chosen] * 0.5
    boxes += np.array([[0, 0], [half, 0], [0, half], [half, half]]).repeat(2, axis=0).reshape(4, 4)[:, None]
    rows = (each[chosen].reshape(count, 4 * most) for each in pictures[2:])
    return ImageSet(images, boxes.reshape(count, 4 * most, 4), *rows)


def _transformed(images: Tensor, zoom: np.ndarray, mirror: np.ndarray, shift: np.ndarray) -> Tensor:
    """Transforms images; pixels from outside are grey."""
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


def _transformed_boxes(
    boxes: np.ndarray, zoom: np.ndarray, mirror: np.ndarray, shift: np.ndarray, size: int
) -> Tuple[np.ndarray, np.ndarray]:
    """Transformed boxes, clipped at the borders, and the remaining fraction of each (n, most)."""
    middle = 0.5 * size
    scale = np.stack([mirror * zoom, zoom], axis=1)[:, np.newaxis]
    ends = [
        (part - middle) * scale + middle + shift[:, np.newaxis] for part in (boxes[..., :2], boxes[..., 2:])
    ]
    moved = np.concatenate([np.minimum(*ends), np.maximum(*ends)], axis=-1)
    cut = np.clip(moved, 0.0, size)
    areas = [np.prod(each[..., 2:] - each[..., :2], axis=-1) for each in (cut, moved)]
    return cut, areas[0] / np.maximum(areas[1], 1e-9)


def _is_large_enough(boxes: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """Whether (n, most) the visible part of an object is large enough to count."""
    return (inside >= MIN_VISIBLE) & ((boxes[..., 2:] - boxes[..., :2]).min(axis=-1) >= MIN_SIDE)


def _relit(images: Tensor, params: TrainingParams, random: np.random.Generator) -> Tensor:
    """Changes brightness, contrast and tint, and adds noise."""
    count = len(images)
    bright = np.exp(random.uniform(-params.light, params.light, (count, 1, 1, 1)))
    contrast = np.exp(random.uniform(-params.light, params.light, (count, 1, 1, 1)))
    tint = np.exp(random.uniform(-params.tint, params.tint, (count, 3, 1, 1)))
    mean = images.mean((1, 2, 3), keepdim=True)
    images = (images - mean) * torch.from_numpy(contrast).float() + mean
    images = images * torch.from_numpy(bright * tint).float()
    sigma = torch.from_numpy(random.uniform(0.0, params.noise, (count, 1, 1, 1))).float()
    return (images + sigma * torch.randn_like(images)).clamp(0.0, 1.0)
