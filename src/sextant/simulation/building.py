# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A simulated floor of a building: two corridors that look alike, with rooms, markers, pillars and photos.

The map frame has its origin at the left end of the lower corridor. Walls hide what is behind them.
"""

from typing import Dict, List, NamedTuple, Tuple

import numpy as np

import sextant
from sextant.geometry.plane_poses import in_frame, rotation

LENGTH, LOWER, UPPER = 40.0, 4.0, 16.0  # metres: length of the corridors, and y of their middles
CROSSINGS = (1.0, 20.0, 39.0)  # x of the corridors that connect both
ROOMS = (7.0, 15.0, 25.0, 33.0)  # x of the rooms' middles, beside each corridor
HALF_WIDTH, DOOR, HALF_ROOM, DEEP = 1.0, 0.6, 3.0, 6.0  # metres: of corridors, doors and rooms
CLASSES = ("blue_pillar", "red_pillar", "yellow_pillar")
FAMILY = "tag36h11"
BEHIND_WALL = 0.01  # metres
STEPS_OF_SIGHT = 40  # points on a line of sight that are tested
CAMERA_RANGE, MARKER_RANGE, HALF_VIEW = 5.0, 4.0, 0.6  # metres; radians
DETECTED = 0.9  # share of the pillars in view
FACING = 0.35  # least cosine of the angle between a marker's normal and the camera
MARKER_NOISE, MARKER_TURN = 0.03, 0.05  # metres, radians
RANGE_NOISE, BEARING_NOISE = (0.03, 0.01), 0.02  # metres, of the range; radians


class Marker(NamedTuple):
    """A printed marker on a wall."""

    id: int  # of FAMILY
    pose: np.ndarray  # (3,) x, y and the direction of its normal


class Wall(NamedTuple):
    """A straight wall, seen from where the robot can be."""

    left: np.ndarray  # (2,) metres
    right: np.ndarray  # (2,) metres


class Building:
    """The floor; pillars differ by the seed."""

    def __init__(self, seed: int = 0):
        rng = np.random.default_rng([seed, 2])
        self._areas = np.array(_areas())  # (n, 4) x and y, from and to, in which the robot can be
        self.nodes, self.edges = _ways()
        self.markers = [Marker(number, np.array(pose)) for number, pose in enumerate(_MARKERS)]
        self.pillars = np.array(_pillars(rng))  # (n, 2)
        self.classes = [CLASSES[index] for index in rng.integers(len(CLASSES), size=len(self.pillars))]

    def is_inside(self, points: np.ndarray) -> np.ndarray:
        """Whether each point (..., 2) is in a corridor or a room."""
        x, y = points[..., :1], points[..., 1:]
        x0, y0, x1, y1 = self._areas.T
        return np.any((x >= x0) & (x <= x1) & (y >= y0) & (y <= y1), axis=-1)

    def sees(self, position: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Whether no wall is between a position (2,) and each point (n, 2)."""
        share = np.linspace(0.02, 0.98, STEPS_OF_SIGHT)[:, None, None]
        return self.is_inside(position + share * (points - position)).all(axis=0)

    def walls(self) -> List[Wall]:
        """The walls around everything that is inside."""
        parts = {}
        for x0, y0, x1, y1 in self._areas:
            corners = np.array([(x0, y0), (x0, y1), (x1, y1), (x1, y0), (x0, y0)])
            for left, right in zip(corners, corners[1:]):  # clockwise: the inside is to the right of each
                for part in self._outer_parts(left, right):
                    parts[tuple(np.round([*part.left, *part.right], 6))] = part
        return _joined(list(parts.values()))

    def _outer_parts(self, left: np.ndarray, right: np.ndarray) -> List[Wall]:
        """The parts of the side of an area behind which is no other area, between the limits of all areas."""
        axis = int(np.argmax(np.abs(right - left)))
        limits = self._areas[:, axis::2].ravel()
        low, high = sorted((left[axis], right[axis]))
        cuts = np.unique([low, *limits[(limits > low) & (limits < high)], high])
        cuts = cuts if right[axis] > left[axis] else cuts[::-1]
        ends = np.where(np.arange(2) == axis, cuts[:, None], left)
        ahead = (right - left) / np.linalg.norm(right - left)
        behind = BEHIND_WALL * np.array([-ahead[1], ahead[0]])
        parts = [Wall(*pair) for pair in zip(ends, ends[1:])]
        return [part for part in parts if not self.is_inside(0.5 * (part.left + part.right) + behind)]

    def twin(self, pose: np.ndarray) -> np.ndarray:
        """The pose (3,) at which the building looks the same: in the other corridor, or in its room."""
        return np.array([LENGTH - pose[0], LOWER + UPPER - pose[1], pose[2] + np.pi])

    def visible_pillars(self, pose: np.ndarray) -> np.ndarray:
        """Indices of the pillars in view of a camera at a pose (3,)."""
        return np.flatnonzero(self._in_view(pose, self.pillars, CAMERA_RANGE))

    def visible_markers(self, pose: np.ndarray) -> List[Marker]:
        """The markers that a camera at a pose (3,) can read."""
        poses = np.array([marker.pose for marker in self.markers])
        is_seen = self._in_view(pose, poses[:, :2], MARKER_RANGE)
        towards = pose[:2] - poses[:, :2]
        facing = np.cos(poses[:, 2] - np.arctan2(towards[:, 1], towards[:, 0])) > FACING
        return [marker for marker, is_read in zip(self.markers, is_seen & facing) if is_read]

    def _in_view(self, pose: np.ndarray, points: np.ndarray, reach: float) -> np.ndarray:
        x, y = in_frame(pose, points).T
        is_near = (np.hypot(x, y) < reach) & (np.abs(np.arctan2(y, x)) < HALF_VIEW)
        is_near[is_near] = self.sees(pose[:2], points[is_near])
        return is_near


