# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Teaches a small network to find balls and pillars in simulated pictures, and tells how well it does.

train_object_detector detector/                      half an hour on one core; ended at any time, it goes on
train_object_detector detector/ --quick              a few pictures and steps: does everything work?

Writes objects.onnx (for object_detector), confusion.png (what was taken for what) and checkpoint.pt into it.
Needs PyTorch: apt install python3-torch
"""

import argparse
from pathlib import Path
from typing import List, Optional, Sequence

from sextant.commands.command_line import Answer, CommandParser, run
from sextant.objects.yolo_detector import MULTIPLE, YoloParams
from sextant.training.detector_scores import plot_confusion, scored
from sextant.training.mean_precision import DetectorScore, recall_and_precision
from sextant.training.object_pictures import CLASSES, picture_set

VALIDATION = 1_000_000  # seeds of its pictures begin here: none of them is learnt from
QUICK = {"pictures": 64, "validation": 16, "epochs": 2}
CHECKPOINT, MODEL, PICTURE = "checkpoint.pt", "objects.onnx", "confusion.png"
NO_TORCH = "PyTorch is missing: apt install python3-torch"


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """:returns: exit code: 0, or 2 when nothing was learnt."""
    return run(_parser(), arguments, _train)


def _parser() -> CommandParser:
    parser = CommandParser(prog="train_object_detector", description=__doc__)
    add, default = parser.add_argument, "(default: %(default)s)"
    add("folder", type=Path, metavar="FOLDER", help="what is there of a training that was ended goes on")
    add(
        "--size",
        type=int,
        default=160,
        metavar="PIXELS",
        help=f"of a side of what the network takes {default}",
    )
    add("--pictures", type=int, default=6000, metavar="N", help=f"to learn from {default}")
    add(
        "--validation",
        type=int,
        default=600,
        metavar="N",
        help=f"pictures to judge by, others than those {default}",
    )
    add("--epochs", type=int, default=15, metavar="N", help=f"times that each is shown {default}")
    add("--seed", type=int, default=0, metavar="N", help="of pictures and training")
    add("--jobs", type=int, default=1, metavar="N", help="processes that draw, and threads that compute")
    add("--quick", action="store_true", help="few pictures and steps")
    return parser


def _train(options: argparse.Namespace) -> Answer:
    try:
        import torch  # optional, and slow to load
    except ImportError:
        raise ValueError(NO_TORCH) from None
    from sextant.training.yolo_network import export
    from sextant.training.yolo_training import TrainingParams, train

    _check(options)
    torch.set_num_threads(options.jobs)
    options.folder.mkdir(parents=True, exist_ok=True)
    first = options.seed * VALIDATION * 2
    pictures = picture_set(range(first, first + options.pictures), options.size, options.jobs, "pictures")
    params = TrainingParams(epochs=options.epochs, seed=options.seed)
    network = train(pictures, len(CLASSES), params, options.folder / CHECKPOINT, "training")
    export(network, options.folder / MODEL, options.size, CLASSES)
    seeds = range(first + VALIDATION, first + VALIDATION + options.validation)
    judged = picture_set(seeds, options.size, options.jobs, "validation")
    model = YoloParams(model=str(options.folder / MODEL))
    score = scored(judged.images, judged.known(), model)
    plot_confusion(options.folder / PICTURE, score, CLASSES)
    return Answer(_table(score, options))


def _check(options: argparse.Namespace) -> None:
    if options.quick:
        vars(options).update(QUICK)
    for name in ("pictures", "validation", "epochs", "jobs"):
        if getattr(options, name) < 1:
            raise ValueError(f"--{name} is {getattr(options, name)}, allowed is a whole number from 1 on")
    if options.size < MULTIPLE or options.size % MULTIPLE:
        raise ValueError(f"--size is {options.size}, allowed are multiples of {MULTIPLE}")
    if not 0 <= options.seed < 1000 or options.pictures > VALIDATION or options.validation > VALIDATION:
        raise ValueError(f"--seed must be within [0, 1000), --pictures and --validation at most {VALIDATION}")


def _table(score: DetectorScore, options: argparse.Namespace) -> List[str]:
    recall, precision = recall_and_precision(score.table)
    lines = [f"{options.validation} pictures that were not learnt from, threshold {score.threshold:g}"]
    lines.append(f"{'':14}{'AP50':>8}{'recall':>9}{'precision':>11}")
    rows = zip(CLASSES, score.precision, recall, precision)
    lines += [f"{name:14}{ap:8.3f}{found:9.3f}{right:11.3f}" for name, ap, found, right in rows]
    lines.append(f"{'mean (mAP50)':14}{score.mean:8.3f}")
    lines.append(f"{options.folder / MODEL}, {options.folder / PICTURE}")
    return lines
