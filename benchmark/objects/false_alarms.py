# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Detections in real photos that show none of the objects."""

from pathlib import Path
from typing import List

import numpy as np
from tables import Row, Table, Value

from sextant.images.photo_file import find_photos, read_rgb
from sextant.objects.object_functions import detect_objects
from sextant.objects.object_kinds import KINDS
from sextant.objects.yolo_detector import YoloParams

FOLDERS = ("corridor", "lund")  # no photo of them was used to train or choose the network
MOST = 0.02  # boxes per photo
QUICK = 10  # photos of each folder


def false_alarm_tables(places: Path, quick: bool) -> List[Table]:
    """Boxes per photo of the network that comes with Sextant, at its usual confidence.

    :param places: folder of the external test data
    """
    counts = {name: _counts(find_photos(places / name)[: QUICK if quick else None]) for name in FOLDERS}
    rows: List[Row] = [(name, _cells(each, None)) for name, each in counts.items()]
    rows.append(("all", _cells(np.concatenate(list(counts.values())), None if quick else MOST)))
    title = f"Photos without ball or pillars, score >= {YoloParams.confidence:g}: boxes per photo"
    return [Table(title, ["photos", *KINDS, "all"], rows)]


def _counts(paths: List[Path]) -> np.ndarray:
    """Number of boxes (photos, classes)."""
    names = list(KINDS)
    table = np.zeros((len(paths), len(names)))
    for row, path in zip(table, paths):
        for found in detect_objects(read_rgb(path)):
            row[names.index(found.class_name)] += 1
    return table


def _cells(counts: np.ndarray, most: float) -> List[Value]:
    values = [Value(each, 3) for each in counts.mean(axis=0)]
    return [Value(len(counts), 0), *values, Value(counts.sum(axis=1).mean(), 3, at_most=most)]
