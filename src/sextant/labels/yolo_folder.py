# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Labels of YOLO's format: folders `images` and `labels`, and data.yaml or classes.txt.

A label file has a line for each object: the class, and centre, width and height of its box as fractions of
the photo; or the class and a polygon x y x y ..., whose box is used. Photos without objects need no file.
"""

import shutil
from pathlib import Path
from typing import Any, Dict, Iterator, List, Sequence, Set, Tuple

import numpy as np
import yaml

from sextant.base.atomic_file import atomic_file
from sextant.images.photo_depth import depth_path
from sextant.images.photo_file import find_photos, photo_size
from sextant.labels.labelled_photos import (
    LabelledPhoto,
    LabelledPhotos,
    box_around,
    check_box,
    check_names,
    labelled_photo,
)

DATA, CLASSES, IMAGES, LABELS = "data.yaml", "classes.txt", "images", "labels"
HOLD_OUT = 10  # every how manieth photo is for validation
SPLITS = {"train": ("train",), "valid": ("val", "valid"), "test": ("test",)}  # names in data.yaml


def read_yolo_folder(path: Path, split: str = "") -> LabelledPhotos:
    """Reads a folder, or the data.yaml in it.

    :param split: a name in SPLITS; empty: all
    :raises OSError: a file cannot be read
    :raises ValueError: "file:line: reason", or a photo cannot be used
    """
    data = _data_of(path)
    if path.is_dir() and not data.exists():
        return _read_plain(path, split)
    table = _table(data)
    names = check_names(_listed(table.get("names"), data), str(data))
    root = data.parent / str(table.get("path", "."))
    photos: List[LabelledPhoto] = []
    for folder in _folders(table, data, root if root.is_dir() else data.parent, split):
        photos += _read_folder(folder, names)
    return LabelledPhotos(names, tuple(photos))


def yolo_parts(path: Path) -> Tuple[str, ...]:
    """Names in SPLITS of the parts of a folder; empty: it has no data.yaml.

    :raises OSError, ValueError: data.yaml cannot be read
    """
    data = _data_of(path)
    if not data.exists():
        return ()
    table = _table(data)
    return tuple(split for split, names in SPLITS.items() if any(map(table.get, names)))


def _data_of(path: Path) -> Path:
    return path / DATA if path.is_dir() else path


def _read_plain(path: Path, split: str) -> LabelledPhotos:
    if split:
        raise ValueError(f"{path}: has no {DATA}, so there is no part '{split}'")
    listed = path / CLASSES
    if not listed.exists():
        raise ValueError(f"{path}: has neither {DATA} nor {CLASSES}")
    names = check_names(listed.read_text(encoding="utf-8-sig").splitlines(), str(listed))
    return LabelledPhotos(names, tuple(_read_folder(path / IMAGES, names)))


def _table(data: Path) -> Dict[str, Any]:
    try:
        table = yaml.safe_load(data.read_text(encoding="utf-8-sig"))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise ValueError(f"{data}: is not YAML: {getattr(error, 'problem', error)}") from None
    if not isinstance(table, dict):
        raise ValueError(f"{data}: must have the fields names, train and val")
    return table


def _listed(names: Any, data: Path) -> List[Any]:
    """Names in the order of their indices."""
    if isinstance(names, dict) and set(names) == set(range(len(names))):
        return [names[index] for index in range(len(names))]
    if isinstance(names, list):
        return names
    raise ValueError(f"{data}: names must be a list, or a table of 0, 1, ...")


def _folders(table: Dict[str, Any], data: Path, root: Path, split: str) -> List[Path]:
    """The image folders of a part."""
    if split and split not in SPLITS:
        raise ValueError(f"there is no part '{split}', there are {', '.join(SPLITS)}")
    wanted = SPLITS[split] if split else sum(SPLITS.values(), ())
    names: List[str] = []
    for part in filter(None, map(table.get, wanted)):
        names += map(str, part if isinstance(part, list) else [part])
    if not names:
        raise ValueError(f"{data}: has no part {' or '.join(wanted)}")
    folders = [_existing(root, name) for name in dict.fromkeys(names)]
    for folder in folders:
        if not folder.is_dir():
            raise ValueError(f"{data}: there is no folder {folder}")
    return folders


def _existing(root: Path, name: str) -> Path:
    """A folder of images; like Ultralytics' software, looks for ../train/images in the folder itself, too."""
    beside, inside = root / name, root / name.replace("../", "", 1)
    return inside if name.startswith("../") and not beside.is_dir() and inside.is_dir() else beside


def _read_folder(folder: Path, names: Sequence[str]) -> Iterator[LabelledPhoto]:
    """The photos of a folder, with the labels of the folder beside it."""
    photos = find_photos(folder)
    labels = _labels_of(folder)
    if not labels.is_dir():
        raise ValueError(f"{folder}: there is no folder {labels} with its labels")
    known = {labels / photo.relative_to(folder).with_suffix(".txt") for photo in photos}
    for path in sorted(labels.rglob("*.txt")):
        if path not in known and path.name != CLASSES:
            raise ValueError(f"{path}: there is no photo for it in {folder}")
    if not photos:
        raise ValueError(f"{folder}: there are no photos in it")
    for photo in photos:
        path = labels / photo.relative_to(folder).with_suffix(".txt")
        yield _read_photo(photo, path, len(names))


