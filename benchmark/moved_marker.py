# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""One of eight map entries is wrong: what that does to the pose, and whether the marker is named."""

from typing import Dict, List, NamedTuple

import numpy as np
from simulated_sightings import SimulatedCamera, wall_map
from tables import Row, Table, Value

import sextant

OFFSET = 0.2  # m
DIRECTIONS = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
WALL = (-0.9, 0.9)
ROOM = [(3.0, y, 1.2, np.pi) for y in WALL] + [(-3.0, y, 1.2, 0.0) for y in WALL]
ROOM += [(x, 3.0, 1.2, -np.pi / 2) for x in WALL] + [(x, -3.0, 1.2, np.pi / 2) for x in WALL]
LEAST = 3  # markers in sight: two that contradict each other do not tell which of them was moved
OFFSETS = "offsets told, cm"  # samples: along the moved axis, by row
COLUMNS = ["RMSE, cm", "over the right map's", "left out, %", "others left out, %", "named", "others named"]


class Drive(NamedTuple):
    """What came of one map."""

    rmse: float  # cm
    left_out: float  # share of the sightings of the moved marker
    false: float  # share of the sightings of the others
    named: List[int]
    errors: np.ndarray  # cm
    offsets: Dict[int, np.ndarray]  # cm in the map's axes, where the named ones are seen


def moved_marker_tables(quick: bool) -> List[Table]:
    """A row a marker and direction; a quick run moves one, without bars."""
    frames, ids = (20, range(1)) if quick else (300, range(len(ROOM)))
    right = drive(wall_map(ROOM), -1, frames)
    rows, samples, offsets = [("right map", [Value(right.rmse), *[""] * 5])], {"right map": right.errors}, []
    for id in ids:
        for name, direction in DIRECTIONS.items():
            wrong = drive(_moved(id, direction), id, frames)
            rows.append(_row(f"marker {id} along {name}", id, wrong, right.rmse, quick))
            samples[rows[-1][0]] = wrong.errors
            offsets.append(wrong.offsets[id] @ direction if id in wrong.offsets else np.nan)
    samples[OFFSETS] = np.array(offsets)
    return [Table(f"One of eight map entries off by {OFFSET} m", COLUMNS, rows, samples)]


def drive(marker_map, moved: int, frames: int) -> Drive:
    """Frames of the room as it is, located with a map."""
    camera, room = SimulatedCamera("plumb_bob 0", (640, 480), 0.3), wall_map(ROOM)
    localization, errors, seen, left = sextant.MarkerLocalization(), [], [], []
    while len(errors) < frames:
        x, y, yaw = camera.random.uniform((-2.0, -2.0, -np.pi), (2.0, 2.0, np.pi))
        truth = sextant.pose_from_xyz_rpy([x, y, 0.0], [0.0, 0.0, yaw])
        markers = camera.visible(truth, room)
        if len(markers) < LEAST:
            continue
        pose = localization.locate(marker_map, [camera.view(truth, markers)]).pose
        errors.append(np.linalg.norm(pose.T_map_base[:3, 3] - truth[:3, 3]) if pose else np.nan)
        seen += [each.id for each in markers if pose]
        left += [id for _, id in pose.left_out] if pose else []
    of_moved, others = seen.count(moved), len(seen) - seen.count(moved)
    share = left.count(moved) / of_moved if of_moved else float("nan")
    false = (len(left) - left.count(moved)) / others
    rmse = 100.0 * float(np.sqrt(np.nanmean(np.square(errors))))
    offsets = {each.id: 100.0 * each.offset for each in localization.moved}
    return Drive(rmse, share, false, list(offsets), 100.0 * np.array(errors), offsets)


def _moved(id: int, direction):
    room = wall_map(ROOM)
    entry = room.markers[id]
    pose = entry.T_map_marker.copy()
    pose[:3, 3] += OFFSET * np.array(direction)
    room.set(sextant.MappedMarker(entry.family, id, entry.size, pose))
    return room


def _row(name: str, id: int, wrong: Drive, right: float, quick: bool) -> Row:
    return name, [
        Value(wrong.rmse),
        Value(wrong.rmse / right, at_most=None if quick else 2.0),
        Value(100.0 * wrong.left_out, 1),
        Value(100.0 * wrong.false, 1),
        Value(id in wrong.named, 0, at_least=None if quick else 1),
        Value(len(set(wrong.named) - {id}), 0, at_most=None if quick else 0),
    ]
