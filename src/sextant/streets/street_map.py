# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes place maps of a simulated street, with photos in one or several conditions (season and light)."""

import functools
import json
from pathlib import Path
from typing import List, NamedTuple, Sequence, Tuple

import cv2
import numpy as np

from sextant.base.atomic_file import atomic_file
from sextant.base.jobs import run_jobs
from sextant.place_maps.place_clusters import clustered
from sextant.place_maps.place_map import MetricFrame, Overview, PlaceMap
from sextant.place_maps.place_map_addition import NewPhoto, add_photos
from sextant.place_maps.place_map_file import write_place_map
from sextant.streets.street import Street
from sextant.streets.street_conditions import CONDITIONS
from sextant.streets.street_overview import AerialImage, aerial_image
from sextant.streets.street_view import street_view

MAP, CLUSTERS, OVERVIEW = "map.txt", "clusters.txt", "overview.jpg"
RECORD = "street.json"  # file with the parameters of the map
FRAME = "map"
QUALITY = 90  # of the JPEG files


class StreetMap(NamedTuple):
    """Parameters of a map."""

    seed: int  # random seed of the street
    conditions: Sequence[str]  # keys of CONDITIONS; one photo of each place in each
    spacing: float  # distance between places, metres
    size: Tuple[int, int]  # width and height of a photo, pixels
    parts: int  # number of clusters in the map of clusters


class _Shot(NamedTuple):
    """A photo to render."""

    image: str  # file name
    conditions: str  # key of CONDITIONS
    pose: np.ndarray  # (x, y, yaw), metres and radians
    number: int  # of the place, seeds the image noise


def has_street_map(folder: Path, wanted: StreetMap) -> bool:
    """Whether the folder contains the map with these parameters.

    :raises OSError: a file cannot be read
    :raises ValueError: the folder contains another map
    """
    if not (folder / MAP).is_file():
        return False
    record = folder / RECORD
    found = record.read_text(encoding="utf-8") if record.exists() else "an unknown street"
    if found != _record(wanted):
        raise ValueError(
            f"{folder / MAP}: is of {found}, expected {_record(wanted)}; remove the folder or use another"
        )
    return True


def _record(wanted: StreetMap) -> str:
    names = {"conditions": "seasons"}  # as the node's parameter is called
    return json.dumps({names.get(name, name): value for name, value in wanted._asdict().items()})


def write_street_map(folder: Path, wanted: StreetMap) -> Path:
    """Writes photos, overview, a map with exact positions and a map of clusters; shows a progress bar.

    :returns: the file of the map with exact positions; it is written last, so the others exist if it does
    :raises OSError: a file cannot be written
    :raises ValueError: unknown conditions, or more parts than places
    """
    folder.mkdir(parents=True, exist_ok=True)
    street = _street(wanted.seed, wanted.conditions[0])
    count = max(2, round(street.length / wanted.spacing))
    poses = [street.pose(arc) for arc in np.arange(count) * street.length / count]
    shots = [
        _Shot(f"{conditions}_{i:04}.jpg", conditions, pose, i)
        for conditions in wanted.conditions
        for i, pose in enumerate(poses)
    ]
    aerial = aerial_image(street)
    place_map = _map_of(folder, aerial, shots)
    parts = clustered(place_map, wanted.parts)
    take = functools.partial(_take, folder, wanted)
    for _ in run_jobs(take, shots, names=[shot.image for shot in shots], progress="photos of the street"):
        pass
    _write(folder / OVERVIEW, aerial.image[:, :, ::-1])
    write_place_map(folder / CLUSTERS, parts)
    with atomic_file(folder / RECORD) as record:
        record.write(_record(wanted))
    write_place_map(folder / MAP, place_map)
    return folder / MAP


def _map_of(folder: Path, aerial: AerialImage, shots: List[_Shot]) -> PlaceMap:
    height, width = aerial.image.shape[:2]
    frame = MetricFrame(FRAME, aerial.resolution, (*aerial.corner, 0.0))
    overview = Overview(OVERVIEW, width, height)
    photos = [
        NewPhoto(shot.image, *frame.pixel(overview, *shot.pose[:2]), frame.photo_yaw(shot.pose[2]))
        for shot in shots
    ]
    return add_photos(PlaceMap(folder, overview, (), frame), photos)[0]


def _take(folder: Path, wanted: StreetMap, shot: _Shot) -> None:
    _write(
        folder / shot.image,
        street_view(_street(wanted.seed, shot.conditions), shot.pose, wanted.size, shot.number),
    )


def _write(path: Path, image: np.ndarray) -> None:
    """Writes an image (grey or BGR) as JPEG."""
    if not cv2.imwrite(str(path), image, [cv2.IMWRITE_JPEG_QUALITY, QUALITY]):
        raise OSError(f"{path}: cannot be written")


@functools.lru_cache(maxsize=1)  # photos are rendered by conditions
def _street(seed: int, conditions: str) -> Street:
    return Street(seed, CONDITIONS[conditions])