def _labels_of(images: Path) -> Path:
    """The folder of the labels: `labels` in place of the last `images` of the path."""
    parts = list(images.parts)
    for index in range(len(parts) - 1, -1, -1):
        if parts[index] == IMAGES:
            return Path(*parts[:index], LABELS, *parts[index + 1 :])
    return images


def _read_photo(photo: Path, path: Path, count: int) -> LabelledPhoto:
    size = photo_size(photo)
    boxes, classes = [], []
    lines = path.read_text(encoding="utf-8-sig", errors="replace").splitlines() if path.exists() else []
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            index, box = _object(line, size, count)
            check_box(box, size)
        except ValueError as error:
            raise ValueError(f"{path}:{number}: {error}") from None
        boxes.append(box)
        classes.append(index)
    return labelled_photo(photo, size, boxes, classes)


def _object(line: str, size: Tuple[int, int], count: int) -> Tuple[int, List[float]]:
    """Class and box of a line."""
    number, *words = line.split()
    if len(words) != 4 and (len(words) < 6 or len(words) % 2):
        what = f"has {1 + len(words)} numbers, it must have 5 (class x y width height) or a polygon"
        raise ValueError(what)
    if not number.isdigit() or int(number) >= count:
        raise ValueError(f"its class is {number}, it must be a whole number from 0 to {count - 1}")
    try:
        pixels = np.array(words, float).reshape(-1, 2) * size
    except ValueError:
        raise ValueError(f"'{line.strip()[:60]}' are not numbers") from None
    if len(words) > 4:
        return int(number), box_around(pixels)
    middle, extent = pixels
    return int(number), [*(middle - extent / 2), *(middle + extent / 2)]


def write_yolo_folder(folder: Path, photos: LabelledPhotos, hold_out: int = HOLD_OUT) -> None:
    """Writes a folder with copies of the photos and their depth, or adds them to one with the same classes.

    :param hold_out: every how manieth photo is for validation; 0: none
    :raises OSError: it cannot be written
    :raises ValueError: two photos have the same name, or the folder has other classes or another such photo
    """
    data = folder / DATA
    if data.exists() and check_names(_listed(_table(data).get("names"), data), str(data)) != photos.classes:
        raise ValueError(f"{data}: has other classes, or in another order: name them by --classes")
    names = enumerate(unique_names(photos))
    targets = [folder / _part(folder, name, number, hold_out) / IMAGES / name for number, name in names]
    table = _with_parts(data, {target.parents[1].name for target in targets})
    for photo, target in zip(photos.photos, targets):
        if target.exists() and target.read_bytes() != photo.path.read_bytes():
            raise ValueError(f"{target}: is another photo than {photo.path}: rename one of them")
    for photo, target in zip(photos.photos, targets):
        _write_photo(photo, target)
    with atomic_file(data) as file:
        yaml.safe_dump({**table, "names": list(photos.classes)}, file, sort_keys=False, allow_unicode=True)


def _part(folder: Path, name: str, number: int, hold_out: int) -> str:
    """Part of a photo: the one where it is already, or one by its number."""
    for part in ("train", "valid"):
        if (folder / part / IMAGES / name).exists():
            return part
    return "valid" if hold_out and number % hold_out == hold_out - 1 else "train"


def _with_parts(data: Path, parts: Set[str]) -> Dict[str, Any]:
    """The table of a folder, with the parts that photos are written to."""
    table = _table(data) if data.exists() else {}
    for part in sorted(parts):
        written = f"{part}/{IMAGES}"
        name = next(filter(table.get, SPLITS[part]), SPLITS[part][0])
        found = table.setdefault(name, written)
        if str(table.get("path", ".")) != "." or found not in (written, f"../{written}"):
            raise ValueError(f"{data}: photos can be added to a folder with {name}: {written} only")
    return table


def _write_photo(photo: LabelledPhoto, target: Path) -> None:
    """Writes a photo, its depth and its labels."""
    label = (target.parents[1] / LABELS / target.name).with_suffix(".txt")
    for each in (target, label):
        each.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(photo.path, target)
    if depth_path(photo.path).exists():
        shutil.copyfile(depth_path(photo.path), depth_path(target))
    with atomic_file(label) as file:
        file.writelines(f"{line}\n" for line in _lines(photo))


def _lines(photo: LabelledPhoto) -> Iterator[str]:
    width, height = photo.size
    for index, (left, top, right, bottom) in zip(photo.classes, photo.boxes):
        x, y = (left + right) / 2 / width, (top + bottom) / 2 / height
        yield f"{index} {x:.6f} {y:.6f} {(right - left) / width:.6f} {(bottom - top) / height:.6f}"


def unique_names(photos: LabelledPhotos) -> List[str]:
    """File names of the photos.

    :raises ValueError: two are the same, but for their suffix
    """
    names = [photo.path.name for photo in photos.photos]
    stems: Dict[str, Path] = {}
    for photo in photos.photos:
        if photo.path.stem in stems:
            other = stems[photo.path.stem]
            raise ValueError(f"{other} and {photo.path} have the same name: rename one, or leave it out")
        stems[photo.path.stem] = photo.path
    return names
