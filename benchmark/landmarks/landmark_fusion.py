# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Fusion of odometry and printed markers: a minute in a corridor without markers, with wheel slip."""

from typing import Iterator, List, NamedTuple, Optional, Tuple

import numpy as np
from scipy.linalg import block_diag
from scipy.stats import chi2
from simulated_observations import T_BASE_CAMERA, SimulatedCamera
from tables import Table, Value

import sextant
from landmarks.landmark_drives import nees, pose_error
from sextant.geometry.plane_poses import composed, relative
from sextant.simulation.motion import FigureEight
from sextant.simulation.room_markers import default_map

RATE, EVERY = 20.0, 2  # Hz of odometry; an image at every second reading
ROOM, CORRIDOR, AGAIN = 40.0, 60.0, 15.0  # seconds
CORRIDOR_LEGS = (
    (0.5, 0.0, 26.0),
    (0.3, np.pi / 8, 8.0),
    (0.5, 0.0, 26.0),
)  # m/s, rad/s, s: out, round and back
CIRCLE = (0.3, 0.4)  # m/s and rad/s: in the room again
SLIP_DISTANCE, SLIP, SLIP_TURN = (
    5.0,
    0.15,
    0.05,
)  # metres between slips; standard deviations of one, metres and radians
WORN = 1.02  # scale of odometry with worn wheels
START = np.array([0.05, 0.05, 0.03])  # standard deviations of the initial pose, metres and radians
THREE_SIGMA = chi2.ppf(0.9973, 3)
PLANE = sextant.MarkerLandmarkParams()
PLANE.tilt_sigma = 0.0  # the floor is level
JUMP = 0.1  # metres; smaller corrections are not counted
RUNS = 40
WITHIN, ONCE = 95.0, 95.0  # bars, % of the runs


class Drive(NamedTuple):
    """A run: times from 0 on, seconds."""

    truth: np.ndarray  # (n, 3) x, y, heading in the map
    odometry: np.ndarray  # (n, 3) in odom


class Outcome(NamedTuple):
    """Correction by the first marker after the corridor."""

    drift: float  # metres, pose error before
    error: float  # metres, pose error after
    squared: float  # Mahalanobis distance of the error in x, y, heading
    jumps: int  # corrections of map -> odom that move the robot by more than JUMP
    scale: float  # estimated scale of odometry


def noise_params():
    """Noise with slip: the variances add."""
    params = sextant.OdometryNoiseParams()
    params.translation_from_translation = np.hypot(0.02, SLIP / np.sqrt(SLIP_DISTANCE))
    params.rotation_from_translation = np.hypot(0.02, SLIP_TURN / np.sqrt(SLIP_DISTANCE))
    params.rotation_from_rotation, params.translation_from_rotation, params.lateral_from_translation = (
        0.05,
        0.01,
        0.01,
    )
    return params


def drive(seed: int, slip_steps: int = 1) -> Drive:
    """Draws a trajectory and its odometry. :param slip_steps: readings of odometry that a slip lasts"""
    rng, params = np.random.default_rng([seed, 7]), noise_params()
    truth = list(_path())
    slips = np.zeros((len(truth) + slip_steps, 3))
    odometry = [np.zeros(3)]
    for number, (last, pose) in enumerate(zip(truth, truth[1:])):
        step = relative(last, pose)
        distance, turn = np.hypot(*step[:2]), abs(step[2])
        sigmas = [0.02 * np.sqrt(distance), params.lateral_from_translation * np.sqrt(distance), 0.0]
        sigmas[2] = np.hypot(0.02 * np.sqrt(distance), params.rotation_from_rotation * np.sqrt(turn))
        measured = step * (WORN, 1.0, 1.0) + sigmas * rng.standard_normal(3)
        if (
            rng.random() < distance / SLIP_DISTANCE and number < (ROOM + CORRIDOR) * RATE
        ):  # none while markers correct the pose
            slip = rng.standard_normal(3) * (SLIP, 0.0, SLIP_TURN)
            slips[number : number + slip_steps] += slip / slip_steps
        odometry.append(composed(odometry[-1], measured + slips[number]))
    return Drive(np.array(truth), np.array(odometry))


def _path() -> Iterator[np.ndarray]:
    """Poses (3,): eights in the room, the corridor, the room again."""
    eight = FigureEight()
    for k in range(round(ROOM * RATE)):
        motion = eight.at(k / RATE)
        pose = np.array([motion.x, motion.y, motion.yaw])
        yield pose
    for speed, turn_rate, seconds in (*CORRIDOR_LEGS, (*CIRCLE, AGAIN)):
        for _ in range(round(seconds * RATE)):
            pose = composed(pose, np.array([speed, 0.0, turn_rate]) / RATE)
            yield pose


