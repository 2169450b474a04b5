# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Boxes and scores of exported YOLO networks against those that the exporting software computes with them."""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import List, NamedTuple, Optional, Tuple

import numpy as np
from tables import Row, Table, Value

from sextant.detection_scores.average_precision import overlaps
from sextant.images.photo_file import find_photos, read_rgb
from sextant.objects.detections import Detections
from sextant.objects.yolo_detector import YoloDetector, YoloParams

PYTHON = "SEXTANT_ULTRALYTICS"  # environment variable: a Python with ultralytics, onnx and onnxruntime
EXPORTER = Path(__file__).with_name("ultralytics_exports.py")
SIZE = 160  # pixels, of the networks' input
PHOTOS, QUICK_PHOTOS = 6, 2  # of each folder
CONFIDENCE, OVERLAP, MOST = 0.25, 0.7, 300  # of the exporting software
SAME_BOX, SAME_SCORE = 0.99, 0.01  # minimum overlap, maximum difference
NOT_MADE = "not exported"  # begin of the exporter's outcome
MARGIN = 0.01  # scores so near to the threshold may be on its other side


class Compared(NamedTuple):
    """What Sextant makes of one export."""

    name: str  # of the network
    option: str  # of the export
    outcome: str  # of the exporter
    objects: int = 0  # that the exporting software detects
    same: int = 0  # of these, with the same box, class and score
    more: int = 0  # that only Sextant detects
    is_loaded: bool = False


def export_tables(places: Path, blimp: Path, quick: bool) -> List[Table]:
    """One row for each network, with all of its exports.

    :param places, blimp: folders of the external test data
    :raises OSError: there is no Python with the exporting software
    """
    count = QUICK_PHOTOS if quick else PHOTOS
    photos = [*find_photos(places / "lund")[:count], *find_photos(blimp / "valid/images")[:count]]
    with tempfile.TemporaryDirectory() as folder:
        lines = _exported(Path(folder), photos, ["yolo11n", "yolo26n"] if quick else [])
        compared = [_compared(Path(folder), line, photos) for line in lines]
    return [_networks(compared), _options(compared)]


def _exported(folder: Path, photos: List[Path], chosen: List[str]) -> List[Tuple[str, str, str]]:
    """Network, option and outcome of each export."""
    python = os.environ.get(PYTHON, sys.executable)
    environment = dict(os.environ)
    if PYTHON in os.environ:
        environment.pop("PYTHONPATH", None)  # that of another Python
    command = [python, str(EXPORTER), str(folder), str(SIZE), *map(str, photos), "--", *chosen]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    if done.returncode:
        reason = (done.stderr.strip() or "it failed").splitlines()[-1]
        raise OSError(f"{python}: {reason}; set {PYTHON} to a Python with ultralytics, onnx and onnxruntime")
    lines = [line.partition(": ") for line in done.stdout.splitlines() if ": " in line]
    if all(outcome.startswith(NOT_MADE) for _, _, outcome in lines):
        raise OSError(f"{python}: {lines[0][2] if lines else 'nothing was exported'}")
    return [(*what.split(", ", 1), outcome) for what, _, outcome in lines]


def _compared(folder: Path, line: Tuple[str, str, str], photos: List[Path]) -> Compared:
    name, option, outcome = line
    path = folder / f"{name} {option}.onnx"
    expected = path.with_suffix(".json")
    if not expected.exists():
        return Compared(*line)
    try:
        params = YoloParams(
            model=str(path),
            backend="opencv",
            confidence=CONFIDENCE - MARGIN,
            max_overlap=OVERLAP,
            max_objects=MOST,
        )
        detector = YoloDetector(params)
        images = [read_rgb(photo) for photo in photos]
        found = [detector.detect(image) for image in images]
    except ValueError as error:
        print(error, file=sys.stderr)
        return Compared(*line)
    sizes = [(image.shape[1], image.shape[0]) for image in images]
    counts = np.array(list(map(_counts, json.loads(expected.read_text()), found, sizes)))
    return Compared(*line, *counts.sum(axis=0).tolist(), True)


def _counts(expected: dict, found: Detections, size: Tuple[int, int]) -> Tuple[int, int, int]:
    """Objects expected, the same and only found here, without those near the threshold; none where the
    exporting software left some out."""
    if len(expected["scores"]) >= MOST:
        return 0, 0, 0
    # Those around oriented boxes are not clipped there.
    boxes = np.clip(np.array(expected["boxes"]).reshape(-1, 4), 0.0, [*size, *size])
    scores, classes = np.array(expected["scores"]), np.array(expected["classes"], int)
    is_same = (
        (overlaps(boxes, found.boxes) >= SAME_BOX)
        & (abs(scores[:, np.newaxis] - found.scores) <= SAME_SCORE)
        & (classes[:, np.newaxis] == found.classes)
    )
    sure, own_sure = scores >= CONFIDENCE + MARGIN, found.scores >= CONFIDENCE + MARGIN
    return int(sure.sum()), int(is_same[sure].any(axis=1).sum()), int((own_sure & ~is_same.any(axis=0)).sum())


def _networks(compared: List[Compared]) -> Table:
    names = list(dict.fromkeys(each.name for each in compared))
    rows = [_row(name, [each for each in compared if each.name == name]) for name in names]
    return Table("exports of Ultralytics' software by network", HEADS, rows)


def _options(compared: List[Compared]) -> Table:
    names = list(dict.fromkeys(each.option for each in compared))
    rows = [
        _row(name, [each for each in compared if each.option == name], SAME.get(name, 100)) for name in names
    ]
    title = f"the same by option; objects with IoU >= {SAME_BOX} and scores within {SAME_SCORE} are the same"
    return Table(title, HEADS, [*rows, _row("all", compared)])


# Half precision is computed there, too, and the scores of untrained networks amplify rounding. Upright boxes
# are suppressed where oriented ones overlap less.
SAME = {"half": None, "oriented": None}
HEADS = ["exports", "of these made", "loaded", "objects", "the same, %", "only here, %"]


def _row(name: str, some: List[Compared], least: Optional[float] = None) -> Row:
    """:param least: minimum percentage of objects that are the same; None: any"""
    made = [each for each in some if not each.outcome.startswith(NOT_MADE)]
    objects, same, more = (sum(getattr(each, part) for each in made) for part in ("objects", "same", "more"))
    shares = [100.0 * part / max(objects, 1) for part in (same, more)]
    return name, [
        Value(len(some), 0), Value(len(made), 0),
        Value(sum(each.is_loaded for each in made), 0, at_least=len(made)), Value(objects, 0),
        Value(shares[0], 2, at_least=least if made else None), Value(shares[1], 2),
    ]  # fmt: skip
