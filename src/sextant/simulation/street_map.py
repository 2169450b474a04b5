# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps of a simulated street: photos all along the walk, in one season or several."""

import functools
import json
from pathlib import Path
from typing import List, NamedTuple, Sequence, Tuple

import cv2
import numpy as np

from sextant.base.atomic_file import atomic_file
from sextant.base.jobs import run_jobs
from sextant.place_maps.map_addition import NewPhoto, add_photos
from sextant.place_maps.place_clusters import clustered
from sextant.place_maps.place_map import MetricFrame, Overview, PlaceMap
from sextant.place_maps.place_map_file import write_place_map
from sextant.simulation.street import CONDITIONS, Street
from sextant.simulation.street_overview import AerialPicture, aerial_picture
from sextant.simulation.street_view import street_view

MAP, CLUSTERS, OVERVIEW = "map.txt", "clusters.txt", "overview.jpg"
RECORD = "street.json"  # of what was wanted
FRAME = "map"
QUALITY = 90  # of the JPEG files


class StreetMap(NamedTuple):
    """What is photographed."""

    seed: int  # of the street
    seasons: Sequence[str]  # of sextant.simulation.street.CONDITIONS: a photo of every place in each
    spacing: float  # metres from place to place
    size: Tuple[int, int]  # width and height of a photo, pixels
    parts: int  # of the walk, in the map of clusters


class _Shot(NamedTuple):
    image: str
    season: str
    pose: np.ndarray  # (x, y, yaw)
    number: int


def has_street_map(folder: Path, wanted: StreetMap) -> bool:
    """Whether the folder has this very map.

    :raises OSError: it cannot be read
    :raises ValueError: it has another one
    """
    if not (folder / MAP).is_file():
        return False
    record = folder / RECORD
    found = record.read_text(encoding="utf-8") if record.exists() else "an unknown street"
    if found != _record(wanted):
        raise ValueError(
            f"{folder / MAP}: is of {found}, wanted is {_record(wanted)}; remove the folder or give another"
        )
    return True


def _record(wanted: StreetMap) -> str:
    return json.dumps(wanted._asdict())


def write_street_map(folder: Path, wanted: StreetMap) -> Path:
    """Photos, overview, a map with exact positions and one with parts of the way; shows how far it is.

    :returns: the map with exact positions, written last: where it is, all of it is
    :raises OSError: something cannot be written
    :raises ValueError: an unknown season, or more parts than places
    """
    folder.mkdir(parents=True, exist_ok=True)
    street = _street(wanted.seed, wanted.seasons[0])
    count = max(2, round(street.length / wanted.spacing))
    poses = [street.pose(arc) for arc in np.arange(count) * street.length / count]
    shots = [
        _Shot(f"{season}_{i:04}.jpg", season, pose, i)
        for season in wanted.seasons
        for i, pose in enumerate(poses)
    ]
    aerial = aerial_picture(street)
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


def _map_of(folder: Path, aerial: AerialPicture, shots: List[_Shot]) -> PlaceMap:
    height, width = aerial.image.shape[:2]
    frame = MetricFrame(FRAME, aerial.resolution, (*aerial.corner, 0.0))
    overview = Overview(OVERVIEW, width, height)
    photos = [
        NewPhoto(shot.image, *frame.pixel(overview, *shot.pose[:2]), frame.photo_yaw(shot.pose[2]))
        for shot in shots
    ]
    return add_photos(PlaceMap(folder, overview, (), frame), photos).place_map


def _take(folder: Path, wanted: StreetMap, shot: _Shot) -> None:
    _write(
        folder / shot.image,
        street_view(_street(wanted.seed, shot.season), shot.pose, wanted.size, shot.number),
    )


def _write(path: Path, image: np.ndarray) -> None:
    """:param image: grey or BGR"""
    if not cv2.imwrite(str(path), image, [cv2.IMWRITE_JPEG_QUALITY, QUALITY]):
        raise OSError(f"{path}: cannot be written")


@functools.lru_cache(maxsize=1)  # the photos come season by season
def _street(seed: int, season: str) -> Street:
    return Street(seed, CONDITIONS[season])
