# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Renders camera images of a simulated street: textured planes, back to front."""

from typing import NamedTuple, Optional, Tuple

import cv2
import numpy as np

from sextant.streets.street import COARSER, Street, Upright
from sextant.streets.street_camera import CAMERAS, StreetCamera, exposed
from sextant.streets.street_conditions import StreetConditions
from sextant.streets.street_flare import add_flare, add_sun, visible_sun
from sextant.streets.street_raindrops import add_raindrops
from sextant.streets.street_sky import SIDE
from sextant.streets.street_sky import TEXELS as SKY_TEXELS

NEAR, FAR = 0.5, 70.0  # clipping distances, metres
HAZE = 120.0  # distance at which uprights are fully hazed, metres
GROUND_HAZE, MAX_HAZE = 150.0, 0.6  # the same for the ground, metres; maximum fraction of haze there
HAZE_TONE = 170.0  # brightness
SHARP = 1.5  # texels per pixel above which a texture is reduced
SUN_AHEAD = 0.3  # least cosine of the azimuth of a sun that shines into the lens, from the optical axis
WET_GROUND = 0.4  # how much darker wet ground is
WATER = 0.02  # reflectance of water from above
COARSE_MIRROR = 3  # pixels of the image per one of the mirror image
SLANT = 2.5  # texels per pixel above which the ground is reduced, along the viewing direction


