# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The most probable drive and map of all steps and observations (Dellaert and Kaess 2006, "Square root
SAM"): nonlinear least squares over poses x, y, heading and landmarks x, y, by Levenberg and Marquardt."""

from typing import NamedTuple, Tuple

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix, diags
from scipy.sparse.linalg import splu

ITERATIONS, TOLERANCE = 200, 1e-12  # least relative change of the cost


class DriveGraph(NamedTuple):
    """What was measured."""

    steps: np.ndarray  # (n, 3) in the frame where each begins: X' = X exp(w) step
    noises: np.ndarray  # (n, 3, 3) covariance of w
    seen: np.ndarray  # (k, 2) pose and landmark of each observation
    observations: np.ndarray  # (k, 2) in the robot frame
    covariances: np.ndarray  # (k, 2, 2)


def most_probable(
    graph: DriveGraph, poses: np.ndarray, landmarks: np.ndarray
) -> Tuple[np.ndarray, np.ndarray, float]:
    """Poses (n + 1, 3), landmarks (m, 2) and half the squared whitened residuals; the first pose stays.

    :param poses, landmarks: where the search begins
    """
    whiten = [np.linalg.inv(np.linalg.cholesky(each)) for each in (graph.noises, graph.covariances)]
    x, damping = np.concatenate([np.ravel(poses), np.ravel(landmarks)]), 1e-4
    residuals, J = _linearized(graph, whiten, x)
    for _ in range(ITERATIONS):
        A, cost = (J.T @ J).tocsc(), residuals @ residuals
        damped = splu(A + damping * diags(A.diagonal()), "MMD_AT_PLUS_A", options={"SymmetricMode": True})
        moved = x.copy()
        moved[3:] -= damped.solve(J.T @ residuals)
        after, J_after = _linearized(graph, whiten, moved)
        damping *= 0.1 if after @ after < cost else 10.0
        if after @ after < cost:
            x, residuals, J = moved, after, J_after
            if cost - after @ after < TOLERANCE * cost:
                break
    found = x[: poses.size].reshape(-1, 3)
    return found, x[poses.size :].reshape(-1, 2), 0.5 * float(residuals @ residuals)


def _linearized(graph: DriveGraph, whiten: list, x: np.ndarray) -> Tuple[np.ndarray, csr_matrix]:
    """Whitened residuals, and their derivatives by x but the first pose."""
    count = 3 * (len(graph.steps) + 1)
    poses, landmarks = x[:count].reshape(-1, 3), x[count:].reshape(-1, 2)
    by_pose = 3 * np.arange(len(poses))[:, None] + np.arange(3)
    by_landmark = count + 2 * np.arange(len(landmarks))[:, None] + np.arange(2)
    before, (number, which) = poses[:-1], graph.seen.T
    off, J = _step_errors(before, poses[1:], graph.steps)
    steps = _rows(whiten[0], off, J, np.hstack([by_pose[:-1], by_pose[1:]]))
    seen, J = _relative(poses[number], landmarks[which])
    observations = _rows(
        whiten[1], seen - graph.observations, J, np.hstack([by_pose[number], by_landmark[which]])
    )
    residuals, values, columns = (np.concatenate(parts) for parts in zip(steps, observations))
    rows = np.repeat(np.arange(len(residuals)), np.repeat([6, 5], [steps[0].size, seen.size]))
    return residuals, coo_matrix((values, (rows, columns)), (len(residuals), len(x))).tocsr()[:, 3:]


def _rows(whiten: np.ndarray, off: np.ndarray, J: np.ndarray, columns: np.ndarray) -> tuple:
    """Flat: residuals, values of the derivatives row by row, and their columns."""
    white = np.einsum("nij,nj->ni", whiten, off)
    return white.ravel(), (whiten @ J).ravel(), np.repeat(columns, off.shape[1], axis=0).ravel()


def _relative(poses: np.ndarray, points: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Points (n, 2) in the frames of poses (n, 3), and derivatives (n, 2, 5) by pose and point."""
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    R = np.array([[c, s], [-s, c]]).transpose(2, 0, 1)
    seen = np.einsum("nij,nj->ni", R, points - poses[:, :2])
    return seen, np.concatenate([-R, np.stack([seen[:, 1], -seen[:, 0]], axis=1)[:, :, None], R], axis=2)


def _step_errors(before: np.ndarray, after: np.ndarray, steps: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """(n, 3) what steps were off by, where they begin, and derivatives (n, 3, 6) by the poses around."""
    moved, by_place = _relative(before, after[:, :2])
    turned = np.remainder(after[:, 2] - before[:, 2] - steps[:, 2] + np.pi, 2 * np.pi) - np.pi
    c, s = np.cos(turned), np.sin(turned)
    U = np.column_stack([c * steps[:, 0] - s * steps[:, 1], s * steps[:, 0] + c * steps[:, 1]])
    J = np.zeros((len(steps), 3, 6))
    J[:, :2, :5] = by_place
    J[:, :2, 5] = np.column_stack([U[:, 1], -U[:, 0]])  # of -U by the turn
    J[:, :2, 2] -= J[:, :2, 5]
    J[:, 2, 2], J[:, 2, 5] = -1, 1
    return np.column_stack([moved - U, turned]), J
