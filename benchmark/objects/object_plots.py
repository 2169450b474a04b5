# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plots of the detection of objects: confusion matrices of the network."""

from pathlib import Path
from typing import Dict, List

from tables import Table

from sextant.detection_scores.average_precision import DetectorScore
from sextant.detection_scores.detector_scores import plot_confusion
from sextant.objects.yolo_detector import YoloParams
from sextant.training.object_images import CLASSES


def plot(folder: Path, results: Dict[str, List[Table]]) -> None:
    """Writes folder/usual.png and folder/hard.png."""
    for name, table in zip(("usual", "hard"), results.get("network", [])):
        score = DetectorScore(table.samples["precision"], table.samples["table"], YoloParams.confidence)
        plot_confusion(folder / f"{name}.png", score, CLASSES)
