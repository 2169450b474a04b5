# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a camera sees of a simulated street: textures on planes, the farthest first."""

from typing import NamedTuple, Optional, Tuple

import cv2
import numpy as np

from sextant.simulation.camera import HORIZONTAL_FOV
from sextant.simulation.street import GROUND_SIDE, GROUND_TEXELS, Street, Upright
from sextant.simulation.street_textures import TEXELS

EYE = 1.5  # metres above the ground
NEAR, FAR = 0.5, 70.0  # metres; nothing nearer or farther is seen
HAZE = 120.0  # metres at which what stands is hazed wholly
GROUND_HAZE = 60.0
SKY_TOP, SKY_HORIZON, HAZE_TONE, GROUND_TONE = 235.0, 205.0, 170.0, 150.0
SHARP = 1.5  # texels a pixel, from which on a texture is made smaller first


class _Camera(NamedTuple):
    """Looks along the ground; pixels."""

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
        """Of points (n, 2) on the ground, metres."""
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
    """The picture, uint8 (height, width).

    :param pose: (x, y, yaw) of the camera, see Street.pose()
    :param size: width and height, pixels
    :param seed: of the camera's noise
    """
    width, height = size
    camera = _Camera(*pose, width, height, 0.5 * width / np.tan(horizontal_fov / 2))
    image = _sky_and_ground(street, camera)
    for upright in _far_to_near(street, camera):
        _draw(image, camera, upright, street.conditions.exposure)
    rng = np.random.default_rng([street.seed, street.conditions.look, seed])
    noise = rng.normal(0, street.conditions.noise, image.shape)
    return np.clip(image + noise, 0, 255).astype(np.uint8)


def _sky_and_ground(street: Street, camera: _Camera) -> np.ndarray:
    exposure, (centre_x, centre_y) = street.conditions.exposure, camera.centre
    image = np.empty((camera.height, camera.width), np.float32)
    image[:] = np.linspace(SKY_TOP, SKY_HORIZON, camera.height)[:, None] * min(exposure, 1.05)
    horizon = int(centre_y) + 1
    v, u = np.mgrid[horizon : camera.height, 0 : camera.width].astype(np.float32)
    depth = EYE * camera.f / (v - centre_y)
    right = (u - centre_x) / camera.f * depth
    cosine, sine = np.cos(camera.yaw), np.sin(camera.yaw)
    x, y = camera.x + depth * cosine + right * sine, camera.y + depth * sine - right * cosine
    at = [np.mod(each * GROUND_TEXELS, GROUND_SIDE).astype(np.float32) for each in (x, y)]
    ground = cv2.remap(street.ground, *at, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)
    haze = np.clip(depth / GROUND_HAZE, 0, 1)
    image[horizon:] = ground * (1 - haze) + GROUND_TONE * exposure * haze
    return image


def _far_to_near(street: Street, camera: _Camera):
    seen = []
    for upright in street.uprights:
        depth, _ = camera.depth_and_right(np.array([upright.left, upright.right]))
        if depth.max() > NEAR and depth.min() < FAR:
            seen.append((depth.mean(), upright))
    return [upright for _, upright in sorted(seen, key=lambda each: -each[0])]


def _draw(image: np.ndarray, camera: _Camera, upright: Upright, exposure: float) -> None:
    depth, right = camera.depth_and_right(np.array([upright.left, upright.right]))
    # what is behind the camera is cut off: parts of the texture's width that are before it
    columns = upright.grey.shape[1]
    parts = np.array([0.0, 1.0])
    crossing = (NEAR - depth[0]) / (depth[1] - depth[0]) if depth[0] != depth[1] else 0.0
    parts[depth < NEAR] = crossing
    first, last = int(parts[0] * (columns - 1)), int(np.ceil(parts[1] * (columns - 1)))
    if last - first < 2:
        return
    parts = np.array([first, last]) / (columns - 1)
    depth, right = (each[0] + parts * (each[1] - each[0]) for each in (depth, right))
    corners = _projected(camera, depth, right, upright.height)
    box = _box(camera, corners)
    if box is None:
        return
    scale = min(1.0, SHARP * camera.f / depth.min() / TEXELS)
    grey, mask = (_reduced(each, first, last, scale) for each in (upright.grey, upright.mask))
    if min(grey.shape) < 2:
        return
    left, top, stop_x, stop_y = box
    source = np.float32(
        [[0, 0], [grey.shape[1] - 1, 0], [grey.shape[1] - 1, grey.shape[0] - 1], [0, grey.shape[0] - 1]]
    )
    H = cv2.getPerspectiveTransform(source, np.float32(corners - (left, top)))
    size = (stop_x - left, stop_y - top)
    seen = cv2.warpPerspective(grey, H, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    opaque = cv2.warpPerspective(np.full_like(grey, 255) if mask is None else mask, H, size) / np.float32(255)
    haze = min(1.0, depth.min() / HAZE)
    part = image[top:stop_y, left:stop_x]
    part += opaque * (seen * (1 - haze) + HAZE_TONE * exposure * haze - part)


def _projected(camera: _Camera, depth: np.ndarray, right: np.ndarray, height: float) -> np.ndarray:
    """(4, 2) pixels of the corners: upper left, upper right, lower right, lower left."""
    centre_x, centre_y = camera.centre
    u = centre_x + camera.f * right / depth
    top, bottom = (centre_y + camera.f * (EYE - z) / depth for z in (height, 0.0))
    return np.array([[u[0], top[0]], [u[1], top[1]], [u[1], bottom[1]], [u[0], bottom[0]]])


def _box(camera: _Camera, corners: np.ndarray) -> Optional[Tuple[int, int, int, int]]:
    """Left, top, right and bottom of the pixels that corners enclose; None: none of the picture."""
    low = np.maximum(np.floor(corners.min(axis=0)), 0).astype(int)
    high = np.minimum(np.ceil(corners.max(axis=0)), (camera.width, camera.height)).astype(int)
    return (*low, *high) if np.all(high > low) else None


def _reduced(texture: Optional[np.ndarray], first: int, last: int, scale: float) -> Optional[np.ndarray]:
    """The columns that are seen, without more texels than needed."""
    if texture is None:
        return None
    part = texture[:, first : last + 1]
    size = (max(1, round(part.shape[1] * scale)), max(1, round(part.shape[0] * scale)))
    return cv2.resize(part, size, interpolation=cv2.INTER_AREA) if scale < 1 else part
