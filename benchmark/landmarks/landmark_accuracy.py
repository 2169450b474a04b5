# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Consistency of the filter's covariance with known data association.

Seeded drives; the filter is given the initial pose and the noise of the world. NEES (Bar-Shalom, Li and
Kirubarajan 2001, section 5.4) over its degrees of freedom is 1 for a consistent filter: 3 of the pose, and
two for every landmark in the map so far, with all cross covariances. A step is in its band if the sum over
all drives is within the 95 % interval of its chi-squared distribution.

The covariance is of errors in the form of the filter: additive, or right-invariant, where the heading error
rotates everything about the origin. `plain` uses additive errors and the published covariance in the map
frame, which cannot represent how the map bends with the heading error. `each` does so for every landmark
alone.
"""

from typing import Dict, Iterator, List, NamedTuple, Tuple

import numpy as np
from scipy.stats import chi2
from tables import Row, Table, Value

from landmarks.landmark_drives import EXACT, make_filter, nees, observation_2d, pose_error, rms
from sextant.geometry.plane_poses import rotation
from sextant.simulation.landmark_world import LandmarkWorld, LandmarkWorldParams, SimulationStep

RUNS, DURATION = 50, 300.0  # seconds
BAND, SHARE = (0.9, 1.15), 90.0  # of NEES over its degrees of freedom; % of the steps in their 95 % band
COLUMNS = ["pose NEES", "pose in band, %", "map NEES", "map in band, %", "plain: pose", "map", "each"]
COLUMNS += ["pose, cm", "map, cm", "heading, deg"]


class Errors(NamedTuple):
    """Errors x, y, heading of the pose, then x, y of each landmark, and their covariance."""

    errors: np.ndarray
    covariance: np.ndarray

    @property
    def pose_nees(self) -> float:
        return nees(self.errors[:3], self.covariance[:3, :3])

    @property
    def map_nees(self) -> float:
        return nees(self.errors[3:], self.covariance[3:, 3:])


class Judged(NamedTuple):
    """Errors of the filter after one scan."""

    pose_nees: float
    map_nees: float
    plain_pose: float
    plain_map: float
    each: float  # sum over the landmarks
    known: int  # landmarks
    pose_square: float  # squared error, square metres
    map_square: float  # sum over the landmarks
    heading: float  # radians


def _additive(plain: Errors, estimate: np.ndarray, truth: np.ndarray) -> Errors:
    return plain


def _right_invariant(plain: Errors, estimate: np.ndarray, truth: np.ndarray) -> Errors:
    """xi of truth = exp(xi) estimate in SE_{1+n}(2), the right-invariant error: with heading error a,
    p = R(a) p^ + J(a) xi_p of robot and landmarks, whose positions are rows."""
    angle = plain.errors[2]
    sine, cosine = np.sinc(angle / np.pi), 0.5 * angle * np.sinc(0.5 * angle / np.pi) ** 2
    J = np.array([[sine, -cosine], [cosine, sine]])
    xi = np.linalg.solve(J, (truth - estimate @ rotation(angle).T).T).T
    shear = np.eye(len(plain.errors))
    shear[:2, 2] = (estimate[0, 1], -estimate[0, 0])
    shear[3:, 2] = np.column_stack([estimate[1:, 1], -estimate[1:, 0]]).ravel()
    return Errors(np.array([*xi[0], angle, *xi[1:].ravel()]), shear @ plain.covariance @ shear.T)


FORMS = {"invariant": _right_invariant, "additive": _additive}  # errors by form


def accuracy_tables(quick: bool) -> List[Table]:
    """One table; a quick run has few short drives, without bars."""
    runs, duration = (3, 20.0) if quick else (RUNS, DURATION)
    judged: Dict[str, list] = {form: [] for form in FORMS}
    for seed in range(runs):
        world = LandmarkWorld(LandmarkWorldParams(seed=seed, duration=duration))
        steps = list(world.steps())
        for form in FORMS:
            judged[form].append(list(judged_drive(world, steps, form)))
    figures = {form: np.array(judged[form]).transpose(2, 0, 1) for form in FORMS}  # field, drive, step
    title = f"{runs} drives of {duration:g} s among 15 landmarks of 3 classes, known association"
    rows = [_row(form, Judged(*figures[form]), figures, quick) for form in FORMS]
    samples = {form: Judged(*figures[form]).pose_nees.mean(axis=0) / 3 for form in FORMS}
    return [Table(title, COLUMNS, rows, samples)]


def judged_drive(world: LandmarkWorld, steps: List[SimulationStep], form: str) -> Iterator[Judged]:
    """After every scan."""
    landmark_filter = make_filter(form, world.start, EXACT)
    index_of: Dict[int, int] = {}  # of the filter's landmarks, in their order
    for step in steps:
        landmark_filter.predict(step.odometry_step, step.noise)
        if step.scan:
            known = [seen for seen in step.scan.observations if seen.truth in index_of]
            indices = [index_of[seen.truth] for seen in known]
            landmark_filter.update(indices, [observation_2d(seen) for seen in known])
            for seen in step.scan.observations:
                if seen.truth not in index_of:
                    index_of[seen.truth] = landmark_filter.add(observation_2d(seen))
            yield _judged(form, landmark_filter, step.pose, world.positions[list(index_of)])


def _judged(form: str, landmark_filter, pose: np.ndarray, truth: np.ndarray) -> Judged:
    P, off, known = landmark_filter.covariance, pose_error(pose, landmark_filter.pose), len(truth)
    landmarks = np.array([each.position for each in landmark_filter.landmarks]).reshape(known, 2)
    estimate, errors = np.vstack([landmark_filter.pose[:2], landmarks]), truth - landmarks
    plain = Errors(np.concatenate([off, errors.ravel()]), P)
    own = FORMS[form](plain, estimate, np.vstack([pose[:2], truth]))
    return Judged(
        own.pose_nees,
        own.map_nees,
        plain.pose_nees,
        plain.map_nees,
        sum(nees(error, P[at : at + 2, at : at + 2]) for error, at in zip(errors, range(3, len(P), 2))),
        known,
        off[:2] @ off[:2],
        np.sum(errors**2),
        off[2],
    )


def _row(form: str, own: Judged, figures: Dict[str, np.ndarray], quick: bool) -> Row:
    barred = form == "invariant" and not quick
    low, high = BAND if barred else (None, None)
    share = SHARE if barred else None
    pose_most, map_most = _off(Judged(*figures["additive"])) if barred else (None, None)
    pose_off, map_off = _off(own)
    freedoms = 2 * own.known.sum()
    return form, [
        Value(own.pose_nees.mean() / 3, 3, at_least=low, at_most=high),
        Value(100 * in_band(own.pose_nees, np.full_like(own.known, 3)), 1, at_least=share),
        Value(own.map_nees.sum() / freedoms, 3, at_least=low, at_most=high),
        Value(100 * in_band(own.map_nees, 2 * own.known), 1, at_least=share),
        Value(own.plain_pose.mean() / 3, 3),
        Value(own.plain_map.sum() / freedoms, 3),
        Value(own.each.sum() / freedoms, 3),
        Value(pose_off, 2, at_most=pose_most),
        Value(map_off, 2, at_most=map_most),
        Value(np.degrees(rms(own.heading**2)), 2),
    ]


def _off(judged: Judged) -> Tuple[float, float]:
    """RMSE of the position, and of the landmarks, centimetres."""
    return 100 * rms(judged.pose_square), 100 * float(np.sqrt(judged.map_square.sum() / judged.known.sum()))


def in_band(values: np.ndarray, freedoms: np.ndarray) -> float:
    """Share of the steps (columns) whose sum over the drives (rows) is in its 95 % band."""
    low, high = (chi2.ppf(part, freedoms.sum(axis=0)) for part in (0.025, 0.975))
    total = values.sum(axis=0)
    return float(np.mean((total > low) & (total < high)))
