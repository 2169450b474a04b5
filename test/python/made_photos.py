# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Photos of places that the tests make: smooth noise, of which no two are alike."""

from pathlib import Path
from typing import Optional

import cv2
import numpy as np

from sextant.place_maps.place_map import Overview, Photo, PlaceMap
from sextant.place_maps.place_map_file import write_place_map
from sextant.places.index_params import IndexParams
from sextant.places.photo_features import extract_all
from sextant.places.place_index import PlaceIndex


def picture(seed: int, size=(320, 240)) -> np.ndarray:
    """uint8 (height, width): corners and blobs of several sizes."""
    rng = np.random.default_rng(seed)
    image = np.zeros((size[1], size[0]), np.float32)
    for cells in (6, 12, 24, 48):
        small = rng.normal(size=(cells, cells)).astype(np.float32)
        image += cv2.resize(small, size, interpolation=cv2.INTER_CUBIC) * 40
    return np.clip(128 + image, 0, 255).astype(np.uint8)


def shifted(image: np.ndarray, dx: int, dy: int, noise: float = 3.0, seed: int = 0) -> np.ndarray:
    """What a camera sees a bit farther on."""
    moved = np.roll(image, (dy, dx), (0, 1)).astype(np.float32)
    return np.clip(moved + np.random.default_rng(seed).normal(0, noise, image.shape), 0, 255).astype(np.uint8)


def written_photos(folder: Path, count: int, first: int = 0) -> PlaceMap:
    """A map file park.txt in the folder, with photos of seeds first, first + 1, … ten pixels apart."""
    photos = []
    for i in range(first, first + count):
        cv2.imwrite(str(folder / f"{i}.png"), picture(i))
        photos.append(Photo(i, f"{i}.png", 10.0 * i, 50.0))
    place_map = PlaceMap(folder, Overview("park.png", 1000, 100), tuple(photos))
    write_place_map(folder / "park.txt", place_map)
    return place_map


def index_of(place_map: PlaceMap, settings: Optional[IndexParams] = None) -> PlaceIndex:
    """Of the photos of a map, without a cache."""
    settings = settings or IndexParams()
    images = [photo.image for photo in place_map.photos]
    features = extract_all(settings, [place_map.folder / image for image in images])
    return PlaceIndex.built(settings, images, features)
