# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps made of tagslam's recordings: recorded corners, against surveyed places and that project's own map."""

import csv
import json
from pathlib import Path
from typing import Dict, List, NamedTuple, Tuple

import numpy as np
from real_data import TagslamRecording, read_tagslam
from recorded_drives import by_stamp
from tables import Table, Value

import sextant

WELL_KNOWN = 0.01  # m, stated deviation of a surveyed position
SAID = (0.0, 0.0)  # m and rad: at least; the survey says 0.1 mm, and that project's own map is 9 cm off it
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
    reference = {marker.id: marker.T_map_marker[:3, 3] for marker in recorded.map.markers}
    T = _alignment(reference, {id: surveyed[id].T_map_marker[:3, 3] for id in held})
    aligned = {id: T[:3, :3] @ p + T[:3, 3] for id, p in reference.items()}
    rows = [_row("that project's own map, aligned", aligned, surveyed, others, bars=False)]
    for name, least in (("held as surveyed", SAID), ("held by 3 cm and 0.03 rad", BELIEVED)):
        made = _map_of(recorded, _known(surveyed, held, *least), quick)
        found = {marker.id: marker.T_map_marker[:3, 3] for marker in made.map.markers}
        rows.append(_row(name, found, surveyed, others, bars=least == BELIEVED and not quick))
    title = "tagslam_10: 73 x 31 m, every third surveyed marker held; error of the others, cm"
    return Table(title, ["median", "90 %", "worst", "markers"], rows)


def _row(
    name: str, found: dict, surveyed: Dict[int, Surveyed], others: List[int], bars: bool
) -> Tuple[str, list]:
    there = [id for id in others if id in found]
    errors = [100.0 * np.linalg.norm(found[id] - surveyed[id].T_map_marker[:3, 3]) for id in there]
    median, ninety, worst = np.percentile(errors, [50, 90, 100])
    cells = [
        Value(median, 1, at_most=9.4 if bars else None),
        Value(ninety, 1, at_most=14.0 if bars else None),
    ]
    return name, [*cells, Value(worst, 1), f"{len(there)} of {len(others)}"]


def _known(surveyed: Dict[int, Surveyed], ids: List[int], position: float, rotation: float):
    """sextant.MarkerMap that says no less than these deviations (metres, radians)."""
    result = sextant.MarkerMap()
    for id in ids:
        T, sigma_position, sigma_rotation, size = surveyed[id]
        sigmas = np.r_[np.maximum(sigma_position, position), np.maximum(sigma_rotation, rotation)]
        result.add(sextant.MappedMarker("tag36h11", id, size, T, "", np.diag(sigmas**2)))
    return result


def _map_of(recorded: TagslamRecording, known, quick: bool):
    sightings = recorded.sightings[:: 3 if quick else 1]
    cameras, sizes = sorted(recorded.cameras), sextant.MarkerSizes()
    sizes.sizes = {str(marker.id): marker.size for marker in recorded.map.markers}
    instants = []
    for images in by_stamp(sorted(sightings, key=lambda each: each.stamp)):
        views = [recorded.view(each) for each in images]
        for view, image in zip(views, images):
            view.camera_index = cameras.index(image.camera)
        instants.append(sextant.RecordedInstant(views))
    return sextant.make_marker_map(instants, sizes, known, sextant.MappingParams())


def _rig(recorded: TagslamRecording, quick: bool) -> Table:
    reference = {marker.id: marker for marker in recorded.map.markers}
    known = sextant.MarkerMap()
    known.add(reference[HELD])
    found = {marker.id: marker.T_map_marker[:3, 3] for marker in _map_of(recorded, known, quick).map.markers}
    T = _alignment(found, {id: marker.T_map_marker[:3, 3] for id, marker in reference.items()})
    errors = [
        1000.0 * np.linalg.norm(T[:3, :3] @ p + T[:3, 3] - reference[id].T_map_marker[:3, 3])
        for id, p in found.items()
    ]
    median, worst = np.percentile(errors, [50, 100])
    cells = [Value(median, at_most=None if quick else 5.0), Value(worst), f"{len(found)} of {len(reference)}"]
    title = "tagslam_2: two fisheye cameras on a rig; against that project's own map after alignment, mm"
    return Table(title, ["median", "worst", "markers"], [("one marker known", cells)])


def _alignment(points: Dict[int, np.ndarray], targets: Dict[int, np.ndarray]) -> np.ndarray:
    """(4, 4) rigid transform from points to targets of the same id (Umeyama 1991, without scale)."""
    ids = sorted(set(points) & set(targets))
    a, b = (np.array([each[id] for id in ids]) for each in (points, targets))
    U, _, Vt = np.linalg.svd((a - a.mean(0)).T @ (b - b.mean(0)))
    T = np.eye(4)
    T[:3, :3] = Vt.T @ np.diag([1.0, 1.0, np.sign(np.linalg.det(Vt.T @ U.T))]) @ U.T
    T[:3, 3] = b.mean(0) - T[:3, :3] @ a.mean(0)
    return T
