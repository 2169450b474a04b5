# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Metric pose of an image from the points of a place map near a recognized photo."""

from typing import NamedTuple, Optional

import numpy as np

import sextant
from sextant.geometry.poses import R_BODY_OPTICAL
from sextant.place_points.camera_pose_fit import MAX_ERROR, PointMatches, fit_camera_pose
from sextant.place_points.place_points import PlacePoints
from sextant.place_points.point_keypoints import PointKeypointExtractor, PointKeypoints
from sextant.place_points.point_tracks import MAX_RATIO, neighbours, squared_distances

CANDIDATES = 5  # photos whose points are matched: the recognized one and its neighbours
MIN_INLIERS = 15  # points that must fit the pose
MIN_SHARE = 0.2  # of the matches that must fit the pose
MIN_PHOTO_INLIERS = 3  # of them in each of at least two photos
# Inliers that are false matches; fitted on simulated streets in another season. One of n inliers, with an
# error of up to MAX_ERROR standard deviations, adds up to MAX_ERROR^2 / n of the variance.
FALSE_INLIERS = 2


class MetricPose(NamedTuple):
    """Pose of a camera in a map."""

    T_map_camera: np.ndarray  # (4, 4) of the optical frame (z forward), metres
    covariance: np.ndarray  # (6, 6) of sextant.pose_error(): position, rotation about the map's axes; m, rad
    inliers: int  # number of points that fit

    def T_map_body(self) -> np.ndarray:
        """Pose (4, 4) with the axes of a robot: x forward, y left, z up; it has the same covariance."""
        T = self.T_map_camera.copy()
        T[:3, :3] = T[:3, :3] @ R_BODY_OPTICAL.T
        return T


class PointLocalizer:
    """Localizes images with the points of a map."""

    def __init__(self, points: PlacePoints):
        self._points = points
        self._number = {image: number for number, image in enumerate(points.images)}
        self._order = np.argsort(points.photo, kind="stable")  # observations by photo
        self._first = np.searchsorted(points.photo[self._order], np.arange(len(points.images) + 1))
        self._extractor = PointKeypointExtractor()

    def localize(self, image: np.ndarray, camera: "sextant.CameraModel", near: str) -> Optional[MetricPose]:
        """Metric pose; None if too few points, or only those of one photo, agree on it.

        :param image: uint8, (height, width) grey or (height, width, 3) BGR
        :param near: name of the photo that shows the same place; without a pose there is no metric pose
        :raises ValueError: the image does not have the camera's size
        """
        if near not in self._number:
            return None
        keypoints = self._extractor.extract(image, camera)
        rows = self._observations(self._number[near])
        keypoint, row = _matches(keypoints, self._points, rows)
        point, sigma = self._points.point[row], self._points.sigma_factor * keypoints.sigma[keypoint]
        matches = PointMatches(
            self._points.xyz[point], self._points.covariances[point], keypoints.xy[keypoint], sigma
        )
        fit = fit_camera_pose(matches)
        if fit is None or not _agree(fit.inliers, self._points.photo[row]):
            return None
        count = int(fit.inliers.sum())
        factor = self._points.covariance_factor * (1 + FALSE_INLIERS * MAX_ERROR**2 / count)
        return MetricPose(fit.T_map_camera, factor * fit.covariance, count)

    def _observations(self, photo: int) -> np.ndarray:
        """Rows of the observations in a photo and its neighbours."""
        photos = [photo, *neighbours(self._points.poses, photo, CANDIDATES - 1)]
        return np.concatenate([self._order[self._first[each] : self._first[each + 1]] for each in photos])


def _matches(keypoints: PointKeypoints, points: PlacePoints, rows: np.ndarray):
    """Keypoints and the observations of the points that they match, at most one keypoint per point."""
    none = np.zeros(0, int)
    if not len(rows) or not len(keypoints.xy):
        return none, none
    distances = squared_distances(keypoints.descriptors, points.descriptors[rows])
    nearest, point = distances.argmin(axis=1), points.point[rows]
    best = distances[np.arange(len(distances)), nearest]
    distances[point[nearest][:, None] == point] = np.inf
    found = np.flatnonzero(best < MAX_RATIO**2 * distances.min(axis=1))
    found = found[np.argsort(best[found], kind="stable")]
    found = found[np.unique(point[nearest[found]], return_index=True)[1]]
    return found, rows[nearest[found]]


def _agree(inliers: np.ndarray, photo: np.ndarray) -> bool:
    """Whether enough matches fit, in at least two photos."""
    in_photo = np.sort(np.bincount(photo[inliers]))[::-1]
    enough = inliers.sum() >= max(MIN_INLIERS, MIN_SHARE * len(inliers))
    return bool(enough and len(in_photo) > 1 and in_photo[1] >= MIN_PHOTO_INLIERS)
