# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Shadows of a simulated street: outlines of uprights, projected onto the ground and other uprights.

Parallel light maps a plane to a plane by an affine transform.
"""

from typing import List, NamedTuple, Optional, Sequence, Tuple

import cv2
import numpy as np

from sextant.streets.street_surface import TEXELS, Texture

SHADOW_TEXELS = 24.0  # of outlines and of shadows on uprights, per metre
SOFT = 0.06  # standard deviation of the blur of an edge, metres
BESIDE = 0.05  # least distance of what casts a shadow to the plane it falls on, along the light, metres
GRAZING = 0.03  # sine of the least angle between light and a lit plane


class Sun(NamedTuple):
    """Direction of the light."""

    toward: np.ndarray  # (2,) horizontal unit vector to the sun
    height: float  # tangent of its elevation


class Caster(NamedTuple):
    """An upright that casts a shadow."""

    left: np.ndarray  # (2,) metres
    right: np.ndarray  # (2,) metres
    height: float  # metres
    outline: np.ndarray  # uint8 (rows, columns), opacity at SHADOW_TEXELS per metre


def caster(left: np.ndarray, right: np.ndarray, texture: Texture) -> Caster:
    """The caster of a texture that stands between two points of the ground."""
    rows, columns = texture.grey.shape
    size = tuple(max(2, round(side * SHADOW_TEXELS / TEXELS)) for side in (columns, rows))
    opaque = np.full((2, 2), 255, np.uint8) if texture.mask is None else texture.mask
    return Caster(left, right, texture.height, cv2.resize(opaque, size, interpolation=cv2.INTER_AREA))


def ground_shadow(
    casters: Sequence[Caster], sun: Sun, origin: np.ndarray, texels: float, shape: Tuple[int, int]
) -> np.ndarray:
    """Opacity of the shadow on the ground, uint8 of a shape (rows, columns).

    :param origin: (2,) position of the first texel, metres
    :param texels: per metre
    """
    shadow = np.zeros(shape, np.uint8)
    for each in casters:
        away = -sun.toward * each.height / sun.height
        corners = np.array([each.left + away, each.right + away, each.left])
        _add(shadow, each.outline, (corners - origin) * texels)
    return cv2.GaussianBlur(shadow, (0, 0), SOFT * texels)


def upright_shadow(
    casters: Sequence[Caster], sun: Sun, left: np.ndarray, right: np.ndarray, height: float
) -> np.ndarray:
    """Opacity of the shadow on an upright between two points, uint8, at SHADOW_TEXELS per metre."""
    width = np.linalg.norm(right - left)
    along = (right - left) / width
    shape = tuple(max(2, round(side * SHADOW_TEXELS)) for side in (height, width))
    shadow = np.zeros(shape, np.uint8)
    across = np.array([along[1], -along[0]])
    if abs(across @ sun.toward) < GRAZING:
        return shadow
    ends = np.reshape([[each.left, each.right] for each in casters], (-1, 2, 2)) - left
    behind = ends @ across / (across @ sun.toward)  # along the light, metres
    at = (ends - behind[:, :, None] * sun.toward) @ along
    top = np.array([each.height for each in casters]) - behind.min(axis=1) * sun.height
    hits = (behind.max(axis=1) > BESIDE) & (at.max(axis=1) > 0) & (at.min(axis=1) < width) & (top > 0)
    for i in np.flatnonzero(hits):
        outline = _before(casters[i].outline, behind[i])
        high = casters[i].height - behind[i] * sun.height
        corners = [(at[i, 0], height - high[0]), (at[i, 1], height - high[1])]
        corners.append((at[i, 0], height + behind[i, 0] * sun.height))
        _add(shadow, outline, np.array(corners) * SHADOW_TEXELS)
    return cv2.GaussianBlur(shadow, (0, 0), SOFT * SHADOW_TEXELS)


def _before(outline: np.ndarray, behind: np.ndarray) -> np.ndarray:
    """The outline without the columns that are on the far side of the plane; behind: of both ends."""
    if behind.min() > BESIDE:
        return outline
    lies = np.linspace(*behind, outline.shape[1]) > BESIDE
    return outline * lies.astype(np.uint8)


def _add(shadow: np.ndarray, outline: np.ndarray, corners: np.ndarray) -> None:
    """Draws an outline with its upper left, upper right and lower left corners (3, 2) at texels, in place."""
    far = corners[1] + corners[2] - corners[0]
    box = _box(np.vstack([corners, far]), shadow.shape)
    if box is None:
        return
    left, top, stop_x, stop_y = box
    rows, columns = outline.shape
    source = np.float32([[0, 0], [columns, 0], [0, rows]]) - np.float32(0.5)
    to = cv2.getAffineTransform(source, np.float32(corners - (left, top) - 0.5))
    part = shadow[top:stop_y, left:stop_x]
    np.maximum(part, cv2.warpAffine(outline, to, (stop_x - left, stop_y - top)), out=part)


def _box(corners: np.ndarray, shape: Tuple[int, int]) -> Optional[List[int]]:
    """Left, top, right and bottom of the bounding box in an image; None if it is outside."""
    low = np.maximum(np.floor(corners.min(axis=0)), 0).astype(int)
    high = np.minimum(np.ceil(corners.max(axis=0)), shape[::-1]).astype(int)
    return [*low, *high] if np.all(high > low) else None