def observations(camera: SimulatedCamera, pose: np.ndarray, marker_map) -> list:
    """sextant.LabelledObservation of all markers in view."""
    T_map_base = sextant.pose_from_xyz_rpy([*pose[:2], 0.0], [0.0, 0.0, pose[2]])
    view = camera.view(T_map_base, camera.visible(T_map_base, marker_map))
    sizes, found = {marker.id: marker.size for marker in marker_map.markers}, []
    for detection in view.detections:
        size = sizes[detection.id]
        poses = sextant.solve_marker_pose(camera.model, detection.corners, size)
        if poses is None:
            continue
        other = 0.0
        if poses.alternative is not None:
            errors = poses.best.reprojection_error, poses.alternative.reprojection_error
            other = sextant.alternative_pose_probability(*errors, camera.sigma)
        covariance = sextant.marker_pose_covariance(
            camera.model, poses.best.T_camera_marker, size, camera.sigma
        )
        given = detection.family, detection.id, poses.best.T_camera_marker, covariance, other
        found.append(sextant.SeenMarker(*given))
    return sextant.marker_observations(found, T_BASE_CAMERA, PLANE)


def timeline(start: np.ndarray, marker_map, known: bool):
    """A filter with an initial error of START, with the marker map or without."""
    params, times = sextant.LandmarkSlamParams(), sextant.LandmarkTimelineParams()
    params.filter.scale_sigma = 0.05
    params.sensor.max_range, params.sensor.field_of_view = 8.0, 1.4
    times.odometry = noise_params()
    covariance = np.diag(START) ** 2
    slam = sextant.LandmarkSlam(params, start, covariance)
    if known:
        landmarks, labels, blocks = sextant.marker_landmarks(marker_map)
        slam.set_map(start, landmarks, labels, block_diag(covariance, *blocks))
    return sextant.LandmarkTimeline(times, slam)


def outcome(seed: int, known: bool) -> Outcome:
    """One run; the doors of the corridor are closed."""
    run, camera, marker_map = drive(seed), SimulatedCamera("plumb_bob 0", seed=seed), default_map()
    off = START * np.random.default_rng([seed, 8]).standard_normal(3)
    line = timeline(run.truth[0] + off, marker_map, known)
    drift, first, jumps = 0.0, None, 0
    for k, (truth, odometry) in enumerate(zip(run.truth, run.odometry)):
        line.odometry(k / RATE, odometry)
        if k % EVERY or ROOM <= k / RATE < ROOM + CORRIDOR:
            continue
        seen, before = observations(camera, truth, marker_map), line.now
        line.observe(k / RATE, seen)
        moved = np.hypot(*(line.now.pose - before.pose)[:2])
        if k / RATE < ROOM or not seen:
            continue
        jumps += moved > JUMP
        if first is None:
            drift, first = np.hypot(*(before.pose - truth)[:2]), error_of(line.now, truth)
    return Outcome(drift, *first, jumps, line.slam.filter.scale)


def error_of(now, truth: np.ndarray) -> Tuple[float, float]:
    """Metres, and the squared Mahalanobis distance of x, y, heading."""
    error = pose_error(truth, now.pose)
    return float(np.hypot(*error[:2])), nees(error, now.covariance)


def fusion_tables(quick: bool) -> List[Table]:
    """With a marker map, and with markers that are mapped during the drive."""
    seeds, rows = range(2 if quick else RUNS), []
    for known, name in ((True, "known markers"), (False, "markers mapped during the drive")):
        found = [outcome(seed, known) for seed in seeds]
        rows.append((name, _cells(found, None if quick else WITHIN, ONCE if known and not quick else None)))
    columns = ["error before, m", "error after the first marker, m", "NEES / 3", "within 3 sigma, %"]
    columns += ["corrected once, %", f"scale (1 / {WORN:g} = {1 / WORN:.3f})"]
    title = f"{CORRIDOR:g} s in a corridor without markers, wheel slip, {len(seeds)} runs"
    return [Table(title, columns, rows)]


def _cells(found: List[Outcome], within: Optional[float], once: Optional[float]) -> List[Value]:
    drift, error, squared, jumps, scale = np.array(found).T
    return [
        Value(float(drift.mean())),
        Value(float(error.mean()), digits=3),
        Value(float(squared.mean() / 3.0)),
        Value(100.0 * np.mean(squared <= THREE_SIGMA), 1, at_least=within),
        Value(100.0 * np.mean(jumps <= 1), 1, at_least=once),
        Value(float(scale.mean()), digits=3),
    ]
