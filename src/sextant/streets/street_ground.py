# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Ground of a simulated street: road, kerb, pavement and lawn, covered with leaves or snow by season.

A coarse layout is combined with a finer, repeating grain. Both are image pyramids, for distant pixels.
"""

from typing import NamedTuple, Optional, Sequence, Tuple

import cv2
import numpy as np

from sextant.simulation.image_pyramid import Pyramid, pyramid, sampled
from sextant.streets.street_shadows import Caster, Sun, ground_shadow
from sextant.streets.street_surface import SNOW, repeating_noise, rough_noise, smooth_noise

ORIGIN, EXTENT = np.array([-25.0, -25.0]), (170.0, 120.0)  # of the layout, metres
LAYOUT_TEXELS, PUDDLE_TEXELS = 20.0, 10.0  # per metre
FILM = 0.35  # reflectance of a film of water, relative to that of a puddle
GRAIN_SIDE, GRAIN_TEXELS = 2048, 150.0  # texels; texels per metre
ROAD, KERB, PAVEMENT = 3.2, 3.35, 5.4  # distance of the outer edges to the centre line, metres
FALLEN = {"autumn": 0.35, "bare": 0.1}  # mean cover with fallen leaves on the road
MIDDLE = 128.0  # mean brightness of the grain
SHADOW, FOOT = 0.55, 0.6  # fraction of directional light blocked by shadows; brightness below uprights


class Ground(NamedTuple):
    """Image pyramids of the ground, uint8 (rows, columns, 3)."""

    layout: Pyramid  # brightness, grass fraction, cover fraction; fractions are 0 to 255
    grain: Pyramid  # grain of stone, of grass, of the cover (leaves or snow)
    puddles: Optional[np.ndarray] = None  # uint8, 255: a mirror at grazing angles; None: the ground is dry

    def wetness(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """How much wet ground reflects at points of the ground, float32 (rows, columns), [0, 1]."""
        at = ((x - ORIGIN[0]) * PUDDLE_TEXELS, (y - ORIGIN[1]) * PUDDLE_TEXELS)
        seen = cv2.remap(self.puddles, *map(np.float32, at), cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT)
        return seen / np.float32(255)

    def seen(self, x: np.ndarray, y: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        """Brightness at points of the ground, float32 (rows, columns).

        :param x: y: (rows, columns) metres
        :param footprint: (rows,) size of a pixel on the ground, metres; decreasing
        """
        at = (x - ORIGIN[0]) * LAYOUT_TEXELS, (y - ORIGIN[1]) * LAYOUT_TEXELS
        tone, grass, cover = cv2.split(sampled(self.layout, *at, footprint * LAYOUT_TEXELS))
        at = [np.mod(each * GRAIN_TEXELS, GRAIN_SIDE) for each in (x, y)]
        near = sampled(self.grain, *at, footprint * GRAIN_TEXELS, cv2.BORDER_WRAP) - np.float32(MIDDLE)
        stone, blades, covering = cv2.split(near)
        bare = stone + grass / 255 * (blades - stone)
        return tone + bare + cover / 255 * (covering - bare)


def ground(seed: int, season: str, look: int, middle: np.ndarray, light: np.ndarray, wet: float) -> Ground:
    """Generates the ground along a road.

    :param look: random seed of leaves, tracks and puddles
    :param middle: (n, 2) closed centre line of the road, metres
    :param light: (rows, columns) relative brightness of the layout, see cast_light()
    :param wet: how much the ground reflects, [0, 1]
    """
    rng, look_rng = np.random.default_rng([seed, 5]), np.random.default_rng([seed, 6, look])
    tone, grass, distance = _bare(rng, middle)
    cover = _covered(look_rng, season, tone, distance)
    tone *= cv2.blur(light, (5, 5))
    layout = cv2.merge([_bytes(each) for each in (tone, 255 * grass, 255 * cover)])
    grain = pyramid(_grain(rng, look_rng, season))
    return Ground(pyramid(layout), grain, _puddles(look_rng, wet, grass) if wet else None)


def cast_light(casters: Sequence[Caster], sun: Sun, direct: float) -> np.ndarray:
    """Relative brightness of the layout in the shadows of casters, float32 (rows, columns).

    :param direct: fraction of directional light, [0, 1]
    """
    shadow = ground_shadow(casters, sun, ORIGIN, LAYOUT_TEXELS, _shape())
    return 1 - np.float32(direct / 255) * shadow


def rough_light(shadows: Sequence[np.ndarray], direct: float) -> np.ndarray:
    """The same in shadows of which only the corners (m, 2) are known, metres."""
    light = np.ones(_shape(), np.float32)
    for corners in shadows:
        cv2.fillPoly(light, [_texels(corners)], 1 - SHADOW * direct)
    return light


def darkened_feet(light: np.ndarray, feet: Sequence[Tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    """Darkens the ground below uprights, which are between two points (metres), in place."""
    for left, right in feet:
        cv2.line(light, _corner(left), _corner(right), FOOT, int(0.4 * LAYOUT_TEXELS))
    return light


def _puddles(rng: np.random.Generator, wet: float, grass: np.ndarray) -> np.ndarray:
    """Fraction of light that the ground reflects at grazing angles, uint8, PUDDLE_TEXELS per metre."""
    rows, columns = (int(side * PUDDLE_TEXELS / LAYOUT_TEXELS) for side in grass.shape)
    depth = smooth_noise(rng, rows, columns, 2.5 * PUDDLE_TEXELS)
    depth += 0.5 * smooth_noise(rng, rows, columns, 0.6 * PUDDLE_TEXELS)
    hard = 1 - cv2.resize(grass, (columns, rows), interpolation=cv2.INTER_AREA)
    return _bytes(255 * wet * (FILM + (1 - FILM) * np.clip(2 * depth - 0.6, 0, 1)) * hard)


def _shape() -> Tuple[int, int]:
    columns, rows = (int(extent * LAYOUT_TEXELS) for extent in EXTENT)
    return rows, columns


def _bare(rng: np.random.Generator, middle: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Brightness and grass fraction without cover, and distance to the centre line of the road in metres."""
    rows, columns = _shape()
    line = np.full((rows, columns), 255, np.uint8)
    cv2.polylines(line, [_texels(middle)], True, 0)
    distance = cv2.distanceTransform(line, cv2.DIST_L2, 5) / LAYOUT_TEXELS
    worn = 7 * smooth_noise(rng, rows, columns, 3 * LAYOUT_TEXELS) + 6 * smooth_noise(
        rng, rows, columns, LAYOUT_TEXELS / 2
    )
    worn += 5 * smooth_noise(rng, rows, columns, LAYOUT_TEXELS / 8)
    road = 105 + worn
    _repairs(rng, road, middle)
    road[np.abs(distance - 0.9 * ROAD) < 0.05] = 190  # road marking
    tone = 92 + 1.8 * worn
    for end, surface in ((PAVEMENT, _slabs(rng, rows, columns) + worn), (KERB, 150 + worn), (ROAD, road)):
        np.copyto(tone, surface, where=distance < end)
    tone[np.abs(distance - KERB) < 0.05] -= 45  # the gutter
    grass = np.clip((distance - PAVEMENT) * LAYOUT_TEXELS / 3, 0, 1)
    return tone, grass, distance