def observed_pillars(building: Building, pose: np.ndarray, rng: np.random.Generator) -> List:
    """sextant.LabelledObservation of the pillars that are detected at a pose (3,)."""
    found = []
    for index in building.visible_pillars(pose):
        if rng.random() < DETECTED:
            at = in_frame(pose, building.pillars[index][None])[0]
            distance, axes = np.hypot(*at), rotation(np.arctan2(at[1], at[0]))
            sigmas = np.array([RANGE_NOISE[0] + RANGE_NOISE[1] * distance, BEARING_NOISE * distance])
            seen = at + axes @ (sigmas * rng.standard_normal(2))
            observation = sextant.Observation2D(seen, axes @ np.diag(sigmas**2) @ axes.T)
            label = sextant.LandmarkLabel(building.classes[index])
            found.append(sextant.LabelledObservation(label, observation))
    return found


def observed_markers(building: Building, pose: np.ndarray, rng: np.random.Generator) -> List:
    """sextant.LabelledObservation of the markers that are read at a pose (3,)."""
    found = []
    sigmas = np.array([MARKER_NOISE, MARKER_NOISE, MARKER_TURN])
    for marker in building.visible_markers(pose):
        turn = marker.pose[2] - pose[2]
        at = np.array([*in_frame(pose, marker.pose[None, :2])[0], turn]) + sigmas * rng.standard_normal(3)
        observation = sextant.Observation2D(at[:2], np.diag(sigmas**2), float(at[2]))
        found.append(sextant.LabelledObservation(sextant.LandmarkLabel(FAMILY, marker.id), observation))
    return found


def landmark_map(
    building: Building, rng: np.random.Generator, sigma: float = 0.03
) -> Tuple[List, List, np.ndarray]:
    """A map of pillars and markers with errors: landmarks, labels, and the covariance with the robot first.

    :param sigma: standard deviation of each coordinate, metres and radians
    """
    landmarks, labels = [], []
    for position, name in zip(building.pillars, building.classes):
        landmarks.append(sextant.Landmark2D(position + sigma * rng.standard_normal(2)))
        labels.append(sextant.LandmarkLabel(name))
    for marker in building.markers:
        *position, heading = marker.pose + sigma * rng.standard_normal(3)
        landmarks.append(sextant.Landmark2D(position, float(heading)))
        labels.append(sextant.LandmarkLabel(FAMILY, marker.id))
    size = 3 + 2 * len(building.pillars) + 3 * len(building.markers)
    return landmarks, labels, sigma**2 * np.eye(size)


