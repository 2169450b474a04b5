# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Trains a network to detect objects in labelled photos, or balls and pillars in simulated images.

train_object_detector cones/ --data dataset/              your own objects, from scratch
train_object_detector cones/ --data dataset/ --start other/objects.onnx          from another training
train_object_detector cones/ --data dataset/ --images 2000                       mixed with simulated images
train_object_detector detector/ --photos backgrounds/     simulated images and photographs
train_object_detector detector/ --quick                   few images and steps, to check the installation

An interrupted training resumes. Writes objects.onnx (for object_detector), confusion.png (confusion matrix)
and checkpoint.pt into the folder, and prints scores. Needs PyTorch: apt install python3-torch
"""

import argparse
from pathlib import Path
from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from sextant.commands.command_line import Answer, CommandParser, run
from sextant.detection_scores.average_precision import DetectorScore, recall_and_precision
from sextant.detection_scores.detector_scores import plot_confusion, scored
from sextant.labels.label_formats import label_parts, read_labels
from sextant.labels.labelled_photos import LabelledPhotos
from sextant.labels.yolo_folder import HOLD_OUT
from sextant.objects.shipped_model import shipped_model
from sextant.objects.yolo_detector import YoloParams
from sextant.objects.yolo_model import MULTIPLE
from sextant.training.hard_images import PhotoImages, hard_image
from sextant.training.image_set import ImageSet, drawn_images, joined_sets
from sextant.training.labelled_images import labelled_image_set, with_class_indices
from sextant.training.object_images import CLASSES, random_image

VALIDATION = 1_000_000  # first seed of the validation images
QUICK = {"images": 64, "validation": 16, "epochs": 2}
IMAGES, EPOCHS, DATA_EPOCHS = 6000, 15, 60  # defaults without data; passes over the photos with data
SHIPPED = "shipped"  # stands for the network that comes with Sextant
CHECKPOINT, MODEL, CONFUSION = "checkpoint.pt", "objects.onnx", "confusion.png"
NO_TORCH = "PyTorch is missing: apt install python3-torch"


class Sets(NamedTuple):
    """What a network is trained and scored with."""

    classes: List[str]  # names
    training: ImageSet  # images to learn from
    validation: ImageSet  # images that are not in it


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Run the command. :returns: exit code: 0, or 2 for invalid options"""
    return run(_parser(), arguments, _train)


def _parser() -> CommandParser:
    parser = CommandParser(prog="train_object_detector", description=__doc__)
    add, default = parser.add_argument, "(default: %(default)s)"
    add("folder", type=Path, metavar="FOLDER", help="output folder; an interrupted training in it is resumed")
    add("--data", type=Path, metavar="LABELS", help="YOLO folder, or JSON file of COCO or Label Studio")
    text = f"{MODEL} or {CHECKPOINT} of another training to start from; `{SHIPPED}`: the network of Sextant"
    add("--start", type=Path, metavar="NETWORK", help=text)
    add("--network", choices=["small", "large"], default="small", help=f"its size {default}")
    add("--size", type=int, default=160, metavar="PIXELS", help=f"side of the network's input {default}")
    text = f"simulated training images (default: {IMAGES}; with --data 0)"
    add("--images", type=int, metavar="N", help=text)
    text = "folders of photographs without the simulated objects, for a third of the images, used equally"
    add("--photos", type=Path, nargs="+", default=[], metavar="FOLDER", help=text)
    text = "simulated validation images without --data (default: 600)"
    add("--validation", type=int, default=600, metavar="N", help=text)
    text = f"maximum passes over all training images (default: {EPOCHS}; with --data {DATA_EPOCHS})"
    add("--epochs", type=int, metavar="N", help=text)
    text = "with --data: epochs without a better score after which training ends (default: 30)"
    add("--patience", type=int, default=30, metavar="N", help=text)
    add("--seed", type=int, default=0, metavar="N", help="of images and training")
    text = "parallel processes that read or render, and threads that train"
    add("--jobs", type=int, default=1, metavar="N", help=text)
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
    sets = _data_sets(options) if options.data else _simulated_sets(options)
    options.folder.mkdir(parents=True, exist_ok=True)
    params = TrainingParams(
        epochs=options.epochs, seed=options.seed, network=options.network, patience=options.patience,
        mosaic=0.5 if options.data else 0.0,
    )  # fmt: skip
    validation = sets.validation if options.data else None
    start = shipped_model() if options.start == Path(SHIPPED) else options.start
    checkpoint = options.folder / CHECKPOINT
    network = train(sets.training, len(sets.classes), params, checkpoint, "training", validation, start)
    export(network, options.folder / MODEL, options.size, sets.classes)
    model = YoloParams(model=str(options.folder / MODEL))
    score = scored(sets.validation.images, sets.validation.truths(), model)
    plot_confusion(options.folder / CONFUSION, score, sets.classes)
    return Answer(_table(score, sets, options))


