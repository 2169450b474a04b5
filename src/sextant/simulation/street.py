# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A simulated walk around a block: houses, trees and cars along a loop, at a season and in a light.

Metres, x and y on the ground, z up. The walk goes counterclockwise; its arc length begins at 0.
"""

from dataclasses import dataclass
from typing import List, NamedTuple, Optional, Tuple

import cv2
import numpy as np

from sextant.base.strict_params import StrictParams, one_of, param, within
from sextant.simulation.street_ground import ground
from sextant.simulation.street_plants import bush, tree
from sextant.simulation.street_sky import panorama
from sextant.simulation.street_textures import SEASONS, Texture, car, facade

LENGTH, WIDTH, CORNER = 120.0, 70.0, 12.0  # of the block, and the radius of its corners
COARSER = 4  # times, the texels of what is seen from afar
SUN_HEIGHT = 0.7  # tangent of its elevation


@dataclass(frozen=True)
class StreetConditions(StrictParams):
    """What changes between two walks along the same street."""

    season: str = param("summer", one_of(*SEASONS))
    look: int = 0  # which blinds, posters, leaves and cars there are
    sun: float = 0.6  # direction of the light, radians from x
    direct: float = param(0.35, within(0, 1))  # share of light that has a direction
    exposure: float = param(1.0, within(1e-3, 4))
    noise: float = param(3.0, within(0, 50))  # grey levels of the camera


CONDITIONS = {
    "summer": StreetConditions(),
    "evening": StreetConditions("summer", 1, 2.4, 0.55, 0.7),
    "autumn": StreetConditions("autumn", 2, 1.2, 0.3, 0.9),
    "winter": StreetConditions("winter", 3, -0.6, 0.1, 1.05),
    "dusk": StreetConditions("winter", 4, 2.9, 0.6, 0.35, 6.0),
}


class Upright(NamedTuple):
    """A texture that stands on the ground between two points, as it is lit."""

    left: np.ndarray  # (2,) as seen from the street
    right: np.ndarray
    height: float
    grey: np.ndarray  # uint8
    mask: Optional[np.ndarray]
    coarse: Optional["Upright"] = None  # the same with fewer texels, for afar


class Street:
    """What stands along the loop, the same for a seed in all conditions but for what they change."""

    def __init__(self, seed: int = 1, conditions: StreetConditions = CONDITIONS["summer"]):
        self.seed, self.conditions = seed, conditions
        self._corners, self._arc = _loop()
        self.length = float(self._arc[-1])  # of the walk
        self.uprights: List[Upright] = []
        for side in (-1, 1):
            self._line(np.random.default_rng([seed, side + 1]), side)
        self._park(np.random.default_rng([seed, 2, conditions.look]))
        season, look = conditions.season, conditions.look
        self.ground = ground(seed, season, look, self._corners, self._shadows(), conditions.direct)
        self.sky = panorama(seed, season, look)

    def pose(self, arc: float, aside: float = 0.0, turn: float = 0.0) -> np.ndarray:
        """(x, y, yaw) of a walker at an arc length, aside metres to the left, turned by radians."""
        along = self._point(arc + 0.5) - self._point(arc - 0.5)
        along /= np.linalg.norm(along)
        x, y = self._point(arc) + aside * np.array([-along[1], along[0]])
        return np.array([x, y, np.arctan2(along[1], along[0]) + turn])

    def _point(self, arc: float) -> np.ndarray:
        return np.array([np.interp(arc % self.length, self._arc, self._corners[:, axis]) for axis in (0, 1)])

    def _line(self, rng: np.random.Generator, side: int) -> None:
        season, look, arc = self.conditions.season, self.conditions.look, 0.0
        while arc < self.length:
            width, height, back = rng.uniform(6, 14), rng.uniform(4, 11), rng.uniform(6, 9)
            seed, kind, turn = int(rng.integers(1 << 30)), rng.random(), rng.normal(0, 0.04)
            at, near, has_tree = arc + rng.uniform(0, width), rng.uniform(3.8, 5.5), rng.random()
            if kind < 0.75:
                self._stand(arc + width / 2, side * back, facade(seed, width, height, look, season), turn)
            if kind > 0.5 or has_tree < 0.3:
                self._stand(at, side * near, tree(seed + 1, season, look))
            for number in range(int(rng.integers(0, 5))):
                bush_at, aside = arc + rng.uniform(0, width), rng.uniform(5.5, min(back, 7.0))
                self._stand(bush_at, side * aside, bush(seed + 2 + number, season, look))
            arc += 1.02 * width

    def _park(self, rng: np.random.Generator) -> None:
        for arc in np.arange(0, self.length, 14):
            where, side, seed = arc + rng.uniform(0, 8), rng.choice([-1, 1]), int(rng.integers(1 << 30))
            if rng.random() < 0.4:
                self._stand(where, 3.6 * side, car(seed))

    def _stand(self, arc: float, aside: float, texture: Texture, turn: float = 0.0) -> None:
        x, y, yaw = self.pose(arc, aside, turn)
        half = 0.5 * texture.width * np.array([np.cos(yaw), np.sin(yaw)])
        left, right = np.array([x, y]) - half, np.array([x, y]) + half
        if aside < 0:  # from the street, what comes later is at the left
            left, right = right, left
        grey = self._lit(texture, left, right)
        self.uprights.append(_with_coarse(Upright(left, right, texture.height, grey, texture.mask)))

    def _shadows(self) -> List[np.ndarray]:
        """Corners on the ground of what keeps the sun off."""
        away = -np.array([np.cos(self.conditions.sun), np.sin(self.conditions.sun)]) / SUN_HEIGHT
        return [
            np.array([each.left, each.right, each.right + each.height * away, each.left + each.height * away])
            for each in self.uprights
        ]

    def _lit(self, texture: Texture, left: np.ndarray, right: np.ndarray) -> np.ndarray:
        light, along = self.conditions, (right - left) / np.linalg.norm(right - left)
        facing = abs(along[0] * np.sin(light.sun) - along[1] * np.cos(light.sun))
        grey = texture.grey * (1 - light.direct + light.direct * 1.6 * facing)
        if texture.mask is None:
            self._shade(grey, left)
        return np.clip(grey * light.exposure, 0, 255).astype(np.uint8)

    def _shade(self, grey: np.ndarray, left: np.ndarray) -> None:
        """Shadows of what stands somewhere before it, which go with the sun."""
        where = np.abs(np.rint([100 * left[0], 100 * left[1], 50 * self.conditions.sun])).astype(int)
        rng = np.random.default_rng([self.seed, *where])
        rows, columns = grey.shape
        for _ in range(int(rng.integers(0, 3))):
            x, y = rng.uniform(0, columns, 3), rng.uniform(0, rows)
            corners = np.array([[x[0], rows], [x[1], rows], [x[2], y]], np.int32)
            shadow = np.zeros(grey.shape, np.uint8)
            cv2.fillPoly(shadow, [corners], 255)
            grey[shadow > 0] *= 1 - 0.7 * self.conditions.direct


def _with_coarse(upright: Upright) -> Upright:
    if min(upright.grey.shape) < 2 * COARSER**2:
        return upright
    size = tuple(side // COARSER for side in upright.grey.shape[::-1])
    grey, mask = (
        None if each is None else cv2.resize(each, size, interpolation=cv2.INTER_AREA)
        for each in (upright.grey, upright.mask)
    )
    return upright._replace(coarse=_with_coarse(upright._replace(grey=grey, mask=mask)))


def _loop() -> Tuple[np.ndarray, np.ndarray]:
    """Points of a rectangle with round corners, closed, and their arc lengths."""
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
