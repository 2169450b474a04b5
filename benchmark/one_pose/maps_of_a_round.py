# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps that map_all makes of one recorded round, and localization with them.

The images of the round are rendered, with the markers on the walls. The frame of the maps is arbitrary:
they are aligned with the truth by the poses of the photos. Localization is that of rounds without
kidnappings, from one minute after the start; with true maps it is the same rounds with the same noise. The
answers of photos are drawn, and moved by the error of the nearest photo of the map.
"""

import contextlib
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Dict, List, NamedTuple, Tuple

import numpy as np
import yaml
from tables import Row, Table, Value

import sextant
from one_pose.kidnappings import rms
from one_pose.round_bag import write_round_bag
from one_pose.rounds import SENSORS, SYSTEMS, Maps, looks, true_maps
from sextant.buildings.building_looks import MARKER_SIZE
from sextant.commands.maps.map_all import main as map_all
from sextant.commands.maps.maps_folder import LANDMARKS, PLACES
from sextant.commands.maps.moved_maps import FrameMove, moved_landmark_map
from sextant.evaluation.trajectory_metrics import alignment
from sextant.geometry.plane_poses import composed, planar, relative, wrapped
from sextant.messages.landmark_messages import planar_sensor_pose
from sextant.place_maps.photo_poses import poses_path, read_photo_poses
from sextant.simulation.building import Building
from sextant.simulation.building_round import RoundParams

BUILDINGS, FIRST_SEED = 3, 3000
ROUNDS, DURATION, SETTLED = 4, 300.0, 60.0  # localization in each building: rounds, seconds, seconds
DRIVE, QUICK_DRIVE, QUICK_DURATION = 900.0, 60.0, 90.0  # seconds
SAME = 1.0  # metres: a landmark of the map that is nearer to a pillar is this pillar
TURN = 3.0  # metres that count as much as a radian when the nearest photo is looked up
RATIO, FEWER = 1.2, 1.0  # of the error; % of the time without a pose
COLUMNS = [
    "markers of 10",
    "pillars",
    "landmarks in the map",
    "markers, m",
    "pillars, m",
    "photos, m",
    "with a pose, %",
    "with true maps, %",
    "pose, m",
    "pose with true maps, m",
    "of that with true maps",
]


class Made(NamedTuple):
    """Maps of a round in the frame of the building, and their errors."""

    maps: Maps  # for localization
    markers: np.ndarray  # (n,) distances from the true positions, metres
    pillars: np.ndarray  # (m,) distances from the true positions, metres
    photos: np.ndarray  # (k,) distances of the cameras from the true positions, metres
    of_pillars: int  # landmarks in the map


def map_tables(quick: bool) -> List[Table]:
    """One table; a quick run has one short drive, without bars."""
    seeds = [FIRST_SEED + k for k in range(1 if quick else BUILDINGS)]
    with ProcessPoolExecutor() as pool:
        rows: List[Row] = list(pool.map(_row, seeds, [quick] * len(seeds)))
    duration = QUICK_DRIVE if quick else DRIVE
    return [Table(f"map_all on one drive of {duration:g} s through a building", COLUMNS, rows)]


def _row(seed: int, quick: bool) -> Row:
    building = Building(seed)
    made = made_maps(seed, QUICK_DRIVE if quick else DRIVE)
    rounds, duration = (1, QUICK_DURATION) if quick else (ROUNDS, DURATION)
    drives = [RoundParams(seed=seed + 100 + k, duration=duration, kidnappings=0) for k in range(rounds)]
    with_made, with_true = (_pose_errors(seed, drives, maps) for maps in (made.maps, true_maps(building)))
    shares = [100 * float(np.isfinite(each).mean()) for each in (with_made, with_true)]
    errors = [rms(each[np.isfinite(each)]) for each in (with_made, with_true)]
    bar = (lambda value: None) if quick else (lambda value: value)
    figures = [
        Value(len(made.markers), 0),
        Value(len(building.pillars), 0),
        Value(made.of_pillars, 0),
        *(Value(rms(each), 3) for each in (made.markers, made.pillars, made.photos)),
        Value(shares[0], 1, at_least=bar(shares[1] - FEWER)),
        Value(shares[1], 1),
        *(Value(each, 3) for each in errors),
        Value(errors[0] / errors[1], 2, at_most=bar(RATIO)),
    ]
    return f"building {seed}", figures


def _pose_errors(seed: int, drives: List[RoundParams], maps: Maps) -> np.ndarray:
    """Distances from the true positions, metres; infinite: no pose."""
    rounds = (looks(seed, params, SYSTEMS, maps=maps) for params in drives)
    return np.array([look.distance for one in rounds for look in one if look.stamp > SETTLED])


# ---- maps


def made_maps(seed: int, duration: float) -> Made:
    """Records a round, and makes the maps by the command."""
    building = Building(seed)
    params = RoundParams(seed=seed, duration=duration, kidnappings=0)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        truth = write_round_bag(folder / "drive.bag", building, params)
        (folder / "slam.yaml").write_text(yaml.safe_dump(SENSORS))
        given = ["--params", str(folder / "slam.yaml"), "--size", str(MARKER_SIZE), "--jobs", "1"]
        with contextlib.redirect_stdout(sys.stderr):  # standard output may be that of the tables
            status = map_all([str(folder / "drive.bag"), "-o", str(folder / "maps"), *given])
        if status:
            raise OSError("map_all failed; the reason is above")
        return _read(folder / "maps", building, truth)


def _read(folder: Path, building: Building, truth: Dict[int, np.ndarray]) -> Made:
    photos = {
        round(1e9 * float(Path(image).stem.rsplit("_", 1)[1])): photo.T_map_camera
        for image, photo in read_photo_poses(poses_path(folder / PLACES)).photos.items()
    }
    true_photos = {stamp: truth[stamp] for stamp in photos}
    T_truth_map = alignment(true_photos, photos)
    mapped = moved_landmark_map(
        sextant.read_landmark_map(str(folder / LANDMARKS)),
        FrameMove("map", planar(T_truth_map), np.zeros((3, 3))),
    )
    markers, pillars = _errors(building, mapped)
    poses = np.array(
        [[planar_sensor_pose(T) for T in (true_photos[k], T_truth_map @ photos[k])] for k in sorted(photos)]
    )
    off = np.hypot(*(poses[:, 1] - poses[:, 0]).T[:2])
    maps = Maps(mapped.landmarks, mapped.labels, mapped.covariance, PhotoErrors(poses))
    return Made(maps, markers, pillars, off, sum(label.id is None for label in mapped.labels))


def _errors(building: Building, mapped) -> Tuple[np.ndarray, np.ndarray]:
    """Distances of mapped markers, and of mapped landmarks from the nearest pillar of their class."""
    of_markers, of_pillars = [], []
    at = {marker.id: marker.pose[:2] for marker in building.markers}
    classes = np.array(building.classes)
    for label, landmark in zip(mapped.labels, mapped.landmarks):
        if label.id is not None:
            of_markers.append(np.hypot(*(landmark.position - at[label.id])))
        else:
            same = building.pillars[classes == label.class_name]
            of_pillars.append(np.hypot(*(same - landmark.position).T).min())
    near = np.array(of_pillars)
    return np.array(of_markers), near[near < SAME]


class PhotoErrors:
    """Moves a pose as the nearest photo of the map is moved."""

    def __init__(self, poses: np.ndarray):
        """:param poses: (n, 2, 3) the true one and the mapped one of each photo"""
        self._true, self._mapped = poses[:, 0], poses[:, 1]

    def __call__(self, pose: np.ndarray) -> np.ndarray:
        off = self._true - pose
        turns = np.array([wrapped(each) for each in off[:, 2]])
        nearest = int(np.argmin(np.hypot(off[:, 0], off[:, 1]) + TURN * np.abs(turns)))
        return composed(self._mapped[nearest], relative(self._true[nearest], pose))
