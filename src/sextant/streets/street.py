# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulated street around a block: houses, trees and cars along a loop, in a season and a light.

Metres, x and y on the ground, z up. The arc length of the loop starts at 0 and grows counterclockwise.
"""

from typing import List, NamedTuple, Sequence, Tuple

import numpy as np

from sextant.simulation.uprights import Upright, with_coarse
from sextant.streets.street_conditions import CONDITIONS, StreetConditions
from sextant.streets.street_ground import cast_light, darkened_feet, ground, rough_light
from sextant.streets.street_light import lit, rough_ground_shadows, roughly_lit, sun_of
from sextant.streets.street_plants import bush, tree
from sextant.streets.street_shadows import Caster, caster
from sextant.streets.street_sky import panorama
from sextant.streets.street_surface import Texture
from sextant.streets.street_textures import facade
from sextant.streets.street_traffic import car, person, van

LENGTH, WIDTH, CORNER = 120.0, 70.0, 12.0  # of the block, and radius of its corners, metres
PARKING, VANS = 5.5, 0.5  # length of a parking space, metres; fraction of vans among the further cars


class _Standing(NamedTuple):
    """A texture that stands upright between two points."""

    left: np.ndarray  # (2,) metres
    right: np.ndarray  # (2,) metres
    texture: Texture


class Street:
    """Scene along the loop; the seed determines everything that StreetConditions does not describe."""

    def __init__(self, seed: int = 1, conditions: StreetConditions = CONDITIONS["summer"]):
        self.seed, self.conditions = seed, conditions
        self._corners, self._arc = _loop()
        self.length = float(self._arc[-1])  # of the loop, metres
        self._standing: List[_Standing] = []
        for side in (-1, 1):
            self._line(np.random.default_rng([seed, side + 1]), side)
        self._park(np.random.default_rng([seed, 2, conditions.look]))
        self._walk_about(np.random.default_rng([seed, 9, conditions.look]))
        casters = [caster(*each) for each in self._standing] if conditions.cast else []
        self.uprights = self._lit(casters)
        season, look = conditions.season, conditions.look
        self.ground = ground(seed, season, look, self._corners, self._ground_light(casters), conditions.wet)
        self.sky = panorama(seed, season, look, conditions.haze)

    def pose(self, arc: float, aside: float = 0.0, turn: float = 0.0) -> np.ndarray:
        """Pose (x, y, yaw) at an arc length, with an offset to the left and a rotation; metres, radians."""
        along = self._point(arc + 0.5) - self._point(arc - 0.5)
        along /= np.linalg.norm(along)
        x, y = self._point(arc) + aside * np.array([-along[1], along[0]])
        return np.array([x, y, np.arctan2(along[1], along[0]) + turn])

    def _point(self, arc: float) -> np.ndarray:
        """Point (2,) of the centre line."""
        return np.array([np.interp(arc % self.length, self._arc, self._corners[:, axis]) for axis in (0, 1)])

    def _line(self, rng: np.random.Generator, side: int) -> None:
        """Adds houses, trees and bushes along one side: -1 right, 1 left."""
        season, look, arc = self.conditions.season, self.conditions.look, 0.0
        while arc < self.length:
            width, height, back = rng.uniform(6, 14), rng.uniform(4, 11), rng.uniform(6, 9)
            seed, kind, turn = int(rng.integers(1 << 30)), rng.random(), rng.normal(0, 0.04)
            tree_at, near, has_tree = arc + rng.uniform(0, width), rng.uniform(3.8, 5.5), rng.random()
            if kind < 0.75:
                self._stand(arc + width / 2, side * back, facade(seed, width, height, look, season), turn)
            if kind > 0.5 or has_tree < 0.3:
                self._stand(tree_at, side * near, tree(seed + 1, season, look))
            for number in range(int(rng.integers(0, 5))):
                bush_at, aside = arc + rng.uniform(0, width), rng.uniform(5.5, min(back, 7.0))
                self._stand(bush_at, side * aside, bush(seed + 2 + number, season, look))
            arc += 1.02 * width

    def _park(self, rng: np.random.Generator) -> None:
        """Adds parked cars."""
        taken = []
        for arc in np.arange(0, self.length, 14):
            position, side, seed = arc + rng.uniform(0, 8), rng.choice([-1, 1]), int(rng.integers(1 << 30))
            if rng.random() < 0.4:
                self._stand(position, 3.6 * side, car(seed, self.conditions.season))
                taken.append(position * side)
        for _ in range(int(rng.poisson(self.conditions.parked * self.length / 10))):
            place, seed = rng.choice([-1, 1]) * rng.uniform(0, self.length), int(rng.integers(1 << 30))
            if np.abs(np.array([*taken, np.inf]) - place).min() > PARKING:
                kind = van if rng.random() < VANS else car
                self._stand(abs(place), 3.6 * np.sign(place), kind(seed, self.conditions.season))
                taken.append(place)

    def _walk_about(self, rng: np.random.Generator) -> None:
        """Adds pedestrians on the pavement, seen from the front or from behind."""
        for _ in range(int(rng.poisson(self.conditions.people * self.length / 10))):
            arc, aside = rng.uniform(0, self.length), rng.choice([-1, 1]) * rng.uniform(2.4, 5.2)
            turn = 0.5 * np.pi + rng.normal(0, 0.5)
            self._stand(arc, aside, person(int(rng.integers(1 << 30))), turn)

    def _stand(self, arc: float, aside: float, texture: Texture, turn: float = 0.0) -> None:
        """Adds a texture at an arc length with an offset to the left (metres), rotated by turn (radians)."""
        x, y, yaw = self.pose(arc, aside, turn)
        half = 0.5 * texture.width * np.array([np.cos(yaw), np.sin(yaw)])
        left, right = np.array([x, y]) - half, np.array([x, y]) + half
        if aside < 0:  # seen from the street, larger arc lengths are on the left
            left, right = right, left
        self._standing.append(_Standing(left, right, texture))

    def _lit(self, casters: Sequence[Caster]) -> List[Upright]:
        """The uprights in the light of the conditions."""
        uprights = []
        for left, right, texture in self._standing:
            if self.conditions.cast:
                grey = lit(texture, left, right, self.conditions, casters)
            else:
                grey = roughly_lit(texture, left, right, self.conditions, self.seed)
            grey = np.clip(grey * self.conditions.exposure, 0, 255).astype(np.uint8)
            uprights.append(with_coarse(Upright(left, right, texture.height, grey, texture.mask)))
        return uprights

    def _ground_light(self, casters: Sequence[Caster]) -> np.ndarray:
        """Brightness of the ground's layout relative to an open place."""
        if self.conditions.cast:
            light = cast_light(casters, sun_of(self.conditions), self.conditions.direct)
        else:
            shadows = rough_ground_shadows(self.uprights, self.conditions)
            light = rough_light(shadows, self.conditions.direct)
        return darkened_feet(light, [(each.left, each.right) for each in self._standing])


def _loop() -> Tuple[np.ndarray, np.ndarray]:
    """Points of a closed rectangle with round corners, and their arc lengths."""
    centres = [
        (LENGTH - CORNER, CORNER, -90),
        (LENGTH - CORNER, WIDTH - CORNER, 0),
        (CORNER, WIDTH - CORNER, 90),
        (CORNER, CORNER, 180),
    ]
    points = [
        (x + CORNER * np.cos(angle), y + CORNER * np.sin(angle))
        for x, y, begin in centres
        for angle in np.deg2rad(np.arange(begin, begin + 91, 5))
    ]
    closed = np.array([*points, points[0]])
    return closed, np.append(0.0, np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1)))
