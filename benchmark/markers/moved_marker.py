# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""One of eight map entries is wrong: what that does to the pose, and whether the marker is named."""

from typing import Dict, List, NamedTuple, Optional

import numpy as np
from simulated_observations import SimulatedCamera, wall_map
from tables import Table, Value
from under_test import map_of

import sextant

OFFSET = 0.2  # m
DIRECTIONS = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
PAIR, FOUR = (-0.9, 0.9), (-1.8, -0.6, 0.6, 1.8)
ROOM = [(3.0, y, 1.2, np.pi) for y in PAIR] + [(-3.0, y, 1.2, 0.0) for y in PAIR]
ROOM += [(x, 3.0, 1.2, -np.pi / 2) for x in PAIR] + [(x, -3.0, 1.2, np.pi / 2) for x in PAIR]
CORNER = [(3.0, y, 1.2, np.pi) for y in FOUR] + [(x, 3.0, 1.2, -np.pi / 2) for x in FOUR]
LAYOUTS = {  # markers, how many at least are in sight, RMSE over the right map's
    "two walls": (CORNER, 4, 2.0),
    "four walls": (ROOM, 3, None),  # without one of three, the pose is far worse whatever one does
}
OFFSETS = "estimated offsets, cm"  # samples: along the moved axis, by row
COLUMNS = ["RMSE, cm", "over the right map's", "over one without it", "left out, %", "others left out, %"]
COLUMNS += ["named", "others named"]
WITHOUT = 1.25  # times the RMSE of a map that does not have the marker


class Drive(NamedTuple):
    """What came of one map."""

    rmse: float  # cm
    left_out: float  # share of the observations of the moved marker
    false: float  # share of the observations of the others
    named: List[int]
    errors: np.ndarray  # cm
    offsets: Dict[int, np.ndarray]  # cm in the map's axes, where the named ones are seen


def moved_marker_tables(quick: bool) -> List[Table]:
    """A table a layout, a row a marker and direction; a quick run moves one, without bars."""
    return [_table(name, quick) for name in LAYOUTS]


def _table(layout: str, quick: bool) -> Table:
    places, least, bar = LAYOUTS[layout]
    room, frames = wall_map(places), 20 if quick else 300
    right = drive(room, room, -1, frames, least)
    rows, samples, offsets = [("right map", [Value(right.rmse), *[""] * 6])], {"right map": right.errors}, []
    for id in range(1 if quick else len(places)):
        lacking = drive(map_of(_others(room, id)), room, id, frames, least)
        for name, direction in DIRECTIONS.items():
            wrong = drive(_moved(room, id, direction), room, id, frames, least)
            ratios = _ratios(wrong.rmse, right.rmse, lacking.rmse, bar, quick)
            rows.append((f"marker {id} along {name}", [*ratios, *_named(id, wrong, quick)]))
            samples[rows[-1][0]] = wrong.errors
            offsets.append(wrong.offsets[id] @ direction if id in wrong.offsets else np.nan)
    samples[OFFSETS] = np.array(offsets)
    title = f"One of eight map entries off by {OFFSET} m, {layout}, {least} or more in sight"
    return Table(title, COLUMNS, rows, samples)


def drive(marker_map, room, moved: int, frames: int, least: int) -> Drive:
    """Frames of the room as it is, located with a map."""
    camera = SimulatedCamera("plumb_bob 0", (640, 480), 0.3)
    localization, errors, seen, left = sextant.MarkerLocalization(), [], [], []
    while len(errors) < frames:
        x, y, yaw = camera.random.uniform((-2.0, -2.0, -np.pi), (2.0, 2.0, np.pi))
        truth = sextant.pose_from_xyz_rpy([x, y, 0.0], [0.0, 0.0, yaw])
        markers = camera.visible(truth, room)
        if len(markers) < least:
            continue
        pose = localization.locate(marker_map, [camera.view(truth, markers)]).pose
        errors.append(np.linalg.norm(pose.T_map_base[:3, 3] - truth[:3, 3]) if pose else np.nan)
        seen += [each.id for each in markers if pose]
        left += [id for _, id in pose.outliers] if pose else []
    of_moved, others = seen.count(moved), len(seen) - seen.count(moved)
    share = left.count(moved) / of_moved if of_moved else float("nan")
    false = (len(left) - left.count(moved)) / others
    rmse = 100.0 * float(np.sqrt(np.nanmean(np.square(errors))))
    offsets = {each.id: 100.0 * each.offset for each in localization.moved}
    return Drive(rmse, share, false, list(offsets), 100.0 * np.array(errors), offsets)


def _moved(room, id: int, direction):
    entry = room.markers[id]
    pose = entry.T_map_marker.copy()
    pose[:3, 3] += OFFSET * np.array(direction)
    return map_of([*_others(room, id), sextant.MappedMarker(entry.family, id, entry.size, pose)])


def _others(room, id: int) -> list:
    return [each for each in room.markers if each.id != id]


def _ratios(rmse: float, right: float, lacking: float, bar: Optional[float], quick: bool) -> List[Value]:
    return [
        Value(rmse),
        Value(rmse / right, at_most=None if quick else bar),
        Value(rmse / lacking, at_most=None if quick else WITHOUT),
    ]


def _named(id: int, wrong: Drive, quick: bool) -> List[Value]:
    return [
        Value(100.0 * wrong.left_out, 1),
        Value(100.0 * wrong.false, 1),
        Value(id in wrong.named, 0, at_least=None if quick else 1),
        Value(len(set(wrong.named) - {id}), 0, at_most=None if quick else 0),
    ]
