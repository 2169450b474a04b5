# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A network that train_object_detector trains on labelled real photos, scored on others."""

import os
import tempfile
import time
from pathlib import Path
from typing import List, Sequence

import numpy as np
import yaml
from tables import Row, Table, Value

from sextant.commands import train_object_detector
from sextant.detection_scores.average_precision import recall_and_precision
from sextant.detection_scores.detector_scores import scored
from sextant.labels.label_formats import read_labels
from sextant.objects.yolo_detector import YoloDetector, YoloParams
from sextant.training.labelled_images import labelled_image_set

MEAN, HOURS, CORES = 0.75, 2.0, 2  # minimum mAP50; maximum duration of the training on so many cores
OPTIONS = ("--network", "large")


def own_photo_tables(dataset: Path, quick: bool) -> List[Table]:
    """Trains on the part `train` only, and scores on `valid`.

    :param dataset: YOLO folder of the external test data
    """
    labels = read_labels(dataset, "valid")
    jobs = min(CORES, os.cpu_count() or 1)
    with tempfile.TemporaryDirectory() as folder:
        data, output = Path(folder, "data.yaml"), Path(folder, "network")
        table = {"path": str(dataset.resolve()), "train": "train/images", "names": list(labels.classes)}
        data.write_text(yaml.safe_dump(table))
        begin = time.perf_counter()
        _train([str(output), "--data", str(data), "--jobs", str(jobs), *OPTIONS, *["--quick"] * quick])
        hours = (time.perf_counter() - begin) / 3600.0
        params = YoloParams(model=str(output / train_object_detector.MODEL))
        size = YoloDetector(params).size[0]
        photos = labelled_image_set(labels, size, jobs, "valid")
        score = scored(photos.images, photos.truths(), params)
    recall, precision = recall_and_precision(score.table)
    found = np.stack([score.precision, recall, precision], axis=1)
    rows: List[Row] = [(name, [Value(each, 3) for each in row]) for name, row in zip(labels.classes, found)]
    rows.append(("mean (mAP50)", [Value(score.mean, 3, at_least=None if quick else MEAN), "", ""]))
    title = f"trained on `{dataset.name}/train`, {len(labels.photos)} photos of `valid` at {size} px"
    hour_row: Row = ("training", [Value(hours, 2, at_most=None if quick else HOURS)])
    return [Table(title, ["AP50", "recall", "precision"], rows), Table("time", ["hours"], [hour_row])]


def _train(arguments: Sequence[str]) -> None:
    """:raises OSError: the training failed, for instance without PyTorch"""
    if train_object_detector.main(list(arguments)):
        raise OSError("train_object_detector failed, see above")
