# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""CPU time of the searches against the plain libraries on the same rendered images in the same run."""

import time
from dataclasses import dataclass, field
from typing import Callable, Dict, List, Optional, Tuple

import numpy as np
from libapriltag import apriltag_detector
from opencv_aruco import opencv_detector
from tables import Table, Value
from under_test import detector

import sextant
from sextant.simulation.drive import DriveParams, Frame, SimulatedDrive
from sextant.simulation.room_markers import default_map

ARUCO, APRILTAG = "DICT_4X4_50", "tag36h11"
PLAIN = {ARUCO: "cv::aruco::detectMarkers", APRILTAG: "libapriltag, decimate 2"}
SIZES = {  # frames a seed, seeds, bars
    (1280, 720): (600, (1, 2, 3), True),
    (640, 480): (600, (1,), False),
    (1920, 1080): (150, (1,), False),
}
APRILTAG_FRAMES = 200  # a full search takes long
CERTAIN = 0.25  # pixels; a corner with a larger reported deviation is hidden or cut off
COLUMNS = ["CPU, ms", "of the library's", "of full", "markers", "wrong", "no map's", "all of full's, %"]
COLUMNS += ["corners, px", "uncertain, %"]
CORNER_BARS = {1280: 0.1, 640: 0.15, 1920: None}  # pixels RMS
RATIO_BARS = {ARUCO: {"full": 0.35, "tracking": 0.12}, APRILTAG: {"full": None, "tracking": 0.3}}

Found = Dict[int, Tuple[np.ndarray, np.ndarray]]  # by id: corners (4, 2) and deviations (4,)


@dataclass
class Tally:
    """What one search did."""

    cpu: float = 0.0  # s
    markers: int = 0
    wrong: int = 0
    decoys: int = 0
    complete: List[bool] = field(default_factory=list)  # by image: no marker of the full search is missing
    errors: List[np.ndarray] = field(default_factory=list)  # (4, 2) pixels
    sigmas: List[np.ndarray] = field(default_factory=list)  # (4,) pixels


def speed_tables(quick: bool) -> List[Table]:
    """A table a family and size; a quick run takes few images and holds no bars."""
    tables = []
    for family in (ARUCO, APRILTAG):
        for size, (frames, seeds, has_bars) in SIZES.items():
            count = min(frames, APRILTAG_FRAMES) if family == APRILTAG else frames
            if quick:
                count, seeds, has_bars = 8, (1,), False
            tallies = race(family, size, count, seeds)
            tables.append(_table(family, size, count * len(seeds), tallies, None if quick else has_bars))
    return tables


def race(family: str, size: Tuple[int, int], frames: int, seeds: Tuple[int, ...]) -> Dict[str, Tally]:
    """All searches on the same images, one image after another."""
    tallies = {"plain": Tally(), "full": Tally(), "tracking": Tally()}
    for seed in seeds:
        drive = SimulatedDrive(DriveParams(width=size[0], height=size[1], seed=seed), default_map(family))
        camera = sextant.CameraModel(drive.calibration)
        searches = {
            "plain": plain_search(family),
            "full": search(family, camera, "full"),
            "tracking": search(family, camera, "tracking"),
        }
        for frame in drive.frames(frames):
            found = {name: _timed(tallies[name], each, frame.image) for name, each in searches.items()}
            truth = true_corners(drive, camera, frame)
            ours = set(found["full"]) & set(truth)
            for name, markers in found.items():
                _judge(tallies[name], markers, truth, ours)
    return tallies


def plain_search(family: str) -> Callable[[np.ndarray], Found]:
    """The library as one calls it who has just installed it; corners have no deviations."""
    if family == APRILTAG:
        find_tags = apriltag_detector(family)
        return lambda image: {tag.id: (tag.corners, np.zeros(4)) for tag in find_tags(image)}
    find = opencv_detector(family)
    return lambda image: {id: (corners, np.zeros(4)) for id, corners in find(image).items()}


def search(family: str, camera, name: str, **changed) -> Callable[[np.ndarray], Found]:
    """Ours."""
    find = detector(family, search=name, **changed)
    return lambda image: {
        each.id: (each.corners, np.asarray(each.corner_sigmas)) for each in find.detect(image, camera)
    }