def _check(options: argparse.Namespace) -> None:
    if options.quick:
        vars(options).update({"epochs": QUICK["epochs"]} if options.data else QUICK)
    for name, usual, with_data in (("images", IMAGES, 0), ("epochs", EPOCHS, DATA_EPOCHS)):
        if getattr(options, name) is None:
            setattr(options, name, with_data if options.data else usual)
    _check_numbers(options)
    if not 0 <= options.seed < 1000 or options.images > VALIDATION or options.validation > VALIDATION:
        raise ValueError(f"--seed must be within [0, 1000), --images and --validation at most {VALIDATION}")


def _check_numbers(options: argparse.Namespace) -> None:
    if options.size < MULTIPLE or options.size % MULTIPLE:
        raise ValueError(f"--size is {options.size}, must be a multiple of {MULTIPLE}")
    if options.photos and not options.images:
        raise ValueError("--photos are for simulated images, with --data set their number: --images N")
    least = {"images": 0 if options.data else 1, "validation": 1, "epochs": 1, "jobs": 1, "patience": 1}
    for name, smallest in least.items():
        if getattr(options, name) < smallest:
            raise ValueError(
                f"--{name} is {getattr(options, name)}, must be a whole number from {smallest} on"
            )


def _simulated(
    options: argparse.Namespace, first: int, count: int, photos: List[Path], what: str
) -> ImageSet:
    """Usual and hard images, and with photos as many of these.

    :param first: seed of the first image
    """
    draws = [random_image, hard_image, *([PhotoImages(photos)] if photos else [])]
    seeds = np.array_split(range(first, first + count), len(draws))
    parts = [
        drawn_images(draw, each, options.size, options.jobs, f"{what}, part {number} of {len(draws)}")
        for number, (draw, each) in enumerate(zip(draws, seeds), 1)
        if len(each)
    ]
    return joined_sets(parts)


def _simulated_sets(options: argparse.Namespace) -> Sets:
    first = options.seed * VALIDATION * 2
    training = _simulated(options, first, options.images, options.photos, "images")
    validation = _simulated(options, first + VALIDATION, options.validation, [], "validation")
    return Sets(CLASSES, training, validation)


def _data_sets(options: argparse.Namespace) -> Sets:
    parts = _parts(options.data)
    training, validation = (
        labelled_image_set(each, options.size, options.jobs, what)
        for each, what in zip(parts, ("photos", "validation"))
    )
    classes = list(parts[0].classes)
    if options.images:
        if not set(classes) & set(CLASSES):
            raise ValueError(f"--images: simulated are {', '.join(CLASSES)}; the data have none of them")
        first = options.seed * VALIDATION * 2
        drawn = _simulated(options, first, options.images, options.photos, "images")
        simulated = with_class_indices(drawn, CLASSES, classes)
        training = joined_sets([training, simulated])
    return Sets(classes, training, validation)


def _parts(data: Path) -> Tuple[LabelledPhotos, LabelledPhotos]:
    """Photos for training and for validation; those of the part `test` are for neither."""
    parts = label_parts(data)
    if {"train", "valid"} <= set(parts):
        return read_labels(data, "train"), read_labels(data, "valid")
    if parts and "train" not in parts:
        raise ValueError(f"{data}: has no part 'train', only {', '.join(parts)}")
    photos = read_labels(data, "train" if parts else "")
    held_out = photos._replace(photos=photos.photos[::HOLD_OUT])
    kept = [photo for number, photo in enumerate(photos.photos) if number % HOLD_OUT]
    if not kept:
        raise ValueError(f"{data}: has {len(photos.photos)} photos, training needs more")
    return photos._replace(photos=tuple(kept)), held_out


def _table(score: DetectorScore, sets: Sets, options: argparse.Namespace) -> List[str]:
    recall, precision = recall_and_precision(score.table)
    lines = [f"{len(sets.validation.images)} validation images, threshold {score.threshold:g}"]
    lines.append(f"{'':14}{'AP50':>8}{'recall':>9}{'precision':>11}")
    rows = zip(sets.classes, score.precision, recall, precision)
    lines += [f"{name:14}{ap:8.3f}{found:9.3f}{right:11.3f}" for name, ap, found, right in rows]
    lines.append(f"{'mean (mAP50)':14}{score.mean:8.3f}")
    lines.append(f"{options.folder / MODEL}, {options.folder / CONFUSION}")
    return lines
