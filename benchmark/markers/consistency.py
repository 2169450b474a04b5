# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Consistency of the published covariance: simulated corners against the exact pose."""

from typing import Callable, Dict, List, NamedTuple, Optional

import numpy as np
from simulated_observations import LENSES, SimulatedCamera, corners_in_map, in_camera, wall_map
from tables import Row, Table, Value

import sextant

SIZES, SIGMAS = ((640, 480), (1280, 720)), (0.1, 0.3)
FLOOR_SIGMA = 0.01  # m and rad
CHI2_95 = {6: 12.592, 3: 7.815}
DIFFERENCE = 1e-5  # m and rad, of the numeric derivative
COLUMNS = ["published", "decided", "error / bound", "error / own", "NEES 6", "NEES 3"]
COLUMNS += ["all: NEES 6", "in 95 %: 6", "in 95 %: 3"]


class Scene(NamedTuple):
    """Markers, where the robot stands, and which figures are held to bars."""

    markers: object  # sextant.MarkerMap
    place: Callable  # random -> T_map_base
    frames: int
    floor: bool
    bars: str  # decided (of the poses published as unambiguous), region (the 95 % region of all)
    walls: int = 1


class Judged(NamedTuple):
    """One published pose against the truth."""

    decided: bool
    nees: float
    nees_position: float
    over_own: float  # squared position error over the trace of its covariance
    over_bound: float  # and over that of the Cramer-Rao bound at the true pose


def _before_wall(random) -> np.ndarray:
    away, side = random.uniform(0.5, 8.0), random.uniform(-1.0, 1.0)
    x, y = 3.0 - away * np.cos(side), -away * np.sin(side)
    return sextant.pose_from_xyz_rpy([x, y, 0.0], [0.0, 0.0, side + random.uniform(-0.2, 0.2)])


def _before_corner(random) -> np.ndarray:
    x, y = random.uniform(-2.5, 2.5, 2)
    return sextant.pose_from_xyz_rpy([x, y, 0.0], [0.0, 0.0, np.pi / 4 + random.uniform(-0.4, 0.4)])


WALL = [(3.0, y, 1.2, np.pi) for y in (-0.8, 0.0, 0.8)]
CORNER = WALL + [(x, 3.0, 1.2, -np.pi / 2) for x in (0.5, 1.5, 2.5)]
ONE = [(3.0, 0.0, 1.0, np.pi)]
SCENES: Dict[str, Scene] = {
    "two walls": Scene(wall_map(CORNER), _before_corner, 1000, False, "decided", walls=2),
    "coplanar": Scene(wall_map(WALL), _before_wall, 1000, False, "decided"),
    "coplanar, floor": Scene(wall_map(WALL), _before_wall, 1000, True, "decided"),
    "one marker, floor": Scene(wall_map(ONE), _before_wall, 2000, True, "decided"),
    "one marker": Scene(wall_map(ONE), _before_wall, 2400, False, "region"),
}


_HELD = {"decided": "errors of the decided poses", "region": "the 95 % region of all poses"}


def consistency_tables(quick: bool) -> List[Table]:
    """A table a scene; a quick run is a few frames of one camera, without bars."""
    return [_table(name, scene, quick) for name, scene in SCENES.items()]


def _table(name: str, scene: Scene, quick: bool) -> Table:
    sizes, sigmas = (SIZES[:1], SIGMAS[1:]) if quick else (SIZES, SIGMAS)
    rows, samples = [], {}
    for lens in LENSES:
        for size in sizes:
            for sigma in sigmas:
                title, frames = f"{lens}, {size[0]}, {sigma} px", 20 if quick else scene.frames
                camera = SimulatedCamera(lens, size, sigma, seed=len(rows))
                judged = judge(scene, camera, frames)
                rows.append(_row(title, judged, frames, None if quick else scene.bars))
                samples[title] = np.array([each.nees for each in judged])
    return Table(f"Consistency, {name}: {_HELD[scene.bars]}", COLUMNS, rows, samples)


