# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A detector judged by pictures whose objects are known, and the picture of what it takes for what."""

from dataclasses import replace
from pathlib import Path
from typing import Sequence

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from sextant.base.atomic_file import atomic_file
from sextant.objects.yolo_detector import YoloDetector, YoloParams
from sextant.training.mean_precision import DetectorScore, KnownObjects, detector_score

LEAST = 0.01  # score of a box that counts in a mean precision


def scored(
    images: Sequence[np.ndarray], known: Sequence[KnownObjects], params: YoloParams
) -> DetectorScore:
    """A network at the threshold of its parameters.

    :param images: uint8 (height, width, 3), red first
    :raises OSError: the model cannot be read
    :raises ValueError: as YoloDetector
    """
    detector = YoloDetector(replace(params, confidence=LEAST))
    found = [detector.detect(image) for image in images]
    return detector_score(found, known, len(detector.classes), params.confidence)


def plot_confusion(path: Path, score: DetectorScore, classes: Sequence[str]) -> None:
    """Writes a PNG: of each class, as what it was found.

    :raises OSError: it cannot be written
    """
    names = [*(each.replace("_", " ") for each in classes), "nothing"]
    table = score.table
    share = table / np.maximum(1, table.sum(axis=1, keepdims=True))
    figure = Figure(figsize=(5.6, 4.8), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    image = axes.imshow(share, cmap="Blues", vmin=0.0, vmax=1.0)
    for (row, column), count in np.ndenumerate(table):
        colour = "white" if share[row, column] > 0.5 else "black"
        axes.text(column, row, str(count), ha="center", va="center", color=colour)
    axes.set_xticks(range(len(names)), names, rotation=30, ha="right")
    axes.set_yticks(range(len(names)), names)
    axes.set(xlabel="was found", ylabel="is there", title=f"score ≥ {score.threshold:g}")
    figure.colorbar(image, label="share of what is there")
    with atomic_file(path, "wb") as file:
        figure.savefig(file, format="png")
