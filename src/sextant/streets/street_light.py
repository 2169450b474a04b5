# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Light on the uprights of a simulated street: by their direction to the sun, with shadows."""

from typing import List, Sequence

import cv2
import numpy as np

from sextant.streets.street_conditions import StreetConditions
from sextant.streets.street_shadows import Caster, Sun, upright_shadow
from sextant.streets.street_surface import TEXELS, Texture, smooth_noise

GAIN = 1.6  # brightness of a surface that faces the sun, relative to one in diffuse light
ROUND = 0.6  # light on round objects (plants, people), relative to a surface that faces the sun
RELIEF = 1.2  # contrast of the relief of a wall in directional light, relative to its texture
RELIEF_STEP, MAX_RELIEF = 2, 60.0  # texels; difference in brightness above which it is colour, not relief
SOAKED = 0.6  # how much darker soaked walls are


def sun_of(conditions: StreetConditions) -> Sun:
    """Direction of the light."""
    return Sun(np.array([np.cos(conditions.sun), np.sin(conditions.sun)]), conditions.sun_height)


def lit(
    texture: Texture,
    left: np.ndarray,
    right: np.ndarray,
    conditions: StreetConditions,
    casters: Sequence[Caster],
) -> np.ndarray:
    """Brightness, float32 (rows, columns), of a texture that stands between two points, with cast shadows."""
    along, sun = (right - left) / np.linalg.norm(right - left), sun_of(conditions)
    facing = ROUND
    grey = texture.grey
    if texture.mask is None:
        facing = max(0.0, float(along[1] * sun.toward[0] - along[0] * sun.toward[1]))
        grey = _in_relief(grey, float(along @ sun.toward), conditions)
        if conditions.wet:
            grey = _wetted(grey, left, conditions)
    share = np.float32(conditions.direct * GAIN * facing)
    if share == 0:
        return grey * np.float32(1 - conditions.direct)
    shadow = upright_shadow(casters, sun, left, right, texture.height)
    open_ = 1 - cv2.resize(shadow, grey.shape[::-1], interpolation=cv2.INTER_LINEAR) / np.float32(255)
    return grey * (np.float32(1 - conditions.direct) + share * open_)


def _in_relief(grey: np.ndarray, along: float, conditions: StreetConditions) -> np.ndarray:
    """Adds the light and dark sides of what protrudes; along: component of the light along the wall."""
    away = -np.sign(along), min(conditions.sun_height, 1.0)  # of the light, to the right and down
    move = np.float32([[1, 0, RELIEF_STEP * away[0]], [0, 1, RELIEF_STEP * away[1]]])
    moved = cv2.warpAffine(grey, move, grey.shape[::-1], borderMode=cv2.BORDER_REPLICATE)
    raised = np.clip(grey - moved, -MAX_RELIEF, MAX_RELIEF)
    return grey + np.float32(RELIEF * conditions.direct) * raised


def _wetted(grey: np.ndarray, left: np.ndarray, conditions: StreetConditions) -> np.ndarray:
    """Darkens a wall where rain soaks it: in streaks from above, and above the ground."""
    rng = np.random.default_rng([conditions.look, *np.abs(np.rint(100 * left)).astype(int)])
    rows, columns = grey.shape
    soaked = 0.8 * smooth_noise(rng, rows, columns, 1.5 * TEXELS)
    soaked += 0.7 * cv2.resize(smooth_noise(rng, 8, columns, 0.2 * TEXELS), (columns, rows))
    soaked += 0.4 * smooth_noise(rng, rows, columns, 0.2 * TEXELS)
    splash = np.exp(np.linspace(-rows / TEXELS, 0, rows, dtype=np.float32) / np.float32(0.5))
    share = np.clip(0.5 + 1.2 * soaked + 2 * splash[:, None], 0, 1)
    return grey * (1 - np.float32(SOAKED * conditions.wet) * share)


def roughly_lit(
    texture: Texture, left: np.ndarray, right: np.ndarray, conditions: StreetConditions, seed: int
) -> np.ndarray:
    """The same without cast shadows: walls have random ones, which depend on the sun."""
    along = (right - left) / np.linalg.norm(right - left)
    facing = abs(along[0] * np.sin(conditions.sun) - along[1] * np.cos(conditions.sun))
    grey = texture.grey * (1 - conditions.direct + conditions.direct * GAIN * facing)
    if texture.mask is None:
        _shade(grey, left, conditions, seed)
    return grey


def _shade(grey: np.ndarray, left: np.ndarray, conditions: StreetConditions, seed: int) -> None:
    """Adds random shadows that depend on the sun."""
    key = np.abs(np.rint([100 * left[0], 100 * left[1], 50 * conditions.sun])).astype(int)
    rng = np.random.default_rng([seed, *key])
    rows, columns = grey.shape
    for _ in range(int(rng.integers(0, 3))):
        x, y = rng.uniform(0, columns, 3), rng.uniform(0, rows)
        corners = np.array([[x[0], rows], [x[1], rows], [x[2], y]], np.int32)
        shadow = np.zeros(grey.shape, np.uint8)
        cv2.fillPoly(shadow, [corners], 255)
        grey[shadow > 0] *= 1 - 0.7 * conditions.direct


def rough_ground_shadows(uprights: Sequence, conditions: StreetConditions) -> List[np.ndarray]:
    """Corners (4, 2) of the shadow of each upright on the ground: all are rectangles."""
    away = -sun_of(conditions).toward / conditions.sun_height
    return [
        np.array([each.left, each.right, each.right + each.height * away, each.left + each.height * away])
        for each in uprights
    ]
