# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Labels in COCO's JSON format (cocodataset.org, object detection)."""

import json
import os
from pathlib import Path
from typing import Any, Dict, List, Tuple

from sextant.base.atomic_file import atomic_file
from sextant.images.photo_file import photo_size
from sextant.labels.json_file import field, item, located, read_json
from sextant.labels.labelled_photos import (
    LabelledPhoto,
    LabelledPhotos,
    check_box,
    check_names,
    labelled_photo,
)

_Objects = Dict[int, Tuple[List[List[float]], List[int]]]  # boxes and classes by image id


def read_coco_file(path: Path) -> LabelledPhotos:
    """Reads the file; names of photos are relative to its folder, or to `images` in it.

    :raises OSError: a file cannot be read
    :raises ValueError: "file:line: item: reason"
    """
    table = read_json(path)
    try:
        return _photos(table, path)
    except ValueError as error:
        raise located(path, error) from None


def _photos(table: Any, path: Path) -> LabelledPhotos:
    categories = []
    for i, each in enumerate(field(table, "categories", list)):
        with item(f"category {i}", "categories", i):
            categories.append((field(each, "id", int), field(each, "name", str)))
    names = check_names([name for _, name in categories], "categories")
    numbers = [number for number, _ in categories]
    if len(set(numbers)) < len(numbers):
        raise ValueError("categories: an id is there twice")
    index_of = {number: index for index, (number, _) in enumerate(categories)}
    images: Dict[int, Tuple[Path, Tuple[int, int]]] = {}
    for i, each in enumerate(field(table, "images", list)):
        with item(f"image {i}", "images", i):
            number = field(each, "id", int)
            if number in images:
                raise ValueError(f"its id {number} is there twice")
            images[number] = _image(each, path.parent)
    if not images:
        raise ValueError("there are no images in it")
    objects = _objects(table, images, index_of)
    photos = [_photo(*images[number], *objects[number]) for number in images]
    return LabelledPhotos(names, tuple(photos))


def _image(table: Any, folder: Path) -> Tuple[Path, Tuple[int, int]]:
    """Path and size of a photo."""
    name = field(table, "file_name", str)
    photo = next((each for each in (folder / name, folder / "images" / name) if each.is_file()), None)
    if photo is None:
        raise ValueError(f"there is no file {folder / name}")
    size = photo_size(photo)
    written = tuple(table.get(side, size[i]) for i, side in enumerate(("width", "height")))
    if written != size:
        raise ValueError(
            f"{name} has {written[0]} × {written[1]} pixels here, but {size[0]} × {size[1]} in its file"
        )
    return photo, size


def _objects(table: Any, images: Dict[int, tuple], index_of: Dict[int, int]) -> _Objects:
    objects: _Objects = {number: ([], []) for number in images}
    for i, each in enumerate(field(table, "annotations", list)):
        number = each.get("id", i) if isinstance(each, dict) else i
        with item(f"annotation {number}", "annotations", i):
            image, category = field(each, "image_id", int), field(each, "category_id", int)
            if image not in images:
                raise ValueError(f"there is no image {image}")
            if category not in index_of:
                raise ValueError(f"there is no category {category}")
            if each.get("iscrowd"):
                raise ValueError("is of a crowd (iscrowd): label its objects one by one, or remove it")
            box = _box(field(each, "bbox", list))
            check_box(box, images[image][1])
        objects[image][0].append(box)
        objects[image][1].append(index_of[category])
    return objects


def _box(numbers: List[Any]) -> List[float]:
    """Left, top, right, bottom from left, top, width, height."""
    if len(numbers) != 4 or not all(type(each) in (int, float) for each in numbers):
        raise ValueError("its bbox must be four numbers: left, top, width, height")
    left, top, width, height = numbers
    return [left, top, left + width, top + height]


def _photo(path: Path, size: Tuple[int, int], boxes: List[List[float]], classes: List[int]) -> LabelledPhoto:
    return labelled_photo(path, size, boxes, classes)


def write_coco_file(path: Path, photos: LabelledPhotos) -> None:
    """Writes the file; names of photos are relative to its folder.

    :raises OSError: it cannot be written
    """
    images, annotations = [], []
    for number, photo in enumerate(photos.photos, 1):
        name = os.path.relpath(photo.path, path.parent)
        images.append({"id": number, "file_name": name, "width": photo.size[0], "height": photo.size[1]})
        for index, (left, top, right, bottom) in zip(photo.classes.tolist(), photo.boxes.tolist()):
            box = [round(value, 3) for value in (left, top, right - left, bottom - top)]
            annotations.append({
                "id": len(annotations) + 1, "image_id": number, "category_id": index + 1, "bbox": box,
                "area": round(box[2] * box[3], 3), "iscrowd": 0,
            })  # fmt: skip
    categories = [{"id": index, "name": name} for index, name in enumerate(photos.classes, 1)]
    with atomic_file(path) as file:
        json.dump({"images": images, "annotations": annotations, "categories": categories}, file, indent=1)
        file.write("\n")
