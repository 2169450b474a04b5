# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Evaluates networks on labelled photos, and recommends the confidence to use.

evaluate_objects best.onnx --data dataset/ --part valid
evaluate_objects 160.onnx 256.onnx 320.onnx --data dataset/ -o figures/          side by side
evaluate_objects dynamic.onnx --sizes 160 256 320 --data labels.json             a network of any input size

Prints average precision, recall, precision, false alarms and times. The output folder gets plots and the page
evaluation.html, with the photos with most mistakes. Photos with a depth image beside them (collect_pictures
--depth) are also compared by distance.
"""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import List, Optional, Sequence, Tuple

from sextant.base.table_file import FORMATS, text_table, write_table
from sextant.commands.command_line import Answer, CommandParser, run
from sextant.detection_scores.detector_scores import MIN_SCORE
from sextant.detection_scores.object_evaluation import ObjectEvaluation, evaluate_objects
from sextant.detection_scores.object_evaluation_page import (
    class_table,
    figure_table,
    verdict,
    write_evaluation_page,
)
from sextant.detection_scores.object_evaluation_plots import plot_evaluations
from sextant.labels.label_formats import read_labels
from sextant.labels.labelled_photos import LabelledPhotos, with_classes
from sextant.labels.yolo_folder import SPLITS
from sextant.objects.shipped_model import shipped_model
from sextant.objects.yolo_detector import YoloDetector, YoloParams

PAGE = "evaluation.html"


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Run the command. :returns: exit code: 0, or 2 for invalid options or files"""
    return run(_parser(), arguments, _evaluate)


def _parser() -> CommandParser:
    parser = CommandParser(prog="evaluate_objects", description=__doc__)
    add, default = parser.add_argument, YoloParams()
    text = "networks (default: the one that comes with Sextant)"
    add("models", nargs="*", metavar="ONNX", help=text)
    add(
        "--data",
        type=Path,
        required=True,
        metavar="LABELS",
        help="YOLO folder, or JSON of COCO or Label Studio",
    )
    add("--part", choices=list(SPLITS), default="", help="part of a YOLO folder (default: all)")
    add("-o", "--output", type=Path, metavar="FOLDER", help="of page and plots (default: none are written)")
    add("--table", type=Path, metavar="FILE", help=f"the figures as {', '.join(FORMATS)}")
    text = "input sizes of networks of any size"
    add("--sizes", type=int, nargs="+", default=[0], metavar="PIXELS", help=text)
    text = "minimum score of a detection (default: %(default)s)"
    add("--confidence", type=float, default=default.confidence, metavar="SCORE", help=text)
    text = "wanted false alarms per photo, for the recommended confidence (default: %(default)s)"
    add("--false-alarms", type=float, default=0.02, metavar="NUMBER", help=text)
    text = "overlap above which the box with the lower score is removed (default: %(default)s)"
    add("--max-overlap", type=float, default=default.max_overlap, metavar="IOU", help=text)
    return parser


def _evaluate(options: argparse.Namespace) -> Answer:
    if not 0 <= options.false_alarms < 1000:
        raise ValueError(f"--false-alarms is {options.false_alarms:g}, allowed is [0, 1000)")
    params = YoloParams(confidence=options.confidence, max_overlap=options.max_overlap)
    read = read_labels(options.data, options.part)
    if not read.photos:
        raise ValueError(f"{options.data}: has no labelled photo")
    detectors = _detectors(options, replace(params, confidence=MIN_SCORE, max_objects=300))
    photos = with_classes(read, detectors[0][1].classes, str(options.data))
    evaluations = [
        evaluate_objects(
            name, _of_classes(photos, detector), detector, detector.size, params.confidence, name
        )
        for name, detector in detectors
    ]
    lines = text_table(figure_table(evaluations, options.false_alarms)).splitlines()
    lines += ["", *text_table(class_table(evaluations)).splitlines()]
    lines += ["", verdict(evaluations, options.false_alarms)]
    if options.table:
        write_table(options.table, figure_table(evaluations, options.false_alarms))
    if options.output:
        lines.append(str(_write(options, photos, evaluations, detectors[0][1])))
    return Answer(lines)


def _detectors(options: argparse.Namespace, params: YoloParams) -> List[Tuple[str, YoloDetector]]:
    """Each network with each size, by name."""
    models = options.models or [str(shipped_model())]
    stems = [Path(model).stem for model in models]
    found = []
    for model, stem in zip(models, stems):
        unique = stem if stems.count(stem) == 1 else str(Path(model).with_suffix(""))
        for size in options.sizes:
            name = unique + (f" {size}" if len(options.sizes) > 1 else "")
            found.append((name, YoloDetector(replace(params, model=model, size=size), threads=1)))
    return found


def _of_classes(photos: LabelledPhotos, detector: YoloDetector) -> LabelledPhotos:
    return with_classes(photos, detector.classes, "the photos")


def _write(
    options: argparse.Namespace,
    photos: LabelledPhotos,
    evaluations: Sequence[ObjectEvaluation],
    detector: YoloDetector,
) -> Path:
    """Writes plots and page; returns the page's path."""
    options.output.mkdir(parents=True, exist_ok=True)
    plots = plot_evaluations(options.output, evaluations)
    page = options.output / PAGE
    title = f"Detection of objects: {len(photos.photos)} photos of {options.data.name}"
    write_evaluation_page(page, title, photos, evaluations, detector, plots, options.false_alarms)
    return page
