# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Points of a place map, cached beside the map.

The cache is an npz file without pickled objects, with a checksum of each array. Its key is a digest of the
poses, of the photos, of their depth images and of the version; with another one the points are triangulated
again.
"""

import hashlib
import json
import zipfile
from pathlib import Path
from typing import Callable, Dict, Optional, Tuple

import numpy as np

from sextant.base.atomic_file import atomic_file
from sextant.images.photo_depth import depth_path
from sextant.place_maps.photo_poses import PosedPhoto, poses_path, read_photo_poses
from sextant.place_maps.place_map import MetricFrame, PlaceMap
from sextant.place_points.place_points import PlacePoints, posed_keypoints, triangulated_points

VERSION = 1  # to be increased when the points of the same photos change
_ARRAYS = {
    "poses": (float, (-1, 4, 4)), "xyz": (float, (-1, 3)), "covariances": (float, (-1, 3, 3)),
    "point": (np.int32, (-1,)), "photo": (np.int32, (-1,)), "descriptors": (np.uint8, (-1, 128)),
    "factors": (float, (2,)),
}  # fmt: skip


def points_path(map_path: Path) -> Path:
    """Path of a map's cache."""
    return map_path.with_name(map_path.name + ".points")


def points_of_map(
    map_path: Path, place_map: PlaceMap, jobs: int = 1, report: Callable[[str], None] = lambda line: None
) -> Optional[PlacePoints]:
    """Points of a map; None if its photos have no poses. Reads the cache, or triangulates and writes it.

    :param jobs: processes that extract keypoints
    :param report: called with each progress message
    :raises OSError: a file cannot be read
    :raises ValueError: the poses are invalid, or in another frame than the map
    :raises JobError: a photo cannot be used
    """
    if not poses_path(map_path).is_file():
        return None
    photos = _posed_photos(map_path, place_map)
    key, path = _key(map_path, place_map, photos), points_path(map_path)
    points = _cached(path, key, tuple(photos), report)
    if points is None:
        report(f"{map_path}: triangulating the points of {len(photos)} photos")
        keypoints = posed_keypoints(place_map.folder, list(photos.items()), jobs)
        poses = np.reshape([photo.T_map_camera for photo in photos.values()], (-1, 4, 4))
        points = triangulated_points(tuple(photos), poses, keypoints)
        _store(path, key, points, report)
    if not len(points.xyz):
        report(f"{map_path}: no point could be triangulated, so there are no metric poses")
    return points


def _posed_photos(map_path: Path, place_map: PlaceMap) -> Dict[str, PosedPhoto]:
    """The photos of the map that have poses, in its order."""
    poses, place = read_photo_poses(poses_path(map_path)), place_map.georeference
    if not isinstance(place, MetricFrame) or place.frame != poses.frame:
        what = f"its poses are in '{poses.frame}', which is not the map's frame"
        raise ValueError(f"{poses_path(map_path)}: {what}")
    images = [photo.image for photo in place_map.photos]
    return {image: poses.photos[image] for image in images if image in poses.photos}


def _key(map_path: Path, place_map: PlaceMap, photos: Dict[str, PosedPhoto]) -> str:
    digest = hashlib.blake2b(f"{VERSION}".encode(), digest_size=16)
    digest.update(poses_path(map_path).read_bytes())
    for image in photos:
        photo = place_map.folder / image
        digest.update(image.encode())
        for path in (photo, *filter(Path.exists, [depth_path(photo)])):
            digest.update(hashlib.blake2b(path.read_bytes(), digest_size=16).digest())
    return digest.hexdigest()


def _store(path: Path, key: str, points: PlacePoints, report: Callable[[str], None]) -> None:
    factors = [points.sigma_factor, points.covariance_factor]
    arrays = {name: getattr(points, name) for name in _ARRAYS if name != "factors"}
    try:
        with atomic_file(path, "wb") as file:
            np.savez(file, key=np.array(json.dumps(key)), factors=np.array(factors), **arrays)
    except OSError as error:
        report(f"the points cannot be cached, every start has to triangulate them: {error}")


def _cached(
    path: Path, key: str, images: Tuple[str, ...], report: Callable[[str], None]
) -> Optional[PlacePoints]:
    """The cached points; None if there are none, or those of other photos."""
    try:
        return _read(path, key, images)
    except FileNotFoundError:
        return None
    except (OSError, EOFError, ValueError, KeyError, TypeError, zipfile.BadZipFile) as error:
        report(f"{path}: {error}; the points are triangulated again")
        return None


def _read(path: Path, key: str, images: Tuple[str, ...]) -> PlacePoints:
    with np.load(path, allow_pickle=False) as file:
        if json.loads(str(file["key"])) != key:
            raise ValueError("is of other photos or poses")
        arrays = {name: file[name] for name in _ARRAYS}
    for name, (kind, shape) in _ARRAYS.items():
        arrays[name] = arrays[name].astype(kind, casting="same_kind").reshape(shape)
    sigma_factor, covariance_factor = arrays.pop("factors").tolist()
    points = PlacePoints(images, **arrays, sigma_factor=sigma_factor, covariance_factor=covariance_factor)
    _check(points)
    return points


def _check(points: PlacePoints) -> None:
    lengths = [(len(points.photo), len(points.point)), (len(points.descriptors), len(points.point))]
    lengths += [(len(points.covariances), len(points.xyz)), (len(points.poses), len(points.images))]
    fits = all(length == expected for length, expected in lengths)
    for index, size in ((points.point, len(points.xyz)), (points.photo, len(points.images))):
        fits = fits and bool(np.all((index >= 0) & (index < size)))
    if not fits:
        raise ValueError("its arrays do not fit together")
