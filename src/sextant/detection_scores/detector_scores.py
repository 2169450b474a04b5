# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Evaluation of a detector on images with ground truth, and a plot of its confusion matrix."""

from dataclasses import replace
from pathlib import Path
from typing import Sequence

import numpy as np
from matplotlib.figure import Figure

from sextant.base.atomic_file import atomic_file
from sextant.detection_scores.average_precision import DetectorScore, TrueObjects, detector_score
from sextant.objects.yolo_detector import YoloDetector, YoloParams

MIN_SCORE = 0.01  # minimum score of the detections that count in the average precision


def scored(images: Sequence[np.ndarray], known: Sequence[TrueObjects], params: YoloParams) -> DetectorScore:
    """Scores a network; the confusion matrix is at params.confidence.

    :param images: uint8 (height, width, 3), RGB
    :param known: ground truth of each image
    :raises OSError: the model cannot be read
    :raises ValueError: as YoloDetector
    """
    detector = YoloDetector(replace(params, confidence=MIN_SCORE))
    found = [detector.detect(image) for image in images]
    return detector_score(found, known, len(detector.classes), params.confidence)


def plot_confusion(path: Path, score: DetectorScore, classes: Sequence[str]) -> None:
    """Writes the confusion matrix as a PNG file.

    :raises OSError: the file cannot be written
    """
    names = [*(each.replace("_", " ") for each in classes), "nothing"]
    table = score.table
    fraction = table / np.maximum(1, table.sum(axis=1, keepdims=True))
    figure = Figure(figsize=(5.6, 4.8), dpi=110, constrained_layout=True)
    axes = figure.subplots()
    image = axes.imshow(fraction, cmap="Blues", vmin=0.0, vmax=1.0)
    for (row, column), count in np.ndenumerate(table):
        colour = "white" if fraction[row, column] > 0.5 else "black"
        axes.text(column, row, str(count), ha="center", va="center", color=colour)
    axes.set_xticks(range(len(names)))
    axes.set_xticklabels(names, rotation=30, ha="right")
    axes.set_yticks(range(len(names)))
    axes.set_yticklabels(names)
    axes.set(xlabel="was found", ylabel="is there", title=f"score ≥ {score.threshold:g}")
    figure.colorbar(image, label="share of what is there")
    with atomic_file(path, "wb") as file:
        figure.savefig(file, format="png")
