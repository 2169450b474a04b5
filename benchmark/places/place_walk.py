# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Photos of walks along the simulated street, as files with a map."""

import os
from functools import lru_cache
from pathlib import Path
from typing import List, NamedTuple, Tuple

import cv2
import numpy as np

from sextant.base.jobs import run_jobs
from sextant.place_maps.place_map import Overview, Photo, PlaceMap
from sextant.place_maps.place_map_file import write_place_map
from sextant.streets.street import Street
from sextant.streets.street_camera import CAMERAS
from sextant.streets.street_conditions import CONDITIONS, StreetConditions
from sextant.streets.street_view import street_view

QUALITY = 90  # of the JPEG files
WORTH = 50  # number of photos from which another process, which builds the street again, saves time
NEXT_DAY = StreetConditions("summer", 1, 1.1, 0.3)  # other blinds, leaves and cars, in another light
Size = Tuple[int, int]


class Shot(NamedTuple):
    """A photo to be taken."""

    path: Path
    size: Size
    seed: int  # of the street
    conditions: StreetConditions
    arc: float  # arc length, metres
    aside: float  # offset to the left, metres
    turn: float  # rotation, radians
    number: int  # random seed of the image noise
    camera: str = "ideal"  # key of CAMERAS


def take_all(shots: List[Shot]) -> None:
    """Renders and writes the photos, in one process per WORTH photos."""
    names = [str(shot.path) for shot in shots]
    jobs = min(os.cpu_count() or 1, 1 + len(shots) // WORTH)
    for _ in run_jobs(_take, shots, jobs, names=names, progress="walk"):
        pass


def walk_map(folder: Path, count: int, size: Size, seed: int = 1) -> Path:
    """Writes a map of a walk in summer with its photos; a photo's x is its arc length in centimetres."""
    folder.mkdir(parents=True)
    length = _street(seed, CONDITIONS["summer"]).length
    arcs = np.arange(count) * length / count
    shots = [
        Shot(folder / f"{i:04}.jpg", size, seed, CONDITIONS["summer"], arc, 0.0, 0.0, i)
        for i, arc in enumerate(arcs)
    ]
    take_all(shots)
    photos = tuple(Photo(i, shot.path.name, 100 * shot.arc, 1.0) for i, shot in enumerate(shots))
    overview = Overview("none.png", int(100 * length) + 1, 2)
    write_place_map(folder / "walk.txt", PlaceMap(folder, overview, photos))
    return folder / "walk.txt"


def queries(folder: Path, count: int, size: Size, conditions: StreetConditions, seed: int = 1) -> List[Shot]:
    """Takes photos at random positions along the street."""
    folder.mkdir(parents=True)
    rng = np.random.default_rng(seed)
    length = _street(seed, CONDITIONS["summer"]).length
    shots = [
        Shot(
            folder / f"{i:04}.jpg",
            size,
            seed,
            conditions,
            rng.uniform(0, length),
            rng.normal(0, 0.5),
            rng.normal(0, 0.08),
            10000 + i,
        )
        for i in range(count)
    ]
    take_all(shots)
    return shots


def loop_errors(map_path: Path, x: np.ndarray, shots: List[Shot]) -> np.ndarray:
    """Distances along the loop of recognized photos of a walk_map() from the truth, centimetres.

    :param x: (shots,) of the recognized photos
    """
    around = float(map_path.read_text().split(";")[1])  # the map's width is the length of the loop
    return np.abs((x - [100 * shot.arc for shot in shots] + around / 2) % around - around / 2)


@lru_cache(maxsize=2)
def _street(seed: int, conditions: StreetConditions) -> Street:
    return Street(seed, conditions)


def _take(shot: Shot) -> None:
    street = _street(shot.seed, shot.conditions)
    pose = street.pose(shot.arc, shot.aside, shot.turn)
    view = street_view(street, pose, shot.size, shot.number, CAMERAS[shot.camera])
    if not cv2.imwrite(str(shot.path), view, [cv2.IMWRITE_JPEG_QUALITY, QUALITY]):
        raise OSError(f"{shot.path}: cannot be written")
