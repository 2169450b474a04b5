# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps made of tagslam's recordings: recorded corners, against surveyed places and that project's own map."""

import csv
import json
from pathlib import Path
from typing import Dict, List, NamedTuple, Tuple

import numpy as np
from real_data import TagslamRecording, read_tagslam
from tables import Table, Value
from under_test import map_of

import sextant
from markers.recorded_drives import by_stamp
from sextant.evaluation.trajectory_metrics import aligned, alignment

WELL_KNOWN = 0.01  # m, stated deviation of a surveyed position
MIN_SIGMAS = (0.0, 0.0)  # m and rad; the survey states 0.1 mm, and that project's own map is 9 cm off it
BELIEVED = (0.03, 0.03)
HELD = 306  # the marker that holds tagslam_2's frame, in that project as well


class Surveyed(NamedTuple):
    """A marker of markers_surveyed.csv."""

    T_map_marker: np.ndarray
    sigma_position: np.ndarray  # (3) metres
    sigma_rotation: np.ndarray  # (3) radians
    size: float


def recorded_map_tables(folder: Path, quick: bool) -> List[Table]:
    """:raises OSError: a recording is not there"""
    building, rig = read_tagslam(folder / "tagslam_10"), read_tagslam(folder / "tagslam_2")
    surveyed = read_surveyed(folder / "tagslam_10" / "markers_surveyed.csv")
    return [_building(building, surveyed, quick), _rig(rig, quick)]


def read_surveyed(path: Path) -> Dict[int, Surveyed]:
    """By id; a rotation is an axis times an angle."""
    with path.open(newline="") as file:
        return {int(row["id"]): _surveyed(row) for row in csv.DictReader(file)}


def _surveyed(row: Dict[str, str]) -> Surveyed:
    T = np.eye(4)
    T[:3, :3] = sextant.exp_so3(np.array([float(row[name]) for name in ("rx", "ry", "rz_axis_angle_rad")]))
    T[:3, 3] = [float(row[name]) for name in "xyz"]
    sigmas = [np.array(list(json.loads(row[name]).values())) for name in ("sigma_position", "sigma_rotation")]
    return Surveyed(T, *sigmas, float(row["size"]))


def _building(recorded: TagslamRecording, surveyed: Dict[int, Surveyed], quick: bool) -> Table:
    well_known = sorted(id for id, each in surveyed.items() if np.max(each.sigma_position) <= WELL_KNOWN)
    held, others = well_known[::3], [id for i, id in enumerate(well_known) if i % 3]
    reference = _places(recorded.map)
    T = alignment({id: surveyed[id].T_map_marker for id in held}, reference)
    as_surveyed = _map_of(recorded, _known(surveyed, held, *MIN_SIGMAS), quick)
    believed = _map_of(recorded, _known(surveyed, held, *BELIEVED), quick)
    rows = [
        _row("that project's own map, aligned", aligned(T, reference), surveyed, others, bars=False),
        _row("held as surveyed", _places(as_surveyed.map), surveyed, others, bars=False),
        _row("held by 3 cm and 0.03 rad", _places(believed.map), surveyed, others, bars=not quick),
    ]
    title = "tagslam_10: 73 x 31 m, every third surveyed marker held; error of the others, cm"
    return Table(title, ["median", "90 %", "worst", "markers"], rows)


def _row(
    name: str, found: dict, surveyed: Dict[int, Surveyed], others: List[int], bars: bool
) -> Tuple[str, list]:
    there = [id for id in others if id in found]
    errors = [100.0 * _distance(found[id], surveyed[id].T_map_marker) for id in there]
    median, ninety, worst = np.percentile(errors, [50, 90, 100])
    cells = [
        Value(median, 1, at_most=9.4 if bars else None),
        Value(ninety, 1, at_most=14.0 if bars else None),
    ]
    return name, [*cells, Value(worst, 1), f"{len(there)} of {len(others)}"]


def _known(surveyed: Dict[int, Surveyed], ids: List[int], position: float, rotation: float):
    """sextant.MarkerMap with at least these standard deviations (metres, radians)."""
    result = sextant.MarkerMap()
    for id in ids:
        T, sigma_position, sigma_rotation, size = surveyed[id]
        sigmas = np.r_[np.maximum(sigma_position, position), np.maximum(sigma_rotation, rotation)]
        result.add(sextant.MappedMarker("tag36h11", id, size, T, "", np.diag(sigmas**2)))
    return result


def _map_of(recorded: TagslamRecording, known, quick: bool):
    observations = recorded.observations[:: 3 if quick else 1]
    cameras, sizes = sorted(recorded.cameras), sextant.MarkerSizes()
    sizes.sizes = {str(marker.id): marker.size for marker in recorded.map.markers}
    instants = []
    for images in by_stamp(sorted(observations, key=lambda each: each.stamp)):
        views = [recorded.view(each) for each in images]
        for view, image in zip(views, images):
            view.camera_index = cameras.index(image.camera)
        instants.append(sextant.RecordedInstant(views))
    return sextant.make_marker_map(instants, sizes, known, sextant.MappingParams())


def _rig(recorded: TagslamRecording, quick: bool) -> Table:
    known = map_of([recorded.map.find("tag36h11", HELD)])
    found, places = _places(_map_of(recorded, known, quick).map), _places(recorded.map)
    found = aligned(alignment(places, found), found)
    errors = [1000.0 * _distance(T, places[id]) for id, T in found.items()]
    median, worst = np.percentile(errors, [50, 100])
    cells = [Value(median, at_most=None if quick else 5.0), Value(worst), f"{len(found)} of {len(places)}"]
    title = "tagslam_2: two fisheye cameras on a rig; against that project's own map after alignment, mm"
    return Table(title, ["median", "worst", "markers"], [("one marker known", cells)])


def _places(marker_map) -> Dict[int, np.ndarray]:
    """T_map_marker (4, 4) by id."""
    return {marker.id: marker.T_map_marker for marker in marker_map.markers}


def _distance(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.linalg.norm(a[:3, 3] - b[:3, 3]))
