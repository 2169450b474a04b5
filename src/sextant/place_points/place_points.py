# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Points of a place map: keypoints triangulated between photos with known poses, or with depth."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import List, Optional, Sequence, Tuple

import numpy as np
from scipy.stats import chi2

import sextant
from sextant.base.jobs import run_jobs
from sextant.images.photo_depth import read_photo_depth
from sextant.images.photo_file import decode_grey
from sextant.place_maps.photo_poses import PosedPhoto
from sextant.place_points.camera_pose_fit import PointMatches, fit_camera_pose
from sextant.place_points.point_keypoints import PointKeypointExtractor, PointKeypoints
from sextant.place_points.point_tracks import point_tracks
from sextant.place_points.point_triangulation import Observations, Points, triangulated

MIN_MATCHES = 20  # of a photo that takes part in the calibration of the covariance
MIN_POSES, MAX_POSES = 8, 200  # photos in the calibration; with fewer its result is not used
DEFAULT_FACTOR = 2.0  # of covariances in a map with fewer photos; typical of simulated streets
QUANTILE = 0.9  # of the photos' NEES that is compared with its distribution: near the regions that are used
FIRST_FACTOR = 2.0  # of the noise of keypoints, before it is known
ROUNDS = 2  # of the estimation of the noise
NORMAL = 1.4826  # standard deviation of a normal distribution by the median of its absolute values


@dataclass(frozen=True)
class PlacePoints:
    """Points, and their observations in the photos."""

    images: Tuple[str, ...]  # photos, as named in the map
    poses: np.ndarray  # T_map_camera (photos, 4, 4) of the optical frames, metres
    xyz: np.ndarray  # (m, 3) points, metres
    covariances: np.ndarray  # (m, 3, 3) m^2
    point: np.ndarray  # int (n,) point of each observation
    photo: np.ndarray  # int (n,) photo of each observation
    descriptors: np.ndarray  # uint8 (n, 128) of each observation
    sigma_factor: float  # by which the noise of keypoints exceeds that of PointKeypoints
    covariance_factor: float  # by which covariances of fitted poses are too small


def posed_keypoints(
    folder: Path, photos: Sequence[Tuple[str, PosedPhoto]], jobs: int = 1
) -> List[PointKeypoints]:
    """Reads photos and extracts their keypoints, with a progress bar.

    :param photos: with their names in the folder
    :raises OSError, ValueError: a photo cannot be used
    """
    names = [name for name, _ in photos]
    return list(run_jobs(partial(_keypoints, folder), photos, jobs, names=names, progress="keypoints"))


def _keypoints(folder: Path, photo: Tuple[str, PosedPhoto]) -> PointKeypoints:
    path, camera = folder / photo[0], photo[1].camera.model()
    return PointKeypointExtractor().extract(
        decode_grey(path.read_bytes(), path), camera, read_photo_depth(path)
    )


def triangulated_points(
    images: Sequence[str], poses: np.ndarray, keypoints: Sequence[PointKeypoints]
) -> PlacePoints:
    """Triangulates the points of a map.

    :param images: names of the photos
    :param poses: T_map_camera (photos, 4, 4) of the optical frames, metres
    """
    seen, rows = point_tracks(poses, keypoints)
    count = int(seen.point.max()) + 1 if len(rows) else 0
    factor = FIRST_FACTOR
    for _ in range(ROUNDS):
        assumed = seen._replace(sigma=factor * seen.sigma)
        factor *= _noise(triangulated(poses, count, assumed), assumed)
    seen = seen._replace(sigma=factor * seen.sigma)
    points = triangulated(poses, count, seen)
    none = np.zeros((0, 128), np.uint8)
    descriptors = np.concatenate([none, *(each.descriptors for each in keypoints)])[rows]
    kept = np.cumsum(points.valid) - 1
    return PlacePoints(
        tuple(images), poses, points.xyz[points.valid], points.covariances[points.valid],
        kept[seen.point[points.used]], seen.photo[points.used], descriptors[points.used],
        factor, _covariance_factor(poses, count, seen),
    )  # fmt: skip


def _noise(points: Points, seen: Observations) -> float:
    """Ratio of the noise to its assumed standard deviation, from the median of the reprojection errors.

    The errors are smaller than the noise, as the points are fitted to them: the 2 n coordinates of n photos
    have 2 n - 3 degrees of freedom. Points of one photo have none.
    """
    point = seen.point[points.used]
    coordinates = 2 * np.bincount(point)[point]
    several = coordinates > 2
    if not several.any():
        return 1.0
    noise = np.abs(points.errors[points.used][several]) / np.sqrt(1 - 3 / coordinates[several])[:, None]
    return NORMAL * float(np.median(noise))


def _covariance_factor(poses: np.ndarray, count: int, seen: Observations) -> float:
    """Ratio of the squared errors of fitted poses to their covariances (NEES), by leaving out each photo.

    A photo is localized by points that are triangulated without it. Errors that points have in common, those
    of the poses, of the lens and of keypoints on one surface, are in no sum over single points.
    """
    photos = range(0, len(poses), 1 + len(poses) // MAX_POSES) if count else ()
    values = [_nees_without(photo, poses, seen) for photo in photos]
    known = [value for value in values if value is not None]
    if len(known) < MIN_POSES:
        return DEFAULT_FACTOR
    return max(1.0, float(np.quantile(known, QUANTILE) / chi2.ppf(QUANTILE, 6)))


def _nees_without(photo: int, poses: np.ndarray, seen: Observations) -> Optional[float]:
    """NEES of a photo's pose by the points of the other photos; None if they are too few."""
    mine = seen.photo == photo
    others = np.isin(seen.point, seen.point[mine]) & ~mine
    index, point = np.unique(seen.point[others], return_inverse=True)
    if len(index) < MIN_MATCHES:
        return None
    left = Observations(point, *(each[others] for each in seen[1:]))
    points = triangulated(poses, len(index), left)
    mine = np.flatnonzero(mine & np.isin(seen.point, index[points.valid]))
    at = np.searchsorted(index, seen.point[mine])
    xy, sigma = seen.xy[mine], seen.sigma[mine]
    fit = fit_camera_pose(PointMatches(points.xyz[at], points.covariances[at], xy, sigma))
    if fit is None or fit.inliers.sum() < MIN_MATCHES:
        return None
    error = sextant.pose_error(poses[photo], fit.T_map_camera)
    return float(error @ np.linalg.solve(fit.covariance, error))