def _joined(parts: List[Wall]) -> List[Wall]:
    """Walls of parts that continue one another."""

    walls: List[Wall] = []
    for part in sorted(parts, key=_place):
        continues = walls and _place(walls[-1])[:3] == _place(part)[:3]
        continues = continues and np.allclose(walls[-1].right, part.left)
        walls.append(Wall(walls.pop().left, part.right) if continues else part)
    return walls


def _place(part: Wall) -> Tuple[float, ...]:
    """Direction (2) of a wall, distance of its line to the origin, and where it begins on it."""
    ahead = np.sign(np.round(part.right - part.left, 6))
    across, along = np.dot([-ahead[1], ahead[0]], part.left), np.dot(ahead, part.left)
    return (*ahead, *np.round([across, along], 6))


def _areas() -> List[Tuple[float, float, float, float]]:
    areas = [(0.0, y - HALF_WIDTH, LENGTH, y + HALF_WIDTH) for y in (LOWER, UPPER)]
    areas += [(x - HALF_WIDTH, LOWER, x + HALF_WIDTH, UPPER) for x in CROSSINGS]
    for x in ROOMS:
        for y, side in ((LOWER, -1.0), (UPPER, 1.0)):
            wall = y + side * HALF_WIDTH
            door, inside, end = wall - 0.1 * side, wall + 0.2 * side, wall + DEEP * side
            areas.append((x - HALF_ROOM, min(inside, end), x + HALF_ROOM, max(inside, end)))
            areas.append((x - DOOR, min(door, inside + 0.1 * side), x + DOOR, max(door, inside + 0.1 * side)))
    return areas


def _ways() -> Tuple[np.ndarray, Dict[int, List[int]]]:
    """Nodes (n, 2) and the neighbours of each, between which the robot drives straight."""
    nodes: List[Tuple[float, float]] = []
    pairs: List[Tuple[int, int]] = []
    rows = []
    for y, side in ((LOWER, -1.0), (UPPER, 1.0)):
        along = sorted([*CROSSINGS, *ROOMS])
        first = len(nodes)
        nodes += [(x, y) for x in along]
        pairs += [(first + k, first + k + 1) for k in range(len(along) - 1)]
        rows.append([first + along.index(x) for x in CROSSINGS])
        for x in ROOMS:
            pairs.append((first + along.index(x), len(nodes)))
            nodes.append((x, y + side * (HALF_WIDTH + 0.5 * DEEP)))
    pairs += list(zip(*rows))
    edges: Dict[int, List[int]] = {node: [] for node in range(len(nodes))}
    for one, other in pairs:
        edges[one].append(other)
        edges[other].append(one)
    return np.array(nodes), edges


def _pillars(rng: np.random.Generator) -> List[Tuple[float, float]]:
    """Along the corridors, and in the corners of rooms."""
    found = []
    for y in (LOWER, UPPER):
        for x in np.arange(4.0, LENGTH - 2, 6.0):
            found.append((x + rng.uniform(-1.5, 1.5), y + rng.choice([-0.8, 0.8])))
        for x in ROOMS:
            side = np.sign(y - 10)
            depth = HALF_WIDTH + rng.uniform(0.6, 0.9) * DEEP
            found.append((x + rng.choice([-2.2, 2.2]), y + side * depth))
    return found


_LEFT, _RIGHT, _UP, _DOWN = np.pi, 0.0, np.pi / 2, -np.pi / 2  # directions of normals
_MARKERS = (
    (0.0, LOWER, _RIGHT),
    (LENGTH, LOWER, _LEFT),
    (0.0, UPPER, _RIGHT),
    (LENGTH, UPPER, _LEFT),
    (12.0, LOWER + HALF_WIDTH, _DOWN),
    (29.0, UPPER - HALF_WIDTH, _UP),
    (CROSSINGS[1], LOWER - HALF_WIDTH, _UP),
    (CROSSINGS[1], UPPER + HALF_WIDTH, _DOWN),
    (ROOMS[0], LOWER - HALF_WIDTH - DEEP, _UP),
    (ROOMS[3], UPPER + HALF_WIDTH + DEEP, _DOWN),
)
