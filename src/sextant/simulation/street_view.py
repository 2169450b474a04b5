# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Renders camera images of a simulated street: textured planes, back to front."""

from typing import NamedTuple, Optional, Tuple

import cv2
import numpy as np

from sextant.simulation.camera import HORIZONTAL_FOV
from sextant.simulation.street import COARSER, Street, Upright
from sextant.simulation.street_sky import SIDE
from sextant.simulation.street_sky import TEXELS as SKY_TEXELS

EYE = 1.5  # height of the camera above the ground, metres
NEAR, FAR = 0.5, 70.0  # clipping distances, metres
HAZE = 120.0  # distance at which uprights are fully hazed, metres
GROUND_HAZE, MAX_HAZE = 150.0, 0.6  # the same for the ground, metres; maximum fraction of haze there
HAZE_TONE = 170.0  # brightness
SHARP = 1.5  # texels per pixel above which a texture is reduced
SLANT = 2.5  # texels per pixel above which the ground is reduced, along the viewing direction


class _Camera(NamedTuple):
    """Camera with a horizontal optical axis; x, y in metres, the rest in pixels."""

    x: float
    y: float
    yaw: float
    width: int
    height: int
    f: float

    @property
    def centre(self) -> Tuple[float, float]:
        return (self.width - 1) / 2, (self.height - 1) / 2

    def depth_and_right(self, points: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Depth and lateral offset of points (n, 2) on the ground, metres."""
        offset = points - (self.x, self.y)
        cosine, sine = np.cos(self.yaw), np.sin(self.yaw)
        return offset @ (cosine, sine), offset @ (sine, -cosine)


def street_view(
    street: Street,
    pose: np.ndarray,
    size: Tuple[int, int] = (640, 480),
    seed: int = 0,
    horizontal_fov: float = HORIZONTAL_FOV,
) -> np.ndarray:
    """Renders an image, uint8 (height, width).

    :param pose: (x, y, yaw) of the camera, see Street.pose()
    :param size: width and height, pixels
    :param seed: random seed of the image noise
    :param horizontal_fov: radians
    """
    width, height = size
    camera = _Camera(*pose, width, height, 0.5 * width / np.tan(horizontal_fov / 2))
    sky = _sky(street, camera) * min(street.conditions.exposure, 1.05)
    image = np.concatenate([sky, _ground(street, camera)]).astype(np.float32)
    for upright in _far_to_near(street, camera):
        _draw(image, camera, upright, street.conditions.exposure)
    rng = np.random.default_rng([street.seed, street.conditions.look, seed])
    image += street.conditions.noise * rng.standard_normal(image.shape, np.float32)
    return np.clip(image, 0, 255).astype(np.uint8)


def _sky(street: Street, camera: _Camera) -> np.ndarray:
    """Brightness, float32, of the rows above the horizon."""
    centre_x, centre_y = camera.centre
    u, v = np.arange(camera.width), np.arange(int(centre_y) + 1)
    aside = np.arctan((u - centre_x) / camera.f)
    column = np.mod((camera.yaw - aside) * SKY_TEXELS, SIDE)
    tangent = np.outer((centre_y - v) / camera.f, np.cos(aside))
    at = np.tile(np.float32(column), (len(v), 1)), np.float32(len(street.sky) - 1 - tangent * SKY_TEXELS)
    return cv2.remap(street.sky, *at, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP).astype(np.float32)


def _ground(street: Street, camera: _Camera) -> np.ndarray:
    """Brightness, float32, of the rows below the horizon."""
    centre_x, centre_y = camera.centre
    u, v = np.arange(camera.width), np.arange(int(centre_y) + 1, camera.height)
    depth = (EYE * camera.f / (v - centre_y)).astype(np.float32)
    right = np.outer(depth, np.float32(u - centre_x) / np.float32(camera.f))
    cosine, sine = np.float32(np.cos(camera.yaw)), np.float32(np.sin(camera.yaw))
    x = camera.x + cosine * depth[:, None] + sine * right
    y = camera.y + sine * depth[:, None] - cosine * right
    ground = street.ground.seen(x, y, depth / camera.f * np.maximum(depth / EYE / SLANT, 1))
    haze = np.float32(np.minimum(depth / GROUND_HAZE, MAX_HAZE))[:, None]
    return (ground * (1 - haze) + HAZE_TONE * haze) * street.conditions.exposure


def _far_to_near(street: Street, camera: _Camera):
    """Uprights within the clipping distances, the farthest first."""
    visible = []
    for upright in street.uprights:
        depth, _ = camera.depth_and_right(np.array([upright.left, upright.right]))
        if depth.max() > NEAR and depth.min() < FAR:
            visible.append((depth.mean(), upright))
    return [upright for _, upright in sorted(visible, key=lambda each: -each[0])]


def _draw(image: np.ndarray, camera: _Camera, upright: Upright, exposure: float) -> None:
    """Draws an upright in place."""
    depth, right = camera.depth_and_right(np.array([upright.left, upright.right]))
    parts = _visible(depth, right, (camera.width / 2 + 1) / camera.f)
    nearest = (depth[0] + np.array(parts) * (depth[1] - depth[0])).min()
    upright, scale = _sharp_enough(upright, camera.f / max(nearest, NEAR))
    columns = upright.grey.shape[1]
    first, last = int(parts[0] * (columns - 1)), int(np.ceil(parts[1] * (columns - 1)))
    if last - first < 2:
        return
    parts = np.array([first, last]) / (columns - 1)
    depth, right = (each[0] + parts * (each[1] - each[0]) for each in (depth, right))
    corners = _projected(camera, depth, right, upright.height)
    box = _box(camera, corners)
    if box is None:
        return
    grey, mask = (_reduced(each, first, last, scale) for each in (upright.grey, upright.mask))
    if min(grey.shape) < 2:
        return
    left, top, stop_x, stop_y = box
    source = np.float32(
        [[0, 0], [grey.shape[1] - 1, 0], [grey.shape[1] - 1, grey.shape[0] - 1], [0, grey.shape[0] - 1]]
    )
    H = cv2.getPerspectiveTransform(source, np.float32(corners - (left, top)))
    size = (stop_x - left, stop_y - top)
    warped = cv2.warpPerspective(grey, H, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    opaque = cv2.warpPerspective(np.full_like(grey, 255) if mask is None else mask, H, size) / np.float32(255)
    haze = min(1.0, depth.min() / HAZE)
    part = image[top:stop_y, left:stop_x]
    part += opaque * (warped * (1 - haze) + HAZE_TONE * exposure * haze - part)


def _sharp_enough(upright: Upright, pixels: float) -> Tuple[Upright, float]:
    """The coarsest level of detail that is sharp enough, and its scale in the image; pixels: per metre."""
    width = np.linalg.norm(upright.right - upright.left)
    while True:
        scale = SHARP * pixels * width / upright.grey.shape[1]
        if upright.coarse is None or scale * COARSER > 1:
            return upright, min(1.0, scale)
        upright = upright.coarse


def _visible(depth: np.ndarray, right: np.ndarray, tangent: float) -> Tuple[float, float]:
    """Clips the segment between two points to the field of view; returns the fractions of its ends.

    :param tangent: of half the field of view
    """
    low, high = 0.0, 1.0
    for begin, end in (depth - NEAR, tangent * depth - right, tangent * depth + right):
        if begin < 0 and end < 0:
            return 0.0, 0.0
        if begin < 0:
            low = max(low, begin / (begin - end))
        elif end < 0:
            high = min(high, begin / (begin - end))
    return low, high


def _projected(camera: _Camera, depth: np.ndarray, right: np.ndarray, height: float) -> np.ndarray:
    """Pixels (4, 2) of the corners: upper left, upper right, lower right, lower left."""
    centre_x, centre_y = camera.centre
    u = centre_x + camera.f * right / depth
    top, bottom = (centre_y + camera.f * (EYE - z) / depth for z in (height, 0.0))
    return np.array([[u[0], top[0]], [u[1], top[1]], [u[1], bottom[1]], [u[0], bottom[0]]])


def _box(camera: _Camera, corners: np.ndarray) -> Optional[Tuple[int, int, int, int]]:
    """Left, top, right and bottom of the bounding box in the image; None if the box is outside."""
    low = np.maximum(np.floor(corners.min(axis=0)), 0).astype(int)
    high = np.minimum(np.ceil(corners.max(axis=0)), (camera.width, camera.height)).astype(int)
    return (*low, *high) if np.all(high > low) else None


def _reduced(texture: Optional[np.ndarray], first: int, last: int, scale: float) -> Optional[np.ndarray]:
    """The visible columns of a texture, reduced by the scale."""
    if texture is None:
        return None
    part = texture[:, first : last + 1]
    size = (max(1, round(part.shape[1] * scale)), max(1, round(part.shape[0] * scale)))
    return cv2.resize(part, size, interpolation=cv2.INTER_AREA) if scale < 1 else part
