# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Estimates the error of a calibration from markers of known size and distance."""

import copy
from dataclasses import dataclass
from typing import Dict, List, Optional, Sequence, Tuple

import numpy as np

import sextant
from sextant.calibration.calibration_observations import Observation

# Indices into CalibrationFit.error; the errors of the tape readings follow in the state of the fit.
FOCAL, CENTRE_X, CENTRE_Y, EDGE, SIZE, ZERO = range(6)
LENS = 4  # number of lens parameters
_ROUNDS, _STEPS = 3, 15  # choices of the pose solutions, and Gauss-Newton steps after each


@dataclass(frozen=True)
class FitSigmas:
    """Standard deviations of the priors."""

    tape: float  # of a reading, common to its photos, metres; each photo has half of it in addition
    zero: float  # from the tape's zero to the projection centre, metres
    size: float  # of the markers' edges, which share one relative error, metres
    lens: float = 0.5  # fraction of the focal length, of the width for the rest; 0.5: unknown


@dataclass(frozen=True)
class CalibrationFit:
    """Maximum a posteriori estimate of the errors.

    error contains true minus given values: logarithm of the focal length; principal point x and y, pixels;
    radial distortion as a shift in the image corner, pixels; logarithm of the marker size; zero of the tape,
    metres.
    """

    error: np.ndarray  # (6,)
    covariance: np.ndarray  # (6, 6) of error
    noise_scale: float  # RMS of the corners' residuals over their sigmas
    tape_errors: Dict[float, float]  # error by reading, standard deviations
    poses: List[np.ndarray]  # T_camera_object (4, 4) of every observation


@dataclass
class _Normal:
    """Normal equations of the global parameters g; each pose p is eliminated (Schur complement)."""

    H: np.ndarray
    b: np.ndarray
    cost: float
    blocks: List[Tuple[np.ndarray, np.ndarray, np.ndarray]]  # H_pp, H_pg, b_p of every pose


def corner_radius(calibration: "sextant.CameraCalibration") -> float:
    """Returns the distance from the principal point to the farthest image corner, pixels."""
    x, y = calibration.K[0, 2], calibration.K[1, 2]
    return float(np.hypot(max(x, calibration.width - x), max(y, calibration.height - y)))


def corrected(calibration: "sextant.CameraCalibration", error: np.ndarray) -> "sextant.CameraCalibration":
    """Returns the calibration corrected by the first four elements of CalibrationFit.error."""
    result, K = copy.copy(calibration), np.array(calibration.K)
    D = list(calibration.D) or [0.0] * 5  # plumb_bob may have no coefficients
    # polynomial r (1 + k1 r^2), equidistant theta (1 + k1 theta^2): a shift of f k1 r^3 pixels
    focal = 0.5 * (K[0, 0] + K[1, 1])
    D[0] += error[EDGE] / (focal * (corner_radius(calibration) / focal) ** 3)
    K[:2, :2] *= np.exp(error[FOCAL])
    K[:2, 2] += error[[CENTRE_X, CENTRE_Y]]
    result.K, result.D, result.P = K, D, np.hstack([K, np.zeros((3, 1))])
    return result


def fit_calibration(
    calibration: "sextant.CameraCalibration", observations: Sequence[Observation], sigmas: FitSigmas
) -> CalibrationFit:
    """Bundle adjustment of poses, lens, marker size and tape errors (Gauss-Newton).

    Parameters that the photos do not determine keep a large variance. It is scaled up if the corners are
    noisier than their sigmas.

    :raises ValueError: no pose in front of the camera explains an observation
    """
    fit = _Fit(calibration, observations, sigmas)
    result = fit.run(1.0)
    return fit.run(result.noise_scale) if result.noise_scale > 1.0 else result


def start_poses(
    calibration: "sextant.CameraCalibration", observation: Observation, size_scale: float = 1.0
) -> List[np.ndarray]:
    """Returns T_camera_object (4, 4) candidates: both pose solutions of every single marker."""
    camera, poses = sextant.CameraModel(calibration), []
    for T, size, corners in zip(observation.T_object_marker, observation.sizes, observation.corners):
        planar = sextant.solve_marker_pose(camera, corners, size * size_scale)
        solutions = [planar.best, planar.alternative] if planar else []
        poses += [each.T_camera_marker @ np.linalg.inv(T) for each in solutions if each]
    return poses


