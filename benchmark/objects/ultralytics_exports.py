#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Exports networks of each YOLO family by Ultralytics' software, with what it detects itself in photos.

Runs in a Python with the packages ultralytics, onnx and onnxruntime, which need not have Sextant.

    ultralytics_exports.py FOLDER SIZE PHOTO... [-- FAMILY...]

Networks are not trained: their weights are random, then scaled so that a few scores in ten thousand are
above the threshold. Writes NAME.onnx and NAME.json for each export into the folder, and one line on each.
"""

import json
import sys
from pathlib import Path
from typing import Any, Dict, List, Tuple

import torch
from torch import library as operators

CONFIDENCE, OVERLAP = 0.25, 0.7
_MADE: List[Any] = []  # keeps the operators that are defined here
FAMILIES = ("yolov5n", "yolov8n", "yolov9t", "yolov10n", "yolo11n", "yolo12n", "yolo26n")
OTHERS = ("yolov8n-seg", "yolov8n-pose", "yolo11n-seg", "yolo26n-seg")
ORIENTED = ("yolov8n-obb", "yolo11n-obb", "yolo26n-obb")
END_TO_END = ("yolov10n", "yolo26n")
OPTIONS: Dict[str, Dict[str, Any]] = {
    "default": {}, "opset 12": {"opset": 12}, "opset 17": {"opset": 17}, "dynamic": {"dynamic": True},
    "not simplified": {"simplify": False}, "half": {"half": True}, "suppression": {"nms": True},
    "not square": {"imgsz": (192, 320)}, "end to end": {"nms": False},
    "masks, keypoints": {}, "oriented": {},
}  # fmt: skip
HIGH, SHARE, LEAST = -1.0, 0.0005, 20  # logit which this share, or at least this number, is above
MOST = 4.0  # largest logit
REACH = 4.0  # usual distance of a side of a box from its cell, cells


def suppress(boxes: torch.Tensor, scores: torch.Tensor, most: float) -> torch.Tensor:
    """Indices that greedy suppression keeps, as torchvision.ops.nms()."""
    left, kept = scores.argsort(descending=True), []
    while len(left):
        first, left = left[0], left[1:]
        kept.append(first)
        low = torch.maximum(boxes[first, :2], boxes[left, :2])
        high = torch.minimum(boxes[first, 2:], boxes[left, 2:])
        common = (high - low).clamp(min=0).prod(1)
        areas = (boxes[:, 2:] - boxes[:, :2]).prod(1)
        left = left[common / (areas[first] + areas[left] - common) <= most]
    return torch.stack(kept) if kept else torch.zeros(0, dtype=torch.long)


def load_torchvision() -> None:
    """Defines the operators of torchvision in Python where its library does not fit PyTorch: prediction and
    export only use the suppression."""
    try:
        import torchvision  # noqa: F401
    except RuntimeError:
        for name in [each for each in sys.modules if each.startswith("torchvision")]:
            del sys.modules[name]
        made = operators.Library("torchvision", "DEF")
        _MADE.append(made)
        for name in ("nms", "qnms"):
            made.define(f"{name}(Tensor dets, Tensor scores, float iou_threshold) -> Tensor")
        made.impl("nms", suppress, "CPU")
        from torchvision import extension

        extension._has_ops = lambda: True


def made_network(name: str, photos: torch.Tensor) -> Any:
    """An untrained network that detects something in photos (n, 3, size, size)."""
    from ultralytics import YOLO

    torch.manual_seed(7)
    model = YOLO(f"{name}.yaml")
    network = model.model
    with torch.no_grad():
        normalize(network, photos)
        head = network.eval().model[-1]
        for kind in ("cv2", "cv3", "one2one_cv2", "one2one_cv3"):
            for part in getattr(head, kind, None) or ():
                if kind.endswith("cv3"):
                    scale_scores(network, part[-1], photos)
                elif part[-1].out_channels == 4:  # no distributions: distances must be positive
                    scale_distances(network, part[-1], photos)
    return model


def normalize(network: Any, photos: torch.Tensor) -> None:
    """Sets the statistics of all normalizations to those of the photos."""
    norms = [each for each in network.modules() if isinstance(each, torch.nn.BatchNorm2d)]
    momenta = [each.momentum for each in norms]
    for each in norms:
        each.momentum = None
    network.train()(photos)
    for each, momentum in zip(norms, momenta):
        each.momentum = momentum


def outputs_of(network: Any, last: torch.nn.Conv2d, photos: torch.Tensor) -> torch.Tensor:
    """All outputs of a convolution, one dimension; none: the network does not use it."""
    found: List[torch.Tensor] = [torch.zeros(0)]
    hook = last.register_forward_hook(lambda _module, _inputs, output: found.append(output.flatten()))
    network(photos)
    hook.remove()
    return torch.cat(found)


def scale_scores(network: Any, last: torch.nn.Conv2d, photos: torch.Tensor) -> None:
    """Scales the last convolution of scores."""
    values = outputs_of(network, last, photos) - last.bias.mean()
    if len(values):
        high = float(values.sort(descending=True).values[max(LEAST, int(SHARE * len(values)))])
        factor = (MOST - HIGH) / (float(values.max()) - high)
        last.weight.mul_(factor)
        last.bias.fill_(HIGH - factor * high)


def scale_distances(network: Any, last: torch.nn.Conv2d, photos: torch.Tensor) -> None:
    """Scales the last convolution of distances, which are in cells."""
    values = outputs_of(network, last, photos) - last.bias.mean()
    if len(values):
        factor = 0.5 * REACH / float(values.abs().max())
        last.weight.mul_(factor)
        last.bias.fill_(REACH)


def detections(model: Any, size: Any, photos: List[str]) -> List[Dict[str, list]]:
    """Boxes, scores and classes in each photo."""
    found = []
    for photo in photos:
        (result,) = model.predict(
            photo, imgsz=size, conf=CONFIDENCE, iou=OVERLAP, rect=False, verbose=False, device="cpu"
        )
        boxes = result.boxes if result.boxes is not None else result.obb
        found.append({
            "boxes": boxes.xyxy.tolist(), "scores": boxes.conf.tolist(), "classes": boxes.cls.int().tolist()
        })  # fmt: skip
    return found


def export(name: str, model: Any, settings: Dict[str, Any], folder: Path, photos: List[str]) -> str:
    """Writes an export and its detections. Returns what became of it."""
    from ultralytics import YOLO

    try:
        path = Path(model.export(format="onnx", device="cpu", verbose=False, **settings))
        target = folder / f"{name}.onnx"
        path.replace(target)
        found = detections(YOLO(str(target), task=model.task), settings["imgsz"], photos)
    except Exception as error:  # whatever the software raises
        return f"not exported: {' '.join(str(error).split())[:90]}"
    target.with_suffix(".json").write_text(json.dumps(found))
    return f"{sum(len(each['scores']) for each in found)} objects"


def main(arguments: List[str]) -> None:
    """Makes all exports."""
    split = arguments.index("--") if "--" in arguments else len(arguments)
    (folder, size, *photos), chosen = arguments[:split], arguments[split + 1 :]
    load_torchvision()
    from ultralytics.utils import LOGGER

    LOGGER.setLevel("ERROR")
    for name, option in cases(chosen):
        settings = {"imgsz": (int(size), int(size)), **OPTIONS[option]}
        model = made_network(name, images(photos, settings["imgsz"]))
        what = export(f"{name} {option}", model, settings, Path(folder), photos)
        print(f"{name}, {option}: {what}", flush=True)


def cases(chosen: List[str]) -> List[Tuple[str, str]]:
    """Networks and options."""
    every = [(name, option) for name in FAMILIES for option in list(OPTIONS)[:8]]
    every += [(name, "end to end") for name in END_TO_END]
    every += [(name, "masks, keypoints") for name in OTHERS] + [(name, "oriented") for name in ORIENTED]
    return [each for each in every if not chosen or each[0] in chosen]


def images(photos: List[str], size: Tuple[int, int]) -> torch.Tensor:
    """(n, 3, height, width) of photos, with grey bars. :param size: height and width"""
    import cv2
    from ultralytics.data.augment import LetterBox

    boxed = LetterBox(size, auto=False)
    read = [boxed(image=cv2.imread(each))[..., ::-1].copy() for each in photos]
    return torch.stack([torch.from_numpy(each).permute(2, 0, 1).float() / 255.0 for each in read])


if __name__ == "__main__":
    main(sys.argv[1:])