def true_corners(drive: SimulatedDrive, camera, frame: Frame) -> Dict[int, Optional[np.ndarray]]:
    """(4, 2) pixels by id; None where the lens does not reach a corner."""
    T_camera_map = np.linalg.inv(frame.T_map_base @ drive.T_base_camera)
    corners = {}
    for marker in drive.map.markers:
        points = (
            np.c_[sextant.marker_corners(marker.size), np.ones(4)] @ marker.T_map_marker.T @ T_camera_map.T
        )
        pixels = [camera.project(point[:3]) for point in points]
        corners[marker.id] = None if any(each is None for each in pixels) else np.array(pixels)
    return corners


def _timed(tally: Tally, find: Callable[[np.ndarray], Found], image: np.ndarray) -> Found:
    start = time.process_time()
    found = find(image)
    tally.cpu += time.process_time() - start
    return found


def _judge(tally: Tally, found: Found, truth: Dict[int, Optional[np.ndarray]], full: set) -> None:
    tally.complete.append(full <= set(found))
    for id, (corners, sigmas) in found.items():
        if id not in truth:  # some walls have squares that are markers, though none of the map
            tally.decoys += 1
            continue
        expected = truth[id]
        if expected is None or np.abs(corners.mean(0) - expected.mean(0)).max() > 20.0:
            tally.wrong += 1
            continue
        tally.markers += 1
        tally.errors.append(corners - expected)
        tally.sigmas.append(sigmas)


def _table(family: str, size: Tuple[int, int], frames: int, tallies: Dict[str, Tally], bars) -> Table:
    """bars: None none, False those of the corners and of wrong ids only."""
    plain = tallies["plain"]
    cpu = Value(1e3 * plain.cpu / frames), Value(1.0, 3), ""
    found = Value(plain.markers, 0), Value(plain.wrong, 0), Value(plain.decoys, 0), ""
    rows = [(PLAIN[family], [*cpu, *found, *_corners(plain, None)])]
    for name in ("full", "tracking"):
        limits = Limits.of(family, name, tallies) if bars else Limits()
        corner_bar = None if bars is None else CORNER_BARS[size[0]]
        rows.append((f"ours, {name}", _cells(tallies[name], tallies, frames, limits, corner_bar)))
    return Table(f"{family}, {size[0]} x {size[1]}, {frames} images of the simulated room", COLUMNS, rows)


@dataclass(frozen=True)
class Limits:
    """Bars of a search."""

    of_plain: Optional[float] = None
    of_full: Optional[float] = None
    markers: Optional[int] = None
    wrong: Optional[int] = None
    complete: Optional[float] = None  # %

    @staticmethod
    def of(family: str, name: str, tallies: Dict[str, Tally]) -> "Limits":
        of_plain = RATIO_BARS[family][name]
        if name == "full":
            return Limits(of_plain, None, tallies["plain"].markers, 0)
        return Limits(of_plain, 0.25, None, 0, 99.5)


def _cells(own: Tally, tallies: Dict[str, Tally], frames: int, limits: Limits, corner_bar) -> list:
    return [
        Value(1e3 * own.cpu / frames),
        Value(own.cpu / tallies["plain"].cpu, 3, at_most=limits.of_plain),
        Value(own.cpu / tallies["full"].cpu, 3, at_most=limits.of_full),
        Value(own.markers, 0, at_least=limits.markers),
        Value(own.wrong, 0, at_most=limits.wrong),
        Value(own.decoys, 0),
        Value(100 * np.mean(own.complete), 2, at_least=limits.complete),
        *_corners(own, corner_bar),
    ]


def _corners(own: Tally, bar: Optional[float]) -> List[Value]:
    if not own.errors:
        return [Value(float("nan")), Value(float("nan"))]
    errors, certain = np.array(own.errors), np.array(own.sigmas) < CERTAIN
    return [
        Value(float(np.sqrt(np.mean(errors[certain] ** 2))), 3, at_most=bar),
        Value(100 * float(1 - certain.mean()), 2),
    ]
