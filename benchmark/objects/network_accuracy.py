# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Accuracy and speed of Sextant's network on simulated images that it was not trained on.

Half of the usual images show worlds of the ball task, half random clutter; the hard ones are those of
sextant.training.hard_images. Objects that are too small at the input size of the network do not count. The
colour detector uses the same images at the same size.
"""

import importlib.util
import os
from typing import List, NamedTuple

import numpy as np
import onnx
from onnx import shape_inference
from tables import Row, Table, Value

from sextant.base.onnx_model import BACKENDS
from sextant.detection_scores.average_precision import DetectorScore, detector_score, recall_and_precision
from sextant.detection_scores.detector_scores import MIN_SCORE
from sextant.objects.colour_detector import ColourDetector, ColourParams
from sextant.objects.detections import Detections
from sextant.objects.shipped_model import shipped_model
from sextant.objects.yolo_detector import YoloDetector, YoloParams
from sextant.training.hard_images import hard_image
from sextant.training.image_set import ImageSet, drawn_images
from sextant.training.object_images import CLASSES, random_image

FIRST = 5_000_000  # first seed; none is used for training or validation
IMAGES, QUICK_IMAGES = 500, 12
SETS = {"usual": (random_image, 0.95), "hard": (hard_image, 0.90)}  # images, minimum mAP50
GFLOP, MEGABYTES = 0.5, 4.0  # maximum operations of an image and file size
EQUAL = 1e-3  # maximum difference of boxes (pixels) and scores between backends
REPEATS, TIMED = 5, 20  # repetitions per timed image; number of timed images


class Judged(NamedTuple):
    """Scores and detections of a detector on all images."""

    score: DetectorScore
    found: List[Detections]


def detector_tables(quick: bool) -> List[Table]:
    """Accuracy by class on both sets of images, then size and cost of the network."""
    model = str(shipped_model())
    size = YoloDetector(YoloParams(model=model)).size[0]
    count = QUICK_IMAGES if quick else IMAGES
    drawn = {
        name: drawn_images(draw, range(FIRST, FIRST + count), size, os.cpu_count() or 1, f"{name} pictures")
        for name, (draw, _) in SETS.items()
    }
    accuracy = [_accuracy(model, name, pictures, quick) for name, pictures in drawn.items()]
    return [*accuracy, _facts(model, size), _runtimes(model, drawn["usual"])]


def _accuracy(model: str, name: str, pictures: ImageSet, quick: bool) -> Table:
    network = _judged(YoloDetector(YoloParams(model=model, backend="opencv", confidence=MIN_SCORE)), pictures)
    colour = _judged(ColourDetector(ColourParams(min_area=4)), pictures)
    title = f"{len(pictures.images)} {name} simulated images, network: score >= {YoloParams.confidence:g}"
    rows = [_class_row(i, network.score, colour.score) for i in range(len(CLASSES))]
    bar = None if quick else SETS[name][1]
    rows.append(
        ("mean (mAP50)", [Value(network.score.mean, 3, at_least=bar), "", "", Value(colour.score.mean, 3)])
    )
    samples = {"precision": network.score.precision, "table": network.score.table}
    return Table(title, ["AP50", "recall", "precision", "AP50 by colour"], rows, samples)


def _judged(detector, pictures: ImageSet) -> Judged:
    found = [detector.detect(image) for image in pictures.images]
    return Judged(detector_score(found, pictures.truths(), len(CLASSES), YoloParams.confidence), found)


def _class_row(which: int, network: DetectorScore, colour: DetectorScore) -> Row:
    recall, precision = recall_and_precision(network.table)
    values = (network.precision, recall, precision, colour.precision)
    return CLASSES[which], [Value(each[which], 3) for each in values]


def _facts(model: str, size: int) -> Table:
    values = [
        Value(gflop(model, size), 3, at_most=GFLOP),
        Value(os.path.getsize(model) / 1e6, 2, at_most=MEGABYTES),
    ]
    return Table("the network", ["GFLOP a frame", "MB"], [(f"{size} px", values)])


def gflop(model: str, size: int) -> float:
    """Operations for one image of size × size pixels, 1e9: two per multiplication of a convolution; others
    are negligible."""
    network = onnx.load(model)
    for side in network.graph.input[0].type.tensor_type.shape.dim[2:]:
        side.dim_value = size
    graph = shape_inference.infer_shapes(network).graph
    weights = {each.name: list(each.dims) for each in graph.initializer}
    shapes = {
        each.name: [side.dim_value for side in each.type.tensor_type.shape.dim]
        for each in (*graph.value_info, *graph.output)
    }
    convolutions = [node for node in graph.node if node.op_type == "Conv"]
    made = [np.prod(shapes[node.output[0]]) * np.prod(weights[node.input[1]][1:]) for node in convolutions]
    return 2e-9 * float(sum(made))


def _runtimes(model: str, pictures: ImageSet) -> Table:
    """Table of the times on one thread, and the difference of each backend's boxes to those of OpenCV."""
    rows: List[Row] = []
    expected: List[Detections] = []
    for backend in sorted(BACKENDS, reverse=True):  # opencv first
        if importlib.util.find_spec("onnxruntime") is None and backend == "onnxruntime":
            rows.append((backend, ["not installed"] * 5))
            continue
        detector = YoloDetector(YoloParams(model=model, backend=backend), threads=1)
        found = [detector.detect(image) for image in pictures.images[:TIMED]]
        expected = expected or found
        times = {stage: 1e3 * _least(detector, pictures, stage) for stage in detector.seconds}
        cells = [Value(sum(times.values()), 1), *(Value(each, 2) for each in times.values())]
        rows.append((backend, [*cells, Value(_difference(found, expected), 6, at_most=EQUAL)]))
    columns = ["ms a frame", "letter box", "network", "decoding", "boxes differ by, px"]
    return Table("both runtimes, one thread", columns, rows)


def _least(detector: YoloDetector, pictures: ImageSet, stage: str) -> float:
    """Seconds of a stage: median over images of the minimum of some runs."""
    seconds = []
    for image in pictures.images[:TIMED]:
        runs = []
        for _ in range(REPEATS):
            detector.detect(image)
            runs.append(detector.seconds[stage])
        seconds.append(min(runs))
    return float(np.median(seconds))


def _difference(found: List[Detections], expected: List[Detections]) -> float:
    """Largest difference of boxes (pixels) and scores; infinite if the classes differ."""
    worst = 0.0
    for one, other in zip(found, expected):
        if list(one.classes) != list(other.classes):
            return float("inf")
        pairs = ((one.boxes, other.boxes), (one.scores, other.scores))
        worst = max([worst, *(float(abs(a - b).max(initial=0.0)) for a, b in pairs)])
    return worst