class _View(NamedTuple):
    """Camera with a horizontal optical axis; x, y and eye in metres, the rest in pixels."""

    x: float
    y: float
    yaw: float
    width: int
    height: int
    f: float
    horizon: float  # row
    eye: float  # height above the ground; negative: the mirror image below it

    @property
    def centre(self) -> Tuple[float, float]:
        """Pixel of the optical axis."""
        return (self.width - 1) / 2, self.horizon

    def depth_and_right(self, points: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Depth and lateral offset of points (n, 2) on the ground, metres."""
        offset = points - (self.x, self.y)
        cosine, sine = np.cos(self.yaw), np.sin(self.yaw)
        return offset @ (cosine, sine), offset @ (sine, -cosine)

    def mirrored(self) -> "_View":
        """The view of a mirror in the ground, smaller; upside down."""
        scale = 1 / COARSE_MIRROR
        width, height = (-(-side // COARSE_MIRROR) for side in (self.width, self.height))
        horizon = (self.horizon + 0.5) * scale - 0.5
        return self._replace(width=width, height=height, f=self.f * scale, horizon=horizon, eye=-self.eye)


def street_view(
    street: Street,
    pose: np.ndarray,
    size: Tuple[int, int] = (640, 480),
    seed: int = 0,
    camera: StreetCamera = CAMERAS["ideal"],
) -> np.ndarray:
    """Renders an image, uint8 (height, width).

    :param pose: (x, y, yaw) of the camera, see Street.pose()
    :param size: width and height, pixels
    :param seed: random seed of the image noise, and of the exposure's error
    """
    width, height = size
    f, horizon = camera.focal_length(width), (height - 1) / 2 + camera.horizon * height
    view = _View(*pose, width, height, f, horizon, camera.height)
    light = _light(street, view, camera)
    seeds = [street.seed, street.conditions.look, seed]
    light = add_raindrops(light, street.conditions.drops, np.random.default_rng([*seeds, 2]))
    if camera != CAMERAS["ideal"]:
        light = exposed(light, camera, np.random.default_rng([*seeds, 1]))
    noise = np.random.default_rng(seeds).standard_normal(light.shape, np.float32)
    image = light + street.conditions.noise * noise
    return np.clip(image, 0, 255).astype(np.uint8)


def _light(street: Street, view: _View, camera: StreetCamera) -> np.ndarray:
    """Brightness, float32 (height, width), behind the lens."""
    conditions, sun = street.conditions, _sun(street, view)
    shines = conditions.cast and sun is not None
    sky = _sky(street, view) * min(conditions.exposure, 1.05) * (1 - camera.red)
    if shines:
        add_sun(sky, sun, view.f, conditions.direct)
    light = np.concatenate([sky, _ground(street, view)]).astype(np.float32)
    for upright in _far_to_near(street, view):
        _draw(light, view, upright, conditions)
    if shines and camera.flare:
        strength = camera.flare * conditions.direct * visible_sun(light, sun, view.f)
        add_flare(light, sun, view.f, strength)
    return light


def _sun(street: Street, view: _View) -> Optional[Tuple[float, float]]:
    """Pixel of the sun; None if it is behind the camera or far outside the image."""
    angle = street.conditions.sun - view.yaw
    if np.cos(angle) < SUN_AHEAD:
        return None
    centre_x, centre_y = view.centre
    tangent = street.conditions.sun_height / np.cos(angle)
    return centre_x - view.f * np.tan(angle), centre_y - view.f * tangent


def _sky(street: Street, view: _View) -> np.ndarray:
    """Brightness, float32, of the rows above the horizon."""
    centre_x, centre_y = view.centre
    u, v = np.arange(view.width), np.arange(int(centre_y) + 1)
    aside = np.arctan((u - centre_x) / view.f)
    column = np.mod((view.yaw - aside) * SKY_TEXELS, SIDE)
    tangent = np.outer((centre_y - v) / view.f, np.cos(aside))
    row = np.maximum(len(street.sky) - 1 - tangent * SKY_TEXELS, 0)
    at = np.tile(np.float32(column), (len(v), 1)), np.float32(row)
    return cv2.remap(street.sky, *at, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP).astype(np.float32)


def _ground(street: Street, view: _View) -> np.ndarray:
    """Brightness, float32, of the rows below the horizon."""
    centre_x, centre_y = view.centre
    u, v = np.arange(view.width), np.arange(int(centre_y) + 1, view.height)
    depth = (view.eye * view.f / (v - centre_y)).astype(np.float32)
    right = np.outer(depth, np.float32(u - centre_x) / np.float32(view.f))
    cosine, sine = np.float32(np.cos(view.yaw)), np.float32(np.sin(view.yaw))
    x = view.x + cosine * depth[:, None] + sine * right
    y = view.y + sine * depth[:, None] - cosine * right
    ground = street.ground.seen(x, y, depth / view.f * np.maximum(depth / view.eye / SLANT, 1))
    conditions = street.conditions
    haze = np.float32(np.minimum(depth * conditions.haze / GROUND_HAZE, MAX_HAZE))[:, None]
    bare = (ground * (1 - haze) + HAZE_TONE * haze) * conditions.exposure
    if street.ground.puddles is None:
        return bare
    share = street.ground.wetness(x, y) * _reflectance(view.eye, depth)[:, None]
    return bare * (1 - WET_GROUND * conditions.wet) * (1 - share) + _mirrored(street, view) * share


def _reflectance(eye: float, depth: np.ndarray) -> np.ndarray:
    """Reflectance of water at a depth: Schlick's approximation, of the angle to the vertical."""
    cosine = eye / np.hypot(eye, depth)
    return WATER + (1 - WATER) * (1 - cosine) ** 5


def _mirrored(street: Street, view: _View) -> np.ndarray:
    """Brightness, float32, of what a mirror in the ground shows in the rows below the horizon."""
    mirror, conditions = view.mirrored(), street.conditions
    above = _sky(street, mirror) * min(conditions.exposure, 1.05)
    light = np.zeros((mirror.height, mirror.width), np.float32)
    light[: len(above)] = above[: mirror.height]
    for upright in _far_to_near(street, mirror):
        _draw(light, mirror, upright, conditions)
    rows = np.arange(int(view.centre[1]) + 1, view.height)
    v = (2 * view.horizon - rows + 0.5) / COARSE_MIRROR - 0.5
    u = (np.arange(view.width) + 0.5) / COARSE_MIRROR - 0.5
    at = np.tile(np.float32(u), (len(rows), 1)), np.tile(np.float32(v)[:, None], (1, view.width))
    return cv2.remap(light, *at, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)


def _far_to_near(street: Street, view: _View):
    """Uprights within the clipping distances, the farthest first."""
    visible = []
    for upright in street.uprights:
        depth, _ = view.depth_and_right(np.array([upright.left, upright.right]))
        if depth.max() > NEAR and depth.min() < FAR:
            visible.append((depth.mean(), upright))
    return [upright for _, upright in sorted(visible, key=lambda each: -each[0])]


def _draw(image: np.ndarray, view: _View, upright: Upright, conditions: StreetConditions) -> None:
    """Draws an upright in place."""
    depth, right = view.depth_and_right(np.array([upright.left, upright.right]))
    parts = _visible(depth, right, (view.width / 2 + 1) / view.f)
    nearest = (depth[0] + np.array(parts) * (depth[1] - depth[0])).min()
    upright, scale = _sharp_enough(upright, view.f / max(nearest, NEAR))
    columns = upright.grey.shape[1]
    first, last = int(parts[0] * (columns - 1)), int(np.ceil(parts[1] * (columns - 1)))
    if last - first < 2:
        return
    parts = np.array([first, last]) / (columns - 1)
    depth, right = (each[0] + parts * (each[1] - each[0]) for each in (depth, right))
    corners = _projected(view, depth, right, upright.height)
    box = _box(view, corners)
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
    haze = min(1.0, depth.min() * conditions.haze / HAZE)
    part = image[top:stop_y, left:stop_x]
    part += opaque * (warped * (1 - haze) + HAZE_TONE * conditions.exposure * haze - part)


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


def _projected(view: _View, depth: np.ndarray, right: np.ndarray, height: float) -> np.ndarray:
    """Pixels (4, 2) of the corners: upper left, upper right, lower right, lower left."""
    centre_x, centre_y = view.centre
    u = centre_x + view.f * right / depth
    top, bottom = (centre_y + view.f * (view.eye - z) / depth for z in (height, 0.0))
    return np.array([[u[0], top[0]], [u[1], top[1]], [u[1], bottom[1]], [u[0], bottom[0]]])


def _box(view: _View, corners: np.ndarray) -> Optional[Tuple[int, int, int, int]]:
    """Left, top, right and bottom of the bounding box in the image; None if the box is outside."""
    low = np.maximum(np.floor(corners.min(axis=0)), 0).astype(int)
    high = np.minimum(np.ceil(corners.max(axis=0)), (view.width, view.height)).astype(int)
    return (*low, *high) if np.all(high > low) else None


def _reduced(texture: Optional[np.ndarray], first: int, last: int, scale: float) -> Optional[np.ndarray]:
    """The visible columns of a texture, reduced by the scale."""
    if texture is None:
        return None
    part = texture[:, first : last + 1]
    size = (max(1, round(part.shape[1] * scale)), max(1, round(part.shape[0] * scale)))
    return cv2.resize(part, size, interpolation=cv2.INTER_AREA) if scale < 1 else part
