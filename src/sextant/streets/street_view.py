# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Renders camera images of a simulated street: textured planes, back to front."""

from typing import Optional, Tuple

import cv2
import numpy as np

from sextant.simulation.uprights import Upright, UprightView, upright_image
from sextant.streets.street import Street
from sextant.streets.street_camera import CAMERAS, StreetCamera, exposed
from sextant.streets.street_conditions import StreetConditions
from sextant.streets.street_flare import add_flare, add_sun, visible_sun
from sextant.streets.street_raindrops import add_raindrops
from sextant.streets.street_sky import SIDE
from sextant.streets.street_sky import TEXELS as SKY_TEXELS

FAR = 70.0  # clipping distance, metres
HAZE = 120.0  # distance at which uprights are fully hazed, metres
GROUND_HAZE, MAX_HAZE = 150.0, 0.6  # the same for the ground, metres; maximum fraction of haze there
HAZE_TONE = 170.0  # brightness
SUN_AHEAD = 0.3  # least cosine of the azimuth of a sun that shines into the lens, from the optical axis
WET_GROUND = 0.4  # how much darker wet ground is
WATER = 0.02  # reflectance of water from above
COARSE_MIRROR = 3  # pixels of the image per one of the mirror image
SLANT = 2.5  # texels per pixel above which the ground is reduced, along the viewing direction


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
    view = UprightView(*pose, width, height, f, horizon, camera.height)
    light = _light(street, view, camera)
    seeds = [street.seed, street.conditions.look, seed]
    light = add_raindrops(light, street.conditions.drops, np.random.default_rng([*seeds, 2]))
    if camera != CAMERAS["ideal"]:
        light = exposed(light, camera, np.random.default_rng([*seeds, 1]))
    noise = np.random.default_rng(seeds).standard_normal(light.shape, np.float32)
    image = light + street.conditions.noise * noise
    return np.clip(image, 0, 255).astype(np.uint8)


def _light(street: Street, view: UprightView, camera: StreetCamera) -> np.ndarray:
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


def _sun(street: Street, view: UprightView) -> Optional[Tuple[float, float]]:
    """Pixel of the sun; None if it is behind the camera or far outside the image."""
    angle = street.conditions.sun - view.yaw
    if np.cos(angle) < SUN_AHEAD:
        return None
    centre_x, centre_y = view.centre
    tangent = street.conditions.sun_height / np.cos(angle)
    return centre_x - view.f * np.tan(angle), centre_y - view.f * tangent


def _sky(street: Street, view: UprightView) -> np.ndarray:
    """Brightness, float32, of the rows above the horizon."""
    centre_x, centre_y = view.centre
    u, v = np.arange(view.width), np.arange(int(centre_y) + 1)
    aside = np.arctan((u - centre_x) / view.f)
    column = np.mod((view.yaw - aside) * SKY_TEXELS, SIDE)
    tangent = np.outer((centre_y - v) / view.f, np.cos(aside))
    row = np.maximum(len(street.sky) - 1 - tangent * SKY_TEXELS, 0)
    at = np.tile(np.float32(column), (len(v), 1)), np.float32(row)
    return cv2.remap(street.sky, *at, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP).astype(np.float32)


def _ground(street: Street, view: UprightView) -> np.ndarray:
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


def _in_mirror(view: UprightView) -> UprightView:
    """The view of a mirror in the ground, smaller; upside down."""
    scale = 1 / COARSE_MIRROR
    width, height = (-(-side // COARSE_MIRROR) for side in (view.width, view.height))
    horizon = (view.horizon + 0.5) * scale - 0.5
    return view._replace(width=width, height=height, f=view.f * scale, horizon=horizon, eye=-view.eye)


def _mirrored(street: Street, view: UprightView) -> np.ndarray:
    """Brightness, float32, of what a mirror in the ground shows in the rows below the horizon."""
    mirror, conditions = _in_mirror(view), street.conditions
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


def _far_to_near(street: Street, view: UprightView):
    """Uprights within the clipping distances, the farthest first."""
    visible = []
    for upright in street.uprights:
        depth, _ = view.depth_and_right(np.array([upright.left, upright.right]))
        if depth.max() > view.near and depth.min() < FAR:
            visible.append((depth.mean(), upright))
    return [upright for _, upright in sorted(visible, key=lambda each: -each[0])]


def _draw(image: np.ndarray, view: UprightView, upright: Upright, conditions: StreetConditions) -> None:
    """Draws an upright in place."""
    seen = upright_image(upright, view)
    if seen is None:
        return
    left, top, stop_x, stop_y = seen.box
    haze = min(1.0, seen.nearest * conditions.haze / HAZE)
    part = image[top:stop_y, left:stop_x]
    part += seen.opaque * (seen.grey * (1 - haze) + HAZE_TONE * conditions.exposure * haze - part)
