# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A marker seen head-on, where a square has two poses: jumps, and the branch that is published."""

from typing import List, NamedTuple, Optional, Tuple

import numpy as np
from simulated_observations import SIZE, T_BASE_CAMERA, SimulatedCamera, corners_in_map, in_camera, wall_map
from tables import Row, Table, Value

import sextant

SIZES, SIGMA = ((640, 480), (1280, 720)), 0.3  # fx 320 and 640, px
MARKER = (3.0, 0.0, 1.0, np.pi)
T_MAP_ODOM = sextant.pose_from_xyz_rpy([0.4, -0.2, 0.0], [0.0, 0.0, 0.3])
WOBBLE = 0.05  # rad
APART = 25.0  # squared Mahalanobis distance between the two solutions from which the branch counts
JUMP = 5.0  # deviations
DECIDED = sextant.LocatorParams().min_probability
ODOMETRY_NOISE = (0.03, 0.01, 0.02)  # of the way along and across it, rad per root of a metre
COLUMNS = ["published", "decided", "largest jump, both deviations", "larger deviation only", "beyond 5"]
COLUMNS += ["two branches apart", "wrong branch"]


class Estimate(NamedTuple):
    """A published pose, and the truth."""

    truth: np.ndarray
    pose: object  # sextant.LocatedPose
    wrong: Optional[bool]  # None where there is no other branch far from the truth


def head_on_tables(quick: bool) -> List[Table]:
    """With and without odometry; a quick run is a few frames, without bars."""
    frames = 40 if quick else 1000
    rows, samples = [], {}
    for size in SIZES:
        for odometry in (False, True):
            estimates = drive(size, odometry, frames)
            rows.append(_row(estimates, size, odometry, quick))
            samples[rows[-1][0]] = _samples(estimates)
    return [Table("One marker head-on from 1 to 7 m and back; jumps in deviations", COLUMNS, rows, samples)]


def drive(size, odometry: bool, frames: int) -> List[Optional[Estimate]]:
    """The poses of a drive along the marker's normal; None where none was published."""
    camera, marker_map = SimulatedCamera("plumb_bob 0", size, SIGMA), wall_map([MARKER])
    params = sextant.LocalizationParams()
    params.locator.corner_sigma, params.estimate_noise = SIGMA, False
    localization, estimates = sextant.MarkerLocalization(params), []
    for truth, T_odom_base in zip(*_odometry(frames)):
        view = camera.view(truth, marker_map.markers)
        pose = localization.locate(marker_map, [view], T_odom_base if odometry else None).pose
        estimates.append(Estimate(truth, pose, _wrong(camera, truth, pose)) if pose else None)
    return estimates


def _odometry(frames: int) -> Tuple[List[np.ndarray], List[np.ndarray]]:
    """T_map_base and T_odom_base of every frame: steps with slip."""
    random, truths = np.random.default_rng(7), [place(k, frames) for k in range(frames)]
    odometry = [np.linalg.inv(T_MAP_ODOM) @ truths[0]]
    for last, now in zip(truths, truths[1:]):
        step = np.linalg.inv(last) @ now
        way = np.linalg.norm(step[:3, 3])
        along, across, turn = random.normal(size=3) * ODOMETRY_NOISE * np.array([way, way, np.sqrt(way)])
        slip = sextant.pose_from_xyz_rpy([along, across, 0.0], [0.0, 0.0, turn])
        odometry.append(odometry[-1] @ step @ slip)
    return truths, odometry


def place(frame: int, frames: int) -> np.ndarray:
    """T_map_base: the camera from 1 m to 7 m and back, with a few degrees of wobble."""
    way = 4.0 - 3.0 * np.cos(2.0 * np.pi * frame / frames)
    yaw = WOBBLE * np.sin(0.05 * frame)
    return sextant.pose_from_xyz_rpy([MARKER[0] - way - T_BASE_CAMERA[0, 3], 0.0, 0.0], [0.0, 0.0, yaw])


def _wrong(camera: SimulatedCamera, truth: np.ndarray, pose) -> Optional[bool]:
    """Whether the pose is nearer to the other planar solution than to the truth, where the two are apart."""
    solved = sextant.solve_marker_pose(camera.model, exact_corners(camera, truth), SIZE)
    if not solved or not solved.alternative:  # exactly head-on there is but one
        return None
    T_map_marker = wall_map([MARKER]).markers[0].T_map_marker
    T_marker_camera = np.linalg.inv(solved.alternative.T_camera_marker)
    mirrored = T_map_marker @ T_marker_camera @ np.linalg.inv(T_BASE_CAMERA)
    between = _squared(sextant.pose_error(truth, mirrored), pose.covariance)
    to_truth = _squared(sextant.pose_error(truth, pose.T_map_base), pose.covariance)
    to_mirrored = _squared(sextant.pose_error(mirrored, pose.T_map_base), pose.covariance)
    return to_mirrored < to_truth if between > APART else None


def exact_corners(camera: SimulatedCamera, truth: np.ndarray) -> np.ndarray:
    """(4, 2) exact pixels: the mirrored solution is that of the scene, not of the noise."""
    return camera.project(in_camera(truth, corners_in_map(wall_map([MARKER]).markers[0])))


def jumps(estimates: List[Optional[Estimate]]) -> np.ndarray:
    """(N, 2) change of the position error between poses, in deviations of both and of the larger."""
    found = []
    for last, now in zip(estimates, estimates[1:]):
        if last and now:
            change = [each.pose.T_map_base[:3, 3] - each.truth[:3, 3] for each in (now, last)]
            P = [each.pose.covariance[:3, :3] for each in (now, last)]
            step, larger = change[0] - change[1], max(P, key=np.trace)
            found.append([np.sqrt(_squared(step, P[0] + P[1])), np.sqrt(_squared(step, larger))])
    return np.array(found).reshape(-1, 2)


def _squared(error: np.ndarray, covariance: np.ndarray) -> float:
    return float(error @ np.linalg.solve(covariance, error))


def _samples(estimates: List[Optional[Estimate]]) -> np.ndarray:
    """(N, 4) distance to the marker in m, error across the line of sight and its deviation in cm, jump."""
    found = []
    for last, now in zip([None, *estimates], estimates):
        if now:
            distance = MARKER[0] - (now.truth @ T_BASE_CAMERA)[0, 3]
            across = now.pose.T_map_base[1, 3] - now.truth[1, 3]
            jump = jumps([last, now])[:, 0].sum()
            found.append([distance, 100.0 * across, 100.0 * np.sqrt(now.pose.covariance[1, 1]), jump])
    return np.array(found).reshape(-1, 4)


def _row(estimates: List[Optional[Estimate]], size, odometry: bool, quick: bool) -> Row:
    both, larger = jumps(estimates).T
    published = [each for each in estimates if each]
    judged = [each.wrong for each in published if each.wrong is not None]
    return f"fx {size[0] // 2}, {'odometry' if odometry else 'no odometry'}", [
        Value(len(published) / len(estimates), 3),
        Value(np.mean([each.pose.probability >= DECIDED for each in published]), 3),
        Value(both.max(), at_most=None if quick else JUMP),
        Value(larger.max()),
        Value(np.sum(both > JUMP), 0),
        Value(len(judged), 0),
        Value(sum(judged), 0, at_most=0 if odometry and not quick else None),
    ]