class _Fit:
    def __init__(self, calibration, observations, sigmas: FitSigmas):
        self.calibration, self.observations, self.sigmas = calibration, list(observations), sigmas
        self.points = [each.points for each in self.observations]
        self.distances = sorted({each.distance for each in self.observations if each.distance is not None})
        # The prior of the lens is usually uninformative; it keeps the problem well-posed.
        pixels = sigmas.lens * calibration.width
        size = sigmas.size / float(np.mean(np.concatenate([each.sizes for each in self.observations])))
        self.prior = np.array(
            [sigmas.lens, pixels, pixels, pixels, size, sigmas.zero] + [sigmas.tape] * len(self.distances)
        )

    def run(self, noise: float) -> CalibrationFit:
        """Runs the adjustment.

        :param noise: factor on the corners' sigmas
        """
        errors, poses = np.zeros(len(self.prior)), None
        for _ in range(_ROUNDS):  # a better lens may favour the other pose solution of a marker
            poses = self._choose(errors, poses, noise)
            errors, poses, normal = self._descend(errors, poses, noise)
        residuals = [self._corner_residuals(errors, i, T, noise) for i, T in enumerate(poses)]
        freedoms = sum(r.size for r in residuals) - 6 * len(poses) - LENS
        squares = sum(float(r @ r) for r in residuals)
        scale = np.sqrt(squares / freedoms) if freedoms > 0 else 1.0
        covariance = np.linalg.inv(normal.H)[: ZERO + 1, : ZERO + 1]
        tape = dict(zip(self.distances, errors[ZERO + 1 :] / self.sigmas.tape))
        return CalibrationFit(errors[: ZERO + 1], covariance, noise * scale, tape, poses)

    def _choose(self, errors, poses, noise) -> List[np.ndarray]:
        lens, size = corrected(self.calibration, errors), float(np.exp(errors[SIZE]))
        chosen = []
        for i, observation in enumerate(self.observations):
            candidates = start_poses(lens, observation, size) + ([poses[i]] if poses else [])
            costs = [self._cost(errors, i, T, noise) for T in candidates]
            if not costs or not np.isfinite(min(costs)):
                raise ValueError(f"{observation.photo}: no pose in front of the camera explains the marker")
            chosen.append(candidates[int(np.argmin(costs))])
        return chosen

    def _cost(self, errors, i: int, T: np.ndarray, noise: float) -> float:
        residuals = self._corner_residuals(errors, i, T, noise)
        if residuals is None:
            return np.inf
        tape = self._tape_residual(errors, i, T)
        return float(residuals @ residuals) + (0.0 if tape is None else tape**2)

    def _descend(self, errors, poses, noise):
        normal, damping = self._normal(errors, poses, noise), 0.0
        for _ in range(_STEPS):
            step, moved = self._step(normal, poses, damping)
            trial = self._normal(errors + step, moved, noise)
            if trial is None or trial.cost > normal.cost * (1 + 1e-9):
                damping = max(10.0 * damping, 1e-3)
                continue
            gain, errors, poses = normal.cost - trial.cost, errors + step, moved
            normal, damping = trial, 0.1 * damping
            if gain < 1e-4:
                break
        return errors, poses, normal

    def _step(self, normal: _Normal, poses, damping: float):
        S, s = normal.H.copy(), normal.b.copy()
        S[np.diag_indices_from(S)] *= 1.0 + damping
        change = -np.linalg.solve(S, s)
        moved = []
        for T, (H_pp, H_pg, b_p) in zip(poses, normal.blocks):
            delta = -np.linalg.solve(H_pp, b_p + H_pg @ change)
            T_moved = T.copy()
            T_moved[:3, 3] += delta[:3]
            T_moved[:3, :3] = sextant.exp_so3(delta[3:]) @ T[:3, :3]
            moved.append(T_moved)
        return change, moved

    def _normal(self, errors, poses, noise: float) -> Optional[_Normal]:
        cameras = self._cameras(errors)
        cost = float(np.sum((errors / self.prior) ** 2))
        normal = _Normal(np.diag(self.prior**-2.0), errors / self.prior**2, cost, [])
        for i, T in enumerate(poses):
            rows = self._rows(cameras, errors, i, T, noise)
            if rows is None:
                return None
            r, J_p, J_g = rows
            H_pp, H_pg, b_p = J_p.T @ J_p, J_p.T @ J_g, J_p.T @ r
            normal.H += J_g.T @ J_g - H_pg.T @ np.linalg.solve(H_pp, H_pg)
            normal.b += J_g.T @ r - H_pg.T @ np.linalg.solve(H_pp, b_p)
            normal.cost += float(r @ r)
            normal.blocks.append((H_pp, H_pg, b_p))
        return normal

    def _cameras(self, errors):
        """Returns camera models at the estimate and one step along each lens parameter; the steps."""
        steps = np.diag([1e-5, 1e-2, 1e-2, 1e-2])
        lenses = [errors[:LENS], *(errors[:LENS] + step for step in steps)]
        return [sextant.CameraModel(corrected(self.calibration, each)) for each in lenses], np.diag(steps)

    def _rows(self, cameras, errors, i: int, T: np.ndarray, noise: float):
        """Returns whitened residuals and their Jacobians by the pose (camera axes) and by errors, or None."""
        (camera, *beside), steps = cameras
        spread = self.points[i] @ T[:3, :3].T * np.exp(errors[SIZE])
        p = spread + T[:3, 3]
        pixels, shifted = project(camera, p), [project(each, p) for each in beside]
        by_point = _point_derivatives(camera, p)
        if pixels is None or by_point is None or any(each is None for each in shifted):
            return None
        weights = 1.0 / (noise * np.repeat(self.observations[i].sigmas.ravel(), 2))
        r = (pixels - self.observations[i].corners.reshape(-1, 2)).ravel()
        by_rotation = -by_point @ np.cross(np.eye(3), spread[:, None])
        J_p = np.concatenate([by_point, by_rotation], axis=2).reshape(-1, 6)
        J_g = np.zeros((r.size, len(errors)))
        for column, (each, step) in enumerate(zip(shifted, steps)):
            J_g[:, column] = ((each - pixels) / step).ravel()
        J_g[:, SIZE] = (by_point @ spread[:, :, None]).ravel()
        rows = weights * r, weights[:, None] * J_p, weights[:, None] * J_g
        return self._with_tape(rows, errors, i, T)

    def _with_tape(self, rows, errors, i: int, T: np.ndarray):
        tape = self._tape_residual(errors, i, T)
        if tape is None:
            return rows
        j_p, j_g, sigma = np.zeros(6), np.zeros(len(errors)), 0.5 * self.sigmas.tape
        j_p[:3] = T[:3, 3] / np.linalg.norm(T[:3, 3]) / sigma
        j_g[[ZERO, ZERO + 1 + self.distances.index(self.observations[i].distance)]] = 1.0 / sigma
        r, J_p, J_g = rows
        return np.append(r, tape), np.vstack([J_p, j_p]), np.vstack([J_g, j_g])

    def _tape_residual(self, errors, i: int, T: np.ndarray) -> Optional[float]:
        distance = self.observations[i].distance
        if distance is None:
            return None
        reading = errors[ZERO] + errors[ZERO + 1 + self.distances.index(distance)]
        return float((np.linalg.norm(T[:3, 3]) + reading - distance) / (0.5 * self.sigmas.tape))

    def _corner_residuals(self, errors, i: int, T: np.ndarray, noise: float) -> Optional[np.ndarray]:
        p = self.points[i] @ T[:3, :3].T * np.exp(errors[SIZE]) + T[:3, 3]
        pixels = project(sextant.CameraModel(corrected(self.calibration, errors)), p)
        if pixels is None:
            return None
        observation = self.observations[i]
        return (
            (pixels - observation.corners.reshape(-1, 2)) / (noise * observation.sigmas.reshape(-1, 1))
        ).ravel()


def project(camera: "sextant.CameraModel", p: np.ndarray) -> Optional[np.ndarray]:
    """Projects points (n, 3) in the optical frame to pixels (n, 2); None if one cannot be projected."""
    pixels = [camera.project(each) for each in p]
    return None if any(each is None for each in pixels) else np.array(pixels)


def _point_derivatives(camera: "sextant.CameraModel", p: np.ndarray) -> Optional[np.ndarray]:
    """Returns the (n, 2, 3) Jacobian of the pixels by the points, or None."""
    step = 1e-6
    columns = []
    for axis in np.eye(3):
        after, before = project(camera, p + step * axis), project(camera, p - step * axis)
        if after is None or before is None:
            return None
        columns.append((after - before) / (2.0 * step))
    return np.stack(columns, axis=2)
