# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What real cameras do to an image: wrong colours and exposure, dirt on the lens, motion blur, sharpening
and JPEG compression."""

from functools import lru_cache
from typing import NamedTuple, Tuple

import cv2
import numpy as np

DIRT_LIGHT = np.array([0.6, 0.58, 0.55], np.float32)  # colour of dust on the lens, fraction of white
PURE_JPEG = 100  # quality at which an image is not compressed


class CameraEffects(NamedTuple):
    """Effects of one camera on one image; the defaults change nothing."""

    gains: np.ndarray = np.ones(3)  # of red, green and blue: white balance and exposure
    saturation: float = 1.0  # distance of colours from grey
    gamma: float = 1.0  # of the tone curve
    vignetting: float = 0.0  # fraction of the light lost in the corners
    haze: float = 0.0  # fraction of white that stray light adds
    blots: np.ndarray = np.zeros((0, 4))  # dirt on the lens: x, y and radius in image widths, opacity
    defocus: float = 0.0  # standard deviation of the lens blur, pixels
    blur: Tuple[float, float] = (0.0, 0.0)  # motion of the image during its exposure, x and y, pixels
    noise: float = 0.0  # standard deviation of the sensor noise, levels
    sharpening: float = 0.0  # of edges, as by the camera's processor
    quality: int = PURE_JPEG  # of the JPEG compression


def random_effects(random: np.random.Generator) -> CameraEffects:
    """Effects of a random camera with images of 4:3, many weak and few strong, without blur and noise."""
    warmth, green = random.normal(0.0, 0.12), random.normal(0.0, 0.05)
    exposure = np.exp(random.normal(0.0, 0.25))
    number = random.poisson(1.5)
    blots = np.column_stack(
        [
            random.uniform(0.0, 1.0, number),
            random.uniform(0.0, 0.75, number),
            random.uniform(0.02, 0.15, number),
            random.uniform(0.05, 0.4, number),
        ]
    )
    return CameraEffects(
        gains=exposure * np.exp([warmth, green, -warmth]),
        saturation=float(np.clip(random.normal(1.0, 0.2), 0.6, 1.5)),
        gamma=float(np.exp(random.normal(0.0, 0.15))),
        vignetting=float(random.beta(1.0, 3.0)),
        haze=float(0.15 * random.beta(1.0, 4.0)),
        blots=blots,
        sharpening=float(random.choice([0.0, random.uniform(0.0, 1.5)])),
        quality=int(random.integers(25, PURE_JPEG)),
    )


def with_effects(image: np.ndarray, effects: CameraEffects, random: np.random.Generator) -> np.ndarray:
    """An image after these effects, all on display levels.

    :param image: uint8 (height, width, 3), RGB
    :param random: of the noise
    """
    light = image.astype(np.float32) / 255.0
    if effects.defocus:
        light = cv2.GaussianBlur(light, (0, 0), effects.defocus)
    light = _moved(light, effects.blur) * effects.gains.astype(np.float32)
    light = _behind_dirt(
        light * fall_off(image.shape[:2], effects.vignetting)[..., np.newaxis], effects.blots
    )
    light += np.float32(effects.haze)
    if effects.noise:
        light += np.float32(effects.noise / 255.0) * random.standard_normal(light.shape, np.float32)
    grey = light.mean(axis=2, keepdims=True)
    coloured = grey + np.float32(effects.saturation) * (light - grey)
    curve = np.rint(255.0 * (np.arange(256) / 255.0) ** effects.gamma).astype(np.uint8)
    levels = cv2.LUT(np.clip(255.0 * coloured + 0.5, 0.0, 255.0).astype(np.uint8), curve)
    if effects.sharpening:
        blurred = cv2.GaussianBlur(levels, (0, 0), 1.5)
        levels = cv2.addWeighted(levels, 1.0 + effects.sharpening, blurred, -effects.sharpening, 0.0)
    return levels if effects.quality == PURE_JPEG else _compressed(levels, effects.quality)


@lru_cache(maxsize=4)
def fall_off(shape: Tuple[int, int], vignetting: float) -> np.ndarray:
    """Fraction of the light that arrives, float32 (rows, columns): falls with the squared radius.

    :param vignetting: fraction that is lost in the corners
    """
    y, x = (np.linspace(-1, 1, side, dtype=np.float32) for side in shape)
    aspect = np.float32([shape[0], shape[1]]) / np.float32(np.hypot(*shape))
    return 1 - np.float32(vignetting) * ((y[:, None] * aspect[0]) ** 2 + (x * aspect[1]) ** 2)


def _moved(light: np.ndarray, blur: Tuple[float, float]) -> np.ndarray:
    """Averages over a motion of the image (pixels)."""
    length = float(np.hypot(*blur))
    if length < 1.0:
        return light
    half = int(np.ceil(0.5 * length)) + 1
    kernel = np.zeros((2 * half + 1, 2 * half + 1), np.float32)
    for part in np.linspace(-0.5, 0.5, 4 * half + 1):
        x, y = half + part * blur[0], half + part * blur[1]
        kernel[int(round(y)), int(round(x))] += 1.0
    return cv2.filter2D(light, -1, kernel / kernel.sum(), borderType=cv2.BORDER_REPLICATE)


def _behind_dirt(light: np.ndarray, blots: np.ndarray) -> np.ndarray:
    """Covers light with blurred blots, which are out of focus."""
    height, width = light.shape[:2]
    y, x = np.mgrid[:height, :width].astype(np.float32) / np.float32(width)
    for left, top, radius, opacity in blots.astype(np.float32):
        squared = ((x - left) ** 2 + (y - top) ** 2) / radius**2
        cover = (opacity * np.exp(-(squared**2)))[..., np.newaxis]
        light = light + cover * (DIRT_LIGHT * light.mean() - light)
    return light


def _compressed(levels: np.ndarray, quality: int) -> np.ndarray:
    written = cv2.imencode(".jpg", levels[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    return np.ascontiguousarray(cv2.imdecode(written, cv2.IMREAD_COLOR)[..., ::-1])
