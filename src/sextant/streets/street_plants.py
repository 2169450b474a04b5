# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Textures of trees and bushes of a simulated street, with leaves by season.

The branches depend on the seed only; `look` is a second random seed, of the leaves.
"""

from typing import List, NamedTuple, Sequence, Tuple

import cv2
import numpy as np

from sextant.streets import street_snow
from sextant.streets.street_surface import TEXELS, Texture, rough_noise, smooth_noise

LEAVES = {"summer": (1.0, 84.0), "autumn": (0.1, 140.0), "snow": (-0.5, 218.0)}  # density, tone; or of snow
LEAF = 0.05  # size of a leaf, metres
MARGIN = 0.35  # space for leaves around the twigs, metres
EDGE_THINNING = 2.0  # how strongly the leaves thin out towards the edge of a crown; 0: not at all

Point = Tuple[float, float]


class _Branch(NamedTuple):
    """A branch. Points are (x, y) in metres from the foot of the tree: x to the right, y up."""

    begin: Point
    end: Point
    thickness: float  # metres
    is_twig: bool  # whether it has leaves


def tree(seed: int, season: str, look: int) -> Texture:
    """Texture of a tree."""
    rng, look_rng = np.random.default_rng(seed), np.random.default_rng([seed, look])
    branches = _branches(rng, rng.uniform(3.5, 7))
    ends = np.array([branch.end for branch in branches])
    half_width, height = np.abs(ends[:, 0]).max() + MARGIN, ends[:, 1].max() + MARGIN
    wood = np.zeros((int(height * TEXELS), int(2 * half_width * TEXELS)), np.uint8)
    crown = np.zeros_like(wood)
    for branch, foliage_radius in zip(branches, _foliage_radii(rng, len(branches))):
        begin, end = (_texel((x + half_width, height - y)) for x, y in (branch.begin, branch.end))
        cv2.line(wood, begin, end, 255, max(1, int(branch.thickness * TEXELS)))
        if branch.is_twig:
            cv2.circle(crown, end, foliage_radius, 255, -1)
    return _grown(rng, look_rng, season, wood, crown)


def bush(seed: int, season: str, look: int) -> Texture:
    """Texture of a bush or hedge."""
    rng, look_rng = np.random.default_rng(seed), np.random.default_rng([seed, look])
    width, height = rng.uniform(1.5, 4.5), rng.uniform(1.0, 2.0)
    wood = np.zeros((int(height * TEXELS), int(width * TEXELS)), np.uint8)
    crown = np.zeros_like(wood)
    feet = rng.uniform(MARGIN, width - MARGIN, int(25 * width))
    x = np.clip(feet + rng.normal(0, 0.2, len(feet)), MARGIN, width - MARGIN)
    y = rng.uniform(MARGIN, 0.7 * height, len(feet))
    for foot, *end, foliage_radius in zip(feet, x, y, _foliage_radii(rng, len(feet))):
        line = _texel((foot, height)), _texel(end)
        cv2.line(wood, *line, 255, 2)
        cv2.circle(crown, line[1], foliage_radius, 255, -1)
        cv2.line(crown, *line, 255, int(MARGIN * TEXELS))
    return _grown(rng, look_rng, season, wood, crown)


def _grown(
    rng: np.random.Generator, look_rng: np.random.Generator, season: str, wood: np.ndarray, crown: np.ndarray
) -> Texture:
    """Texture of a plant: adds leaves or snow to the branches.

    :param wood: mask of the branches, uint8 (rows, columns)
    :param crown: mask of the area that can have leaves, likewise
    """
    rows, columns = wood.shape
    grey = rng.uniform(40, 90) + 10 * rough_noise(rng, rows, columns)
    mask = wood.copy()
    if season in LEAVES:
        density, brightness = LEAVES[season]
        leafiness = 0.7 * smooth_noise(look_rng, rows, columns, LEAF * TEXELS)
        leafiness += 0.5 * smooth_noise(look_rng, rows, columns, 5 * LEAF * TEXELS) + 0.4 * rough_noise(
            look_rng, rows, columns
        )
        edge = 1 - cv2.blur(crown, (int(MARGIN * TEXELS), int(MARGIN * TEXELS))) / np.float32(255)
        leaves = (leafiness > EDGE_THINNING * edge - density) & (crown > 0)
        shade = 15 * smooth_noise(look_rng, rows, columns, 6 * LEAF * TEXELS)  # leaves shade each other
        texture = 28 * smooth_noise(look_rng, rows, columns, LEAF * TEXELS) + 14 * rough_noise(
            look_rng, rows, columns
        )
        grey[leaves] = (brightness + shade + texture)[leaves]
        mask[leaves] = 255
    if season in street_snow.DEPTH:
        street_snow.on_outline(grey, mask, street_snow.DEPTH[season])
    return Texture(np.clip(grey, 0, 255), mask, columns / TEXELS, rows / TEXELS)


def _branches(rng: np.random.Generator, height: float) -> List[_Branch]:
    """Trunk and branches of a tree that is about `height` metres high."""
    branches = []
    growing = [((0.0, 0.0), 0.0, 0.28 * height, rng.uniform(0.15, 0.35), 6)]
    while growing:
        begin, angle, length, thickness, levels_left = growing.pop()
        end = (begin[0] + length * np.sin(angle), max(begin[1] + length * np.cos(angle), MARGIN))
        branches.append(_Branch(begin, end, thickness, levels_left <= 2))
        for _ in range(int(rng.integers(2, 4)) if levels_left else 0):
            next_angle = angle + rng.normal(0, 0.5)
            next_length = length * rng.uniform(0.6, 0.8)
            growing.append((end, next_angle, next_length, 0.6 * thickness, levels_left - 1))
    return branches


def _foliage_radii(rng: np.random.Generator, count: int) -> List[int]:
    """Radii of the foliage around the ends of twigs, texels."""
    return (rng.uniform(0.4, 0.9, count) * MARGIN * TEXELS).astype(int).tolist()


def _texel(point: Sequence[float]) -> Tuple[int, int]:
    return int(point[0] * TEXELS), int(point[1] * TEXELS)
