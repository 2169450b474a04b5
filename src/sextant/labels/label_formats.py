# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Formats of labels, by name."""

from pathlib import Path
from typing import Any, Callable, Dict, Tuple

from sextant.labels.coco_file import read_coco_file, write_coco_file
from sextant.labels.json_file import read_json
from sextant.labels.label_studio_file import read_label_studio_file, write_label_studio_file
from sextant.labels.labelled_photos import LabelledPhotos
from sextant.labels.yolo_folder import read_yolo_folder, write_yolo_folder, yolo_parts

WRITERS: Dict[str, Callable[..., Any]] = {
    "yolo": write_yolo_folder,
    "coco": write_coco_file,
    "label-studio": write_label_studio_file,
}


def read_labels(path: Path, split: str = "") -> LabelledPhotos:
    """Reads a YOLO folder or its data.yaml, or a JSON file of COCO or of Label Studio.

    :param split: part of a YOLO folder: train, valid or test; empty: all
    :raises OSError: a file cannot be read
    :raises ValueError: "file:line: reason"
    """
    if _is_yolo(path):
        return read_yolo_folder(path, split)
    if split:
        raise ValueError(f"{path}: only a YOLO folder has a part '{split}'")
    return (read_label_studio_file if isinstance(read_json(path), list) else read_coco_file)(path)


def label_parts(path: Path) -> Tuple[str, ...]:
    """Parts of a YOLO folder, of train, valid and test; empty: there are none.

    :raises OSError, ValueError: its data.yaml cannot be read
    """
    return yolo_parts(path) if _is_yolo(path) else ()


def _is_yolo(path: Path) -> bool:
    return path.is_dir() or path.suffix in (".yaml", ".yml")