def judge(scene: Scene, camera: SimulatedCamera, frames: int) -> List[Judged]:
    """The published ones of so many frames that show a marker of every wall."""
    params = sextant.LocatorParams()
    params.corner_sigma = camera.sigma
    if scene.floor:
        params.floor_height_sigma = params.floor_tilt_sigma = FLOOR_SIGMA
    locator, judged = sextant.MarkerLocator(params), []
    for _ in range(frames):
        truth, markers = _look(scene, camera)
        pose = locator.locate(scene.markers, [camera.view(truth, markers)]).pose
        if pose:
            bound = np.linalg.inv(information(camera, truth, markers, FLOOR_SIGMA if scene.floor else None))
            judged.append(_judged(truth, pose, bound, params.min_probability))
    return judged


def _look(scene: Scene, camera: SimulatedCamera):
    while True:
        truth = scene.place(camera.random)
        if scene.floor:
            z, roll, pitch = camera.random.normal(size=3) * FLOOR_SIGMA
            truth = truth @ sextant.pose_from_xyz_rpy([0.0, 0.0, z], [roll, pitch, 0.0])
        markers = camera.visible(truth, scene.markers)
        if len({tuple(np.round(each.T_map_marker[:3, 2], 6)) for each in markers}) >= scene.walls:
            return truth, markers


def information(
    camera: SimulatedCamera, truth: np.ndarray, markers: list, floor: Optional[float]
) -> np.ndarray:
    """(6, 6) Fisher information of the corners at the true pose, by central differences of OpenCV's
    projection; error as in the spec: position, then delta of R_true = Exp(delta) R, in the map's axes."""
    points = np.concatenate([corners_in_map(marker) for marker in markers])
    columns = []
    for axis in range(6):
        ahead, behind = (
            camera.project(in_camera(_moved(truth, axis, step), points)) for step in (DIFFERENCE, -DIFFERENCE)
        )
        columns.append(((ahead - behind) / (2.0 * DIFFERENCE * camera.sigma)).ravel())
    jacobian = np.array(columns).T
    prior = np.zeros(6) if floor is None else np.array([0, 0, 1, 1, 1, 0]) / floor**2
    return jacobian.T @ jacobian + np.diag(prior)


def _moved(T: np.ndarray, axis: int, step: float) -> np.ndarray:
    delta, result = np.zeros(6), T.copy()
    delta[axis] = step
    result[:3, 3] += delta[:3]
    result[:3, :3] = sextant.exp_so3(delta[3:]) @ T[:3, :3]
    return result


def _judged(truth: np.ndarray, pose, bound: np.ndarray, min_probability: float) -> Judged:
    error, P = sextant.pose_error(truth, pose.T_map_base), pose.covariance
    squared = error[:3] @ error[:3]
    return Judged(
        pose.probability >= min_probability,
        error @ np.linalg.solve(P, error),
        error[:3] @ np.linalg.solve(P[:3, :3], error[:3]),
        squared / np.trace(P[:3, :3]),
        squared / np.trace(bound[:3, :3]),
    )


SHARE_BARS = {"decided": 0.95, "region": 0.9}


def _row(name: str, judged: List[Judged], frames: int, bars: Optional[str]) -> Row:
    decided = [each for each in judged if each.decided]
    shares = [Value(len(judged) / frames, 3, at_least=SHARE_BARS.get(bars)), Value(len(decided) / frames, 3)]
    return name, [*shares, *_errors(decided, bars), *_regions(judged, bars)]


def _errors(decided: List[Judged], bars: Optional[str]) -> List[Value]:
    most, low, high = (1.15, 5.4, 6.6) if bars == "decided" else (None, None, None)
    return [
        Value(np.sqrt(_mean([each.over_bound for each in decided])), at_most=most),
        Value(np.sqrt(_mean([each.over_own for each in decided])), at_most=most),
        Value(_mean([each.nees for each in decided]), at_least=low, at_most=high),
        Value(_mean([each.nees_position for each in decided])),
    ]


def _regions(judged: List[Judged], bars: Optional[str]) -> List[Value]:
    low, high = (0.93, 0.97) if bars == "region" else (None, None)
    return [
        Value(_mean([each.nees for each in judged])),
        Value(_mean([each.nees <= CHI2_95[6] for each in judged]), 3, at_least=low, at_most=high),
        Value(_mean([each.nees_position <= CHI2_95[3] for each in judged]), 3),
    ]


def _mean(values: list) -> float:
    return float(np.mean(values)) if values else float("nan")