def _repairs(rng: np.random.Generator, road: np.ndarray, middle: np.ndarray) -> None:
    """Draws random patches, manholes and cracks."""
    for _ in range(260):
        at = middle[rng.integers(len(middle))] + rng.normal(0, 2.0, 2) + rng.uniform(-9, 9, 2)
        kind, size, tone = rng.random(), rng.uniform(0.3, 1.6, 2), float(rng.uniform(60, 125))
        if kind < 0.25:
            cv2.rectangle(road, *(_corner(at + side * size) for side in (-1, 1)), tone, -1)
        elif kind < 0.4:
            cv2.circle(road, _corner(at), int(0.35 * LAYOUT_TEXELS), tone, -1)
            cv2.circle(road, _corner(at), int(0.35 * LAYOUT_TEXELS), 50.0, 1)
        else:
            crack = at + np.cumsum(rng.normal(0, 0.25, (14, 2)) + rng.normal(0, 0.2, 2), axis=0)
            cv2.polylines(road, [_texels(crack)], False, 55.0)


def _slabs(rng: np.random.Generator, rows: int, columns: int) -> np.ndarray:
    side = int(0.5 * LAYOUT_TEXELS)
    tones = rng.normal(140, 9, (rows // side + 1, columns // side + 1)).astype(np.float32)
    slabs = np.repeat(np.repeat(tones, side, axis=0), side, axis=1)[:rows, :columns]
    slabs[::side] -= 28
    slabs[:, ::side] -= 28
    return slabs


def _covered(rng: np.random.Generator, season: str, tone: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Fraction covered with leaves or snow; snow changes the brightness in place."""
    rows, columns = tone.shape
    if season == "summer":
        return np.zeros(tone.shape, np.float32)
    drift = smooth_noise(rng, rows, columns, LAYOUT_TEXELS) + 0.7 * smooth_noise(
        rng, rows, columns, 4 * LAYOUT_TEXELS
    )
    if season in FALLEN:
        return np.clip(FALLEN[season] + 0.3 * drift + 0.3 * (distance > KERB), 0, 1)
    drift += 0.7 * smooth_noise(rng, rows, columns, LAYOUT_TEXELS / 5)
    ruts = np.exp(-(((distance - 0.8) / 0.2) ** 2))  # of cars
    cleared = 1 if season == "winter" else 0
    snow = np.clip(1.4 - 1.1 * ruts - 0.5 * cleared * (distance < ROAD) + 0.3 * drift, 0, 1)
    drifts = SNOW - 14 + 4 * drift + 5 * smooth_noise(rng, rows, columns, LAYOUT_TEXELS / 10)
    tone += snow * (drifts - tone)
    return snow


def _grain(rng: np.random.Generator, look_rng: np.random.Generator, season: str) -> np.ndarray:
    """Repeating grain of stone, grass and cover, uint8 (GRAIN_SIDE, GRAIN_SIDE, 3)."""
    side = GRAIN_SIDE
    stones = rough_noise(rng, side, side)
    chips = np.maximum(np.abs(repeating_noise(rng, side, 0.3)) - 1.6, 0)  # light chips in the tar
    stone = 15 * stones + 38 * chips
    blades = 24 * rough_noise(rng, side, side) + 9 * repeating_noise(rng, side, 0.2)
    snow = 6 * rough_noise(look_rng, side, side)
    covering = _leaves(look_rng, side) + 0.5 * stone if season in FALLEN else snow
    return cv2.merge([_bytes(MIDDLE + each) for each in (stone, blades, covering)])


def _leaves(rng: np.random.Generator, side: int) -> np.ndarray:
    """Brightness of fallen leaves, some centimetres long; 0 elsewhere."""
    lying = np.zeros((side, side), np.float32)
    for _ in range(int(70 * (side / GRAIN_TEXELS) ** 2)):
        axes = (int(rng.uniform(3, 6)), int(rng.uniform(2, 4)))
        at = tuple(int(each) for each in rng.uniform(0, side, 2))
        cv2.ellipse(lying, at, axes, rng.uniform(0, 180), 0, 360, float(rng.normal(28, 24)), -1)
    return lying


def _bytes(values: np.ndarray) -> np.ndarray:
    return np.clip(values, 0, 255).astype(np.uint8)


def _texels(points: np.ndarray) -> np.ndarray:
    return np.rint((np.asarray(points) - ORIGIN) * LAYOUT_TEXELS).astype(np.int32)


def _corner(point: np.ndarray) -> Tuple[int, int]:
    x, y = _texels(point)
    return int(x), int(y)
