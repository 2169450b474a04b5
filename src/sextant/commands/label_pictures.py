# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts labels of objects in pictures, proposes labels by a network, and shows them on a page.

label_pictures pictures/ --model best.onnx -o tasks.json --to label-studio     proposals, to be corrected
label_pictures pictures/ --model best.onnx -o proposed/ --to yolo
label_pictures export.json -o dataset/ --to yolo                               of COCO or Label Studio
label_pictures dataset/ -o labels.json --to coco --part train
label_pictures dataset/ -o sheet.html --to sheet                               to check labels by eye

Labels are read strictly: a wrong box, class or size is an error with file and line. A YOLO folder gets copies
of the pictures; the other files refer to them.
"""

import argparse
from pathlib import Path
from typing import List, Optional, Sequence, Tuple

import numpy as np

from sextant.commands.command_line import Answer, CommandParser, check_output, run
from sextant.images.photo_file import find_photos
from sextant.labels.contact_sheet import write_contact_sheet
from sextant.labels.label_formats import WRITERS, read_labels
from sextant.labels.label_proposals import proposed_labels
from sextant.labels.labelled_photos import LabelledPhotos, check_names, with_classes
from sextant.labels.yolo_folder import HOLD_OUT, SPLITS
from sextant.objects.yolo_detector import YoloDetector, YoloParams

SHEET = "sheet"
_Labels = Tuple[LabelledPhotos, Optional[List[np.ndarray]]]  # and the scores of proposals


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Run the command. :returns: exit code: 0, or 2 for invalid options or files"""
    return run(_parser(), arguments, _label)


def _parser() -> CommandParser:
    parser = CommandParser(prog="label_pictures", description=__doc__)
    add = parser.add_argument
    text = (
        "YOLO folder or its data.yaml, JSON file of COCO or Label Studio; with --model a folder of pictures"
    )
    add("input", type=Path, metavar="INPUT", help=text)
    add("-o", "--output", type=Path, required=True, metavar="OUTPUT", help="file, or folder for yolo")
    text = "format of the output; sheet: HTML page"
    add("--to", choices=[*WRITERS, SHEET], required=True, help=text)
    add("--force", action="store_true", help="overwrite existing files, add to an existing folder")
    text = "of a YOLO folder: every how manieth picture is for validation; 0: none (default: %(default)s)"
    add("--hold-out", type=int, default=HOLD_OUT, metavar="N", help=text)
    add("--part", choices=list(SPLITS), default="", help="part of a YOLO folder to read (default: all)")
    text = "class names in their order; without it, those of the input"
    add("--classes", nargs="+", default=[], metavar="NAME", help=text)
    add("--model", metavar="ONNX", help="network that proposes labels")
    default = YoloParams.confidence
    text = "minimum score of proposals (default: %(default)s)"
    add("--confidence", type=float, default=default, metavar="SCORE", help=text)
    return parser


def _label(options: argparse.Namespace) -> Answer:
    _check_output(options)
    if options.hold_out < 0:
        raise ValueError(f"--hold-out is {options.hold_out}, must be a whole number from 0 on")
    photos, scores = _proposals(options) if options.model else _labels(options)
    if options.classes:
        names = check_names(options.classes, "--classes")
        photos = with_classes(photos, names, str(options.input))
    if options.to == SHEET:
        write_contact_sheet(options.output, options.input.name, photos, scores)
    else:
        extra = {"yolo": [options.hold_out], "label-studio": [scores]}.get(options.to, [])
        WRITERS[options.to](options.output, photos, *extra)
    return Answer([f"{options.output}: {len(photos.photos)} pictures, {_listed(photos)}"])


def _check_output(options: argparse.Namespace) -> None:
    is_folder = options.output.is_dir() and options.to == "yolo"
    if is_folder and any(options.output.iterdir()) and not options.force:
        raise ValueError(f"{options.output}: is not empty; --force adds to it")
    if not is_folder:
        check_output(options.output, options.force)


def _labels(options: argparse.Namespace) -> _Labels:
    return read_labels(options.input, options.part), None


def _proposals(options: argparse.Namespace) -> _Labels:
    paths = find_photos(options.input)
    if not paths:
        raise ValueError(f"{options.input}: there are no pictures in it")
    detector = YoloDetector(YoloParams(model=options.model, confidence=options.confidence))
    return proposed_labels(paths, detector, "proposals")


def _listed(photos: LabelledPhotos) -> str:
    return ", ".join(f"{count} {name}" for name, count in zip(photos.classes, photos.counts()))
