# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Labels in the JSON format of Label Studio: a list of tasks with rectangles in percent of the photo.

Label Studio serves photos of a folder as /data/local-files/?d=PATH; here PATH is relative to the folder of
the JSON file.
"""

import json
import math
import os
import re
from pathlib import Path
from typing import Any, Dict, List, Optional, Sequence, Tuple
from urllib.parse import quote, unquote

import numpy as np

from sextant.base.atomic_file import atomic_file
from sextant.images.photo_file import photo_size
from sextant.labels.json_file import field, item, located, read_json
from sextant.labels.labelled_photos import (
    LabelledPhoto,
    LabelledPhotos,
    box_around,
    check_box,
    labelled_photo,
)

LOCAL = "/data/local-files/?d="
SIDES = ("x", "y", "width", "height")
RECTANGLES = "rectanglelabels"
_UPLOADED = re.compile(r"^[0-9a-f]{8}-")


def read_label_studio_file(path: Path) -> LabelledPhotos:
    """Reads an export. Tasks without an annotation are left out: nobody has labelled them yet.

    :raises OSError: a file cannot be read
    :raises ValueError: "file:line: task: reason"
    """
    tasks = read_json(path)
    if not isinstance(tasks, list):
        raise ValueError(f"{path}: must be a list of tasks")
    names: List[str] = []
    photos = []
    for number, task in enumerate(tasks):
        try:
            with item(f"task {_id(task, number)}", "", number):
                photo = _photo(task, path.parent, names)
        except ValueError as error:
            raise located(path, error) from None
        photos += [photo] if photo else []
    if not names:
        raise ValueError(f"{path}: no task has labels")
    return LabelledPhotos(tuple(names), tuple(photos))


def _id(task: Any, number: int) -> Any:
    return task.get("id", number) if isinstance(task, dict) else number


def _photo(task: Any, folder: Path, names: List[str]) -> Optional[LabelledPhoto]:
    """:param names: of the classes, to which new ones are added"""
    results = _results(task)
    if results is None:
        return None
    photo = _path(field(field(task, "data", dict), "image", str), folder)
    size = photo_size(photo)
    boxes, classes = [], []
    for result in results:
        name, box = _rectangle(result, size)
        check_box(box, size)
        if name not in names:
            names.append(name)
        boxes.append(box)
        classes.append(names.index(name))
    return labelled_photo(photo, size, boxes, classes)


def _results(task: Any) -> Optional[List[Dict[str, Any]]]:
    """The rectangles of the newest annotation of a task; None: it has no annotation."""
    if not isinstance(task, dict):
        raise ValueError("must be a table with the fields data and annotations")
    annotations = task.get("annotations", [])
    if not isinstance(annotations, list):
        raise ValueError("its annotations must be a list")
    done = [each for each in annotations if isinstance(each, dict) and not each.get("was_cancelled")]
    if not done:
        return None
    return _rectangles([each for each in field(done[-1], "result", list) if isinstance(each, dict)])


def _rectangles(results: List[Dict[str, Any]]) -> List[Dict[str, Any]]:
    """The rectangles among regions."""
    others = {str(each.get("type")) for each in results} - {RECTANGLES}
    unread = sorted(kind for kind in others if kind.endswith("labels"))
    if unread:
        raise ValueError(f"has {unread[0]}, only {RECTANGLES} can be read: label with rectangles")
    return [each for each in results if each.get("type") == RECTANGLES]


def _path(image: str, folder: Path) -> Path:
    """The photo of a task; Label Studio puts a digest and a dash before the names of uploaded files."""
    name = unquote(image[len(LOCAL) :] if image.startswith(LOCAL) else image)
    base = name.rpartition("/")[2]
    original = _UPLOADED.sub("", base)
    for each in (name.lstrip("/"), base, f"images/{base}", original, f"images/{original}"):
        if (folder / each).is_file():
            return folder / each
    raise ValueError(f"there is no photo {folder / name.lstrip('/')}")


def _rectangle(result: Dict[str, Any], size: Tuple[int, int]) -> Tuple[str, List[float]]:
    """Class and box; a rotated rectangle is replaced by the box around it."""
    value = field(result, "value", dict)
    labels = field(value, "rectanglelabels", list)
    if len(labels) != 1 or not isinstance(labels[0], str):
        raise ValueError(f"a rectangle must have one label, it has {len(labels)}")
    written = result.get("original_width", size[0]), result.get("original_height", size[1])
    if written != size:
        raise ValueError(
            f"its photo has {size[0]} × {size[1]} pixels, the labels are for {written[0]} × {written[1]}"
        )
    x, y, width, height = (field(value, side, int, float) / 100 for side in SIDES)
    turn = math.radians(field(value, "rotation", int, float)) if "rotation" in value else 0.0
    along, across = (np.array([math.cos(turn), math.sin(turn)]), np.array([-math.sin(turn), math.cos(turn)]))
    corner = np.array([x * size[0], y * size[1]])
    ends = [
        corner + a * width * size[0] * along + b * height * size[1] * across for a in (0, 1) for b in (0, 1)
    ]
    return labels[0], box_around(ends)


def write_label_studio_file(
    path: Path, photos: LabelledPhotos, scores: Optional[Sequence[np.ndarray]] = None
) -> None:
    """Writes the file, to be imported as tasks of an image with RectangleLabels `label`.

    :param scores: (n,) of the boxes of each photo: then they are predictions of a model, to be corrected
    :raises OSError: it cannot be written
    """
    tasks = []
    for number, photo in enumerate(photos.photos):
        result = [
            _result(photos.classes[index], box, photo.size, f"{number}-{i}")
            for i, (index, box) in enumerate(zip(photo.classes, photo.boxes))
        ]
        task: Dict[str, Any] = {"data": {"image": LOCAL + quote(os.path.relpath(photo.path, path.parent))}}
        if scores is None:
            task["annotations"] = [{"result": result}]
        else:
            for each, score in zip(result, scores[number]):
                each["score"] = round(float(score), 4)
            mean = float(np.mean(scores[number])) if len(result) else 0.0
            task["predictions"] = [{"model_version": "sextant", "score": round(mean, 4), "result": result}]
        tasks.append(task)
    with atomic_file(path) as file:
        json.dump(tasks, file, indent=1)
        file.write("\n")


def _result(name: str, box: np.ndarray, size: Tuple[int, int], number: str) -> Dict[str, Any]:
    left, top, right, bottom = (box / [*size, *size] * 100).tolist()
    numbers = (left, top, right - left, bottom - top)
    return {
        "id": number, "type": RECTANGLES, "from_name": "label", "to_name": "image",
        "original_width": size[0], "original_height": size[1], "image_rotation": 0,
        "value": {
            **{side: round(value, 4) for side, value in zip(SIDES, numbers)},
            "rotation": 0, "rectanglelabels": [name],
        },
    }  # fmt: skip
