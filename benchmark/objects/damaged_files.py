# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Damaged files of labels, images and networks: each must be refused with a message, or read."""

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Dict, List

import numpy as np
from tables import Table, Value

from sextant.objects.shipped_model import shipped_model

COUNT, QUICK = 1000, 30  # files
PHOTO = (64, 48)  # width and height, pixels

# Reads files whose names are on its standard input; prints what became of each. A crash ends it.
READER = """
import sys
from pathlib import Path
from sextant.images.photo_file import read_rgb
from sextant.labels.label_formats import read_labels
from sextant.objects.yolo_detector import YoloDetector, YoloParams

READERS = {
    ".txt": lambda path: read_labels(path.parents[1]),
    ".json": read_labels,
    ".png": read_rgb,
    ".onnx": lambda path: YoloDetector(YoloParams(model=str(path), backend="opencv"), 1),
}
for line in sys.stdin:
    path = Path(line.strip())
    try:
        READERS[path.suffix](path)
        print("read", flush=True)
    except (ValueError, OSError) as error:
        print("refused" if str(error).strip() else "refused without a message", flush=True)
"""


def damaged_file_tables(quick: bool) -> List[Table]:
    """What became of the files of each kind."""
    count = QUICK if quick else COUNT
    random = np.random.default_rng(1)
    with tempfile.TemporaryDirectory() as name:
        whole = _whole_files(Path(name) / "whole")
        outcomes: Dict[str, List[str]] = {kind: [] for kind in whole}
        kinds = list(whole)
        for number in range(count):
            kind = kinds[number % len(kinds)]
            path = _damaged(whole[kind], Path(name) / f"{number}", random)
            outcomes[kind].append(_outcome(path))
            shutil.rmtree(Path(name) / f"{number}")
    rows = [(kind, _cells(each)) for kind, each in outcomes.items()]
    rows.append(("all", _cells([each for part in outcomes.values() for each in part])))
    return [Table(f"{count} damaged files", ["files", "refused", "read", "crashed or no message"], rows)]


def _cells(outcomes: List[str]) -> List[Value]:
    counts = [outcomes.count(each) for each in ("refused", "read")]
    bad = len(outcomes) - sum(counts)
    return [Value(len(outcomes), 0), *(Value(each, 0) for each in counts), Value(bad, 0, at_most=0)]


def _whole_files(folder: Path) -> Dict[str, Path]:
    """One valid file of each kind, in folders of their own with all that belongs to them."""
    import cv2

    image = np.random.default_rng(2).integers(0, 255, (*PHOTO[::-1], 3), dtype=np.uint8)
    files = {
        "yolo": folder / "yolo/labels/a.txt", "coco": folder / "coco/labels.json",
        "label studio": folder / "studio/tasks.json", "image": folder / "image/a.png",
        "network": folder / "network/net.onnx",
    }  # fmt: skip
    for path in files.values():
        path.parent.mkdir(parents=True)
    for photo in ("yolo/images/a.png", "coco/a.png", "studio/a.png", "image/a.png"):
        (folder / photo).parent.mkdir(exist_ok=True)
        cv2.imwrite(str(folder / photo), image)
    (folder / "yolo/data.yaml").write_text("train: images\nnames: [ball, goal]\n")
    files["yolo"].write_text("0 0.5 0.5 0.25 0.25\n1 0.2 0.3 0.1 0.1\n")
    width, height = PHOTO
    coco = {
        "images": [{"id": 1, "file_name": "a.png", "width": width, "height": height}],
        "annotations": [{"id": 1, "image_id": 1, "category_id": 1, "bbox": [4, 5, 20, 10]}],
        "categories": [{"id": 1, "name": "ball"}],
    }
    files["coco"].write_text(json.dumps(coco))
    value = {"x": 10, "y": 20, "width": 30, "height": 40, "rotation": 0, "rectanglelabels": ["ball"]}
    result = {"type": "rectanglelabels", "original_width": width, "original_height": height, "value": value}
    files["label studio"].write_text(
        json.dumps([{"id": 1, "data": {"image": "a.png"}, "annotations": [{"result": [result]}]}])
    )
    shutil.copyfile(shipped_model(), files["network"])
    return files


def _damaged(whole: Path, folder: Path, random: np.random.Generator) -> Path:
    """A copy of the file and its neighbours, damaged: cut, with other bytes, or with bytes left out."""
    root = whole.parents[1] if whole.suffix == ".txt" else whole.parent
    shutil.copytree(root, folder)
    path = folder / whole.relative_to(root)
    content = bytearray(path.read_bytes())
    at, length = int(random.integers(len(content))), int(random.integers(1, 1 + min(64, len(content))))
    kind = random.integers(3)
    if kind == 0:
        del content[at:]
    elif kind == 1:
        content[at : at + length] = random.integers(0, 256, length, dtype=np.uint8).tobytes()
    else:
        del content[at : at + length]
    path.write_bytes(bytes(content))
    return path


class _Reader:
    """A process that reads files until it crashes."""

    process = None

    @classmethod
    def outcome(cls, path: Path) -> str:
        if cls.process is None or cls.process.poll() is not None:
            cls.process = subprocess.Popen(
                [sys.executable, "-c", READER], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL, text=True,
            )  # fmt: skip
        cls.process.stdin.write(f"{path}\n")
        cls.process.stdin.flush()
        return cls.process.stdout.readline().strip() or "crashed"


def _outcome(path: Path) -> str:
    return _Reader.outcome(path)
