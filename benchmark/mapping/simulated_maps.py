# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps made of simulated drives with 20 markers, one of them known, against the exact ones."""

import time
from typing import List, NamedTuple, Optional, Tuple

import numpy as np
from simulated_observations import FAMILY, SIZE, SimulatedCamera
from tables import Table, Value
from under_test import detector, map_of

import sextant
from sextant.simulation.drive import DriveParams, SimulatedDrive
from sextant.simulation.motion import FigureEight

MARKERS, KNOWN = 20, 0
IMAGES = 1500  # of a simulated drive
LENS = "plumb_bob 4"
PERIOD = 60.0  # s, of a rendered drive: one figure of eight
COLUMNS = [
    "markers",
    "seen, not in it",
    "position RMSE, mm",
    "rotation RMSE, degrees",
    "NEES / d.o.f.",
    "time, s",
]


class MapErrors(NamedTuple):
    """Of all markers but the known one, aligned by that."""

    position: np.ndarray  # (N) metres
    rotation: np.ndarray  # (N) radians
    missing: int  # markers that were seen and are not in the map
    nees: float  # of all together, over their degrees of freedom
    seconds: float


def room_map(seed: int, half: float = 3.0):
    """sextant.MarkerMap of five markers on each wall of a square room, 0.6 to 1.8 m high, not quite upright.

    :param half: distance of the walls from the middle, metres
    """
    random, result = np.random.default_rng([seed, 7]), sextant.MarkerMap()
    for id in range(MARKERS):
        side = ((id // 4 + 0.5) / (MARKERS // 4) * 2.0 - 1.0) * 0.85 * half
        T_map_wall = sextant.pose_from_xyz_rpy([0.0, 0.0, 0.0], [0.0, 0.0, 0.5 * np.pi * (id % 4)])
        tilt = [0.5 * np.pi + 0.03 * random.normal(), 0.03 * random.normal(), 0.03 * random.normal()]
        T_wall_marker = sextant.pose_from_xyz_rpy([side, half - 0.01, random.uniform(0.6, 1.8)], tilt)
        result.add(sextant.MappedMarker(FAMILY, id, SIZE, T_map_wall @ T_wall_marker))
    return result


def recording(seed: int, truth, count: int, sigma: float) -> list:
    """sextant.RecordedInstant of a robot that goes round the room three times and looks everywhere.

    :param sigma: noise of a corner coordinate, pixels
    """
    camera, instants = SimulatedCamera(LENS, (640, 480), sigma, seed), []
    for angle in np.linspace(0.0, 6.0 * np.pi, count):
        xyz = [1.2 * np.cos(angle), 1.2 * np.sin(2.0 * angle / 3.0 + seed), 0.0]
        T = sextant.pose_from_xyz_rpy(xyz, [0.0, 0.0, 1.7 * angle + seed])
        instants.append(sextant.RecordedInstant([camera.view(T, camera.visible(T, truth))]))
    return instants


def make_map(instants: list, known):
    """sextant.MappingResult with the tool's own defaults, on one thread."""
    sizes = sextant.MarkerSizes()
    sizes.size = SIZE
    return sextant.make_marker_map(instants, sizes, known, sextant.MappingParams())


def errors_of(truth, instants: list) -> MapErrors:
    """What a map made with one known marker is off by."""
    begin = time.perf_counter()
    made = make_map(instants, map_of([truth.find(FAMILY, KNOWN)]))
    seconds = time.perf_counter() - begin
    found = [marker for marker in made.map.markers if marker.id != KNOWN]
    errors = [sextant.pose_error(truth.find(FAMILY, m.id).T_map_marker, m.T_map_marker) for m in found]
    rows = [6 * i + k for i, m in enumerate(made.map.markers) if m.id != KNOWN for k in range(6)]
    P, e = np.asarray(made.covariance)[np.ix_(rows, rows)], np.array(errors)
    nees = float(e.ravel() @ np.linalg.solve(P, e.ravel())) / e.size
    missing = len(made.unconnected) + len(made.ambiguous) + len(made.inconsistent)
    return MapErrors(
        np.linalg.norm(e[:, :3], axis=1), np.linalg.norm(e[:, 3:], axis=1), missing, nees, seconds
    )


def simulated_tables(quick: bool) -> List[Table]:
    """Corners with noise, and rendered images; a quick run is one short drive each, without bars."""
    rows, samples = [], {}
    for sigma in (0.1, 0.3):
        name, errors = f"corners, {sigma} px", corner_errors(sigma, quick)
        rows.append((f"{name}, drives: {len(errors)}", _cells(errors, _bars(sigma, quick))))
        samples[name] = 1000.0 * np.concatenate([each.position for each in errors])
    for seed in (1,) if quick else (1, 2, 3):
        rows.append((f"rendered images, seed {seed}", _cells([rendered(seed, quick)], _bars(0.0, quick))))
    title = (
        f"Map of {MARKERS} markers from 640 x 480, {IMAGES} images' corners or 600 images, one marker known"
    )
    return [Table(title, COLUMNS, rows, samples)]


def corner_errors(sigma: float, quick: bool) -> List[MapErrors]:
    """Of seeded drives with this noise (pixels)."""
    errors = []
    for seed in (1,) if quick else range(20):
        room = room_map(seed)
        errors.append(errors_of(room, recording(seed, room, IMAGES // 10 if quick else IMAGES, sigma)))
    return errors


class Bars(NamedTuple):
    """What the figures of a row are held to; None: to nothing."""

    missing: Optional[float] = None
    millimetres: Optional[float] = None
    degrees: Optional[float] = None
    nees: Tuple[Optional[float], Optional[float]] = (None, None)
    seconds: Optional[float] = None


def _bars(sigma: float, quick: bool) -> Bars:
    """With 0.3 px the known marker's own corners limit how exactly the rest can be aligned by it."""
    if quick:
        return Bars()
    bars = Bars(missing=0, seconds=60.0, nees=(0.85, 1.15) if sigma > 0 else (None, None))
    return bars if sigma > 0.1 else bars._replace(millimetres=5.0, degrees=0.3)


def rendered(seed: int, quick: bool) -> MapErrors:
    """Of images of the simulated room, through the detector."""
    truth, frames = room_map(seed), 60 if quick else 600
    params = DriveParams(
        seed=seed, noise_sigma=4.0, rate=frames / PERIOD, eight=FigureEight(period=PERIOD), obstacles=False
    )
    drive, find = SimulatedDrive(params, truth), detector(FAMILY)
    camera = sextant.CameraModel(drive.calibration)
    instants = [
        sextant.RecordedInstant(
            [sextant.MarkerView(camera, drive.T_base_camera, find.detect(frame.image, camera))]
        )
        for frame in drive.frames(frames)
    ]
    return errors_of(truth, instants)


def _cells(errors: List[MapErrors], bars: Bars) -> List[Value]:
    position, rotation = (
        np.sqrt(np.mean(np.concatenate(each) ** 2))
        for each in ([e.position for e in errors], [e.rotation for e in errors])
    )
    return [
        Value(float(np.mean([1 + len(each.position) for each in errors])), 1),
        Value(sum(each.missing for each in errors), 0, at_most=bars.missing),
        Value(1000.0 * position, at_most=bars.millimetres),
        Value(np.degrees(rotation), 3, at_most=bars.degrees),
        Value(float(np.mean([each.nees for each in errors])), at_least=bars.nees[0], at_most=bars.nees[1]),
        Value(max(each.seconds for each in errors), 1, at_most=bars.seconds),
    ]


def taped_tables(quick: bool) -> List[Table]:
    """Maps measured by tape, two of their 20 entries wrong by 10 cm."""
    rows = []
    for tape in (0.01,) if quick else (0.0, 0.005, 0.01):
        trials = [_taped(seed, tape, 200 if quick else 600) for seed in ((1,) if quick else range(10))]
        exact = [sorted(named) == wrong for named, wrong, _, _ in trials]
        before, after = (1000.0 * np.sqrt(np.mean([trial[i] ** 2 for trial in trials])) for i in (2, 3))
        cells = [
            Value(100.0 * np.mean(exact), 0, at_least=None if quick else 100.0),
            Value(before),
            Value(after),
        ]
        rows.append((f"tape errs by {1000.0 * tape:g} mm, {len(trials)} maps", cells))
    columns = ["exactly the two named, % of maps", "position RMSE before, mm", "after, mm"]
    return [Table("Taped maps made better, two of 20 entries wrong by 10 cm", columns, rows)]


def _taped(seed: int, tape: float, count: int) -> Tuple[List[int], List[int], float, float]:
    """(ids named, ids that are wrong, RMSE before and after in metres)."""
    truth, random = room_map(seed), np.random.default_rng([seed, 11])
    wrong = sorted(random.choice(MARKERS, 2, replace=False).tolist())
    taped = map_of(_remeasured(m, tape, random, 0.1 if m.id in wrong else 0.0) for m in truth.markers)
    made = make_map(recording(seed, truth, count, 0.3), taped)
    named = [check.id for check in made.known if check.wrong]
    return named, wrong, _rmse(truth, taped), _rmse(truth, made.map)


def _remeasured(marker, tape: float, random, off: float):
    T, direction = marker.T_map_marker.copy(), random.normal(size=3)
    T[:3, 3] += tape * random.normal(size=3) + off * direction / np.linalg.norm(direction)
    T[:3, :3] = sextant.exp_so3(tape * random.normal(size=3)) @ T[:3, :3]
    covariance = np.diag([0.01**2] * 3 + [0.02**2] * 3)  # what the tool takes for a tape
    return sextant.MappedMarker(marker.family, marker.id, marker.size, T, "", covariance)


def _rmse(truth, estimate) -> Optional[float]:
    errors = [truth.find(FAMILY, m.id).T_map_marker[:3, 3] - m.T_map_marker[:3, 3] for m in estimate.markers]
    return float(np.sqrt(np.mean(np.sum(np.square(errors), axis=1))))
