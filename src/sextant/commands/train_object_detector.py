# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Trains a small network to detect balls and pillars in simulated images, and prints its scores.

train_object_detector detector/                      half an hour on one core; resumes after an interruption
train_object_detector detector/ --quick              few images and steps, to check the installation

Writes objects.onnx (for object_detector), confusion.png (confusion matrix) and checkpoint.pt into the folder.
Needs PyTorch: apt install python3-torch
"""

import argparse
from pathlib import Path
from typing import List, Optional, Sequence

from sextant.commands.command_line import Answer, CommandParser, run
from sextant.objects.yolo_detector import YoloParams
from sextant.objects.yolo_model import MULTIPLE
from sextant.training.average_precision import DetectorScore, recall_and_precision
from sextant.training.detector_scores import plot_confusion, scored
from sextant.training.object_images import CLASSES, image_set

VALIDATION = 1_000_000  # first seed of the validation images
QUICK = {"images": 64, "validation": 16, "epochs": 2}
CHECKPOINT, MODEL, CONFUSION = "checkpoint.pt", "objects.onnx", "confusion.png"
NO_TORCH = "PyTorch is missing: apt install python3-torch"


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Run the command. :returns: exit code: 0, or 2 for invalid options"""
    return run(_parser(), arguments, _train)


def _parser() -> CommandParser:
    parser = CommandParser(prog="train_object_detector", description=__doc__)
    add, default = parser.add_argument, "(default: %(default)s)"
    add("folder", type=Path, metavar="FOLDER", help="output folder; an interrupted training in it is resumed")
    add("--size", type=int, default=160, metavar="PIXELS", help=f"side of the network's input {default}")
    add("--images", type=int, default=6000, metavar="N", help=f"training images {default}")
    add("--validation", type=int, default=600, metavar="N", help=f"validation images {default}")
    add("--epochs", type=int, default=15, metavar="N", help=f"passes over all training images {default}")
    add("--seed", type=int, default=0, metavar="N", help="of images and training")
    add(
        "--jobs",
        type=int,
        default=1,
        metavar="N",
        help="parallel processes that render, and threads that train",
    )
    add("--quick", action="store_true", help="few images and steps")
    return parser


def _train(options: argparse.Namespace) -> Answer:
    try:
        import torch  # optional, and slow to load
    except ImportError:
        raise ValueError(NO_TORCH) from None
    from sextant.training.yolo_export import export
    from sextant.training.yolo_training import TrainingParams, train

    _check(options)
    torch.set_num_threads(options.jobs)
    options.folder.mkdir(parents=True, exist_ok=True)
    first = options.seed * VALIDATION * 2
    images = image_set(range(first, first + options.images), options.size, options.jobs, "images")
    params = TrainingParams(epochs=options.epochs, seed=options.seed)
    network = train(images, len(CLASSES), params, options.folder / CHECKPOINT, "training")
    export(network, options.folder / MODEL, options.size, CLASSES)
    seeds = range(first + VALIDATION, first + VALIDATION + options.validation)
    validation = image_set(seeds, options.size, options.jobs, "validation")
    model = YoloParams(model=str(options.folder / MODEL))
    score = scored(validation.images, validation.truths(), model)
    plot_confusion(options.folder / CONFUSION, score, CLASSES)
    return Answer(_table(score, options))


def _check(options: argparse.Namespace) -> None:
    if options.quick:
        vars(options).update(QUICK)
    for name in ("images", "validation", "epochs", "jobs"):
        if getattr(options, name) < 1:
            raise ValueError(f"--{name} is {getattr(options, name)}, must be a whole number from 1 on")
    if options.size < MULTIPLE or options.size % MULTIPLE:
        raise ValueError(f"--size is {options.size}, must be a multiple of {MULTIPLE}")
    if not 0 <= options.seed < 1000 or options.images > VALIDATION or options.validation > VALIDATION:
        raise ValueError(f"--seed must be within [0, 1000), --images and --validation at most {VALIDATION}")


def _table(score: DetectorScore, options: argparse.Namespace) -> List[str]:
    recall, precision = recall_and_precision(score.table)
    lines = [f"{options.validation} validation images, threshold {score.threshold:g}"]
    lines.append(f"{'':14}{'AP50':>8}{'recall':>9}{'precision':>11}")
    rows = zip(CLASSES, score.precision, recall, precision)
    lines += [f"{name:14}{ap:8.3f}{found:9.3f}{right:11.3f}" for name, ap, found, right in rows]
    lines.append(f"{'mean (mAP50)':14}{score.mean:8.3f}")
    lines.append(f"{options.folder / MODEL}, {options.folder / CONFUSION}")
    return lines
