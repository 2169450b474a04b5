# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the simulated building looks like on a day: two corridors that differ in some posters only.

Between two days the light changes, and some of the posters.
"""

from typing import List, Tuple

import numpy as np

from sextant.buildings.building_textures import (
    HEIGHT,
    PAINTERS,
    bare_wall,
    ceiling_texture,
    floor_texture,
    pillar,
    poster,
    print_marker,
)
from sextant.simulation.building import CLASSES, FAMILY, LENGTH, LOWER, UPPER, Building, Marker, Wall
from sextant.simulation.image_pyramid import pyramid
from sextant.simulation.uprights import Upright, with_coarse

MARKER_SIZE, MARKER_HEIGHT = 0.2, 1.2  # metres: edge length, and height of the centre above the floor
PILLAR_RADIUS, PILLAR_HEIGHT = 0.12, 1.5  # metres
PILLAR_TONES = (70.0, 120.0, 190.0)  # grey levels, by class
PANEL = 2.0  # metres, largest width of a part of a wall
FREE, ALIKE, CHANGED = 0.3, 0.6, 0.2  # shares of panels: bare, as in the other corridor, changed between days
GAINS = (0.8, 1.0)  # of the light, by day
PHOTO_DAY, DRIVE_DAY = 0, 1  # of the maps, and of the drives by them
UNEVEN, LIGHT_WAVE = 0.12, np.array([0.7, 0.5])  # of the light: relative change, and rad/m along x and y


class BuildingLooks:
    """Textures of all surfaces on a day."""

    def __init__(self, building: Building, seed: int = 0, day: int = 0):
        """:param seed: random seed of what hangs on the walls
        :param day: 0: of the photos, 1: of the drive
        """
        self._building, self._seed, self._day = building, seed, day
        self.panels: List[Upright] = []  # of the walls
        for wall in building.walls():
            self.panels += [self._panel(part) for part in _panels(wall)]
        self.pillars: List[np.ndarray] = []  # uint8 (rows, columns), by class
        for number, tone in enumerate(PILLAR_TONES):
            self.pillars.append(pillar(number, GAINS[day] * tone))
        self.floor, self.ceiling = (
            pyramid((GAINS[day] * plane).astype(np.uint8)) for plane in (floor_texture(), ceiling_texture())
        )

    def pillar_texture(self, index: int) -> np.ndarray:
        """Texture of a pillar of the building, uint8 (rows, columns)."""
        return self.pillars[CLASSES.index(self._building.classes[index])]

    def _panel(self, wall: Wall) -> Upright:
        width = float(np.linalg.norm(wall.right - wall.left))
        grey = bare_wall(width)
        markers = [(marker, at) for marker in self._building.markers for at in _places_on(wall, marker)]
        if not markers:
            self._hang(grey, wall)
        for marker, share in markers:
            at = share * (grey.shape[1] - 1), (1 - MARKER_HEIGHT / HEIGHT) * (grey.shape[0] - 1)
            print_marker(grey, FAMILY, marker.id, MARKER_SIZE, at)
        places = np.linspace(wall.left, wall.right, grey.shape[1])
        grey = np.clip(grey * self._light(places), 0, 255).astype(np.uint8)
        return with_coarse(Upright(wall.left, wall.right, HEIGHT, grey, None))

    def _hang(self, grey: np.ndarray, wall: Wall) -> None:
        """What hangs on a part of a wall, in place."""
        pair, own = _keys(wall)
        alike = np.random.default_rng([self._seed, 1, *pair]).random() < ALIKE
        key = pair if alike else own
        rng = np.random.default_rng([self._seed, 2, *key])
        if rng.random() < FREE or grey.shape[1] < 200:
            return
        paint = PAINTERS[rng.integers(len(PAINTERS))]
        if paint is poster and np.random.default_rng([self._seed, 3, *own]).random() < CHANGED:
            rng = np.random.default_rng([self._seed, 4 + self._day, *own])
        paint(grey, rng, grey.shape[1] * rng.uniform(0.4, 0.6))

    def _light(self, places: np.ndarray) -> np.ndarray:
        """Light (n,) at places (n, 2), relative to the reflectance."""
        wave = np.sin(places @ LIGHT_WAVE + 2.0 * self._day)
        return GAINS[self._day] * (1 + UNEVEN * wave)


def _panels(wall: Wall) -> List[Wall]:
    """Parts of a wall of equal width, PANEL at most."""
    count = int(np.ceil(np.linalg.norm(wall.right - wall.left) / PANEL - 1e-6))
    ends = np.linspace(wall.left, wall.right, count + 1)
    return [Wall(*pair) for pair in zip(ends, ends[1:])]


def _places_on(wall: Wall, marker: Marker) -> List[float]:
    """Where a marker is on a wall, as a fraction from left to right; empty: it is on another one."""
    along = wall.right - wall.left
    width = np.linalg.norm(along)
    across, beside = along / width, marker.pose[:2] - wall.left
    normal = np.array([across[1], -across[0]])
    is_on = abs(beside @ normal) < 0.01 and normal @ [np.cos(marker.pose[2]), np.sin(marker.pose[2])] > 0.99
    share = beside @ across / width
    reach = MARKER_SIZE / width
    return [float(share)] if is_on and -reach < share < 1 + reach else []


def _keys(wall: Wall) -> Tuple[Tuple[int, int], Tuple[int, int]]:
    """Of a part of a wall: one that it shares with the part that looks the same, and its own; centimetres."""
    middle = 0.5 * (wall.left + wall.right)
    own, twin = (
        tuple(int(each) for each in np.rint(100 * (place + 100.0)))
        for place in (middle, np.array([LENGTH, LOWER + UPPER]) - middle)
    )
    return min(own, twin), own
