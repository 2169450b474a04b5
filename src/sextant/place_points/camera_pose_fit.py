# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pose of a camera with covariance from points with covariances (perspective-n-point problem)."""

from typing import NamedTuple, Optional, Tuple

import cv2
import numpy as np

import sextant

ITERATIONS = 10  # of reweighted Gauss-Newton
HUBER = 2.0  # standard deviations of a reprojection error, above which it counts less
# E(psi^2) / E(psi')^2 by E(w r^2) / E(w) for normal errors in two dimensions and this HUBER
EFFICIENCY = 1.08
MAX_ERROR = 3.0  # standard deviations, above which a match is an outlier
MIN_POINTS = 6  # for a pose with a covariance
GATE = 8.0  # standard deviations of a keypoint in the search for inliers; those of the points are not in it
RANSAC_ROUNDS, CONFIDENCE = 500, 0.9999


class PointMatches(NamedTuple):
    """Points of the map and where an image shows them."""

    xyz: np.ndarray  # (n, 3) metres, in the map's frame
    covariances: np.ndarray  # (n, 3, 3) m^2
    xy: np.ndarray  # (n, 2) normalized image coordinates (x / z, y / z)
    sigma: np.ndarray  # (n,) standard deviation of each coordinate


class CameraPoseFit(NamedTuple):
    """Pose of the optical frame."""

    T_map_camera: np.ndarray  # (4, 4) metres
    covariance: np.ndarray  # (6, 6) of sextant.pose_error(): position, rotation about the map's axes; m, rad
    inliers: np.ndarray  # bool (n,) matches that fit


def fit_camera_pose(matches: PointMatches) -> Optional[CameraPoseFit]:
    """Robust pose; None if fewer than MIN_POINTS matches fit one."""
    T = _by_ransac(matches)
    if T is None:
        return None
    inliers = np.ones(len(matches.xyz), bool)
    for _ in range(ITERATIONS):
        errors, J, S_inverse = _linearized(matches, T)
        squared = np.einsum("ni,nij,nj->n", errors, S_inverse, errors)
        inliers = squared < MAX_ERROR**2
        if inliers.sum() < MIN_POINTS:
            return None
        weight = inliers * np.minimum(1, HUBER / np.sqrt(np.maximum(squared, 1e-12)))
        WJ = weight[:, None, None] * np.einsum("nij,njk->nik", S_inverse, J)
        A = np.einsum("nji,njk->ik", J, WJ)
        step = np.linalg.solve(A, np.einsum("nji,nj->i", WJ, errors))
        T = sextant.perturbed(T, step)
    return CameraPoseFit(T, _covariance(A, squared, weight), inliers)


def _covariance(A: np.ndarray, squared: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Asymptotic covariance of the M-estimator, scaled by the errors that are left (Huber 1981, ch. 7)."""
    left = (weight * squared).sum() / (2 * (weight > 0).sum() - 6)
    return EFFICIENCY * left * np.linalg.inv(A)


def _by_ransac(matches: PointMatches) -> Optional[np.ndarray]:
    """T_map_camera that most matches fit."""
    if len(matches.xyz) < MIN_POINTS:
        return None
    gate = GATE * float(np.median(matches.sigma))
    centre = matches.xyz.mean(axis=0)  # of the coordinates: OpenCV has little precision far from the origin
    cv2.setRNGSeed(1)
    found, rotation, translation, _ = cv2.solvePnPRansac(
        matches.xyz - centre, matches.xy, np.eye(3), None, iterationsCount=RANSAC_ROUNDS,
        reprojectionError=gate, confidence=CONFIDENCE, flags=cv2.SOLVEPNP_AP3P,
    )  # fmt: skip
    if not found:
        return None
    R = cv2.Rodrigues(rotation)[0]
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R.T, centre - R.T @ translation[:, 0]
    return T


def _linearized(matches: PointMatches, T: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Errors (n, 2), their Jacobians (n, 2, 6) by a perturbation of T, inverse covariances (n, 2, 2)."""
    R = T[:3, :3]
    offset = matches.xyz - T[:3, 3]
    p = offset @ R
    z = np.maximum(p[:, 2], 1e-3)
    xy = p[:, :2] / z[:, None]
    by_p = np.zeros((len(p), 2, 3))
    by_p[:, 0, 0] = by_p[:, 1, 1] = 1 / z
    by_p[:, :, 2] = -xy / z[:, None]
    by_xyz = by_p @ R.T
    # p = R' Exp(-delta) (xyz - t - dt): the derivative by delta of Exp(-delta) v is the cross product [v]
    skew = np.zeros((len(p), 3, 3))
    skew[:, 0, 1], skew[:, 0, 2], skew[:, 1, 2] = -offset[:, 2], offset[:, 1], -offset[:, 0]
    skew -= skew.transpose(0, 2, 1)
    J = np.concatenate([-by_xyz, by_xyz @ skew], axis=2)
    S = by_xyz @ matches.covariances @ by_xyz.transpose(0, 2, 1)
    S += matches.sigma[:, None, None] ** 2 * np.eye(2)
    errors = np.where(p[:, 2:] > 1e-3, matches.xy - xy, 1e3)
    return errors, J, np.linalg.inv(S)
