# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The sun in front of a camera: disc and glow in the sky; veil, streaks and ghosts that the lens adds."""

from typing import Tuple

import cv2
import numpy as np

COARSE = 4  # pixels of the image per computed one
DISC = 9000.0  # brightness of the sun's disc
HIDDEN = 0.3  # fraction of directional light up to which clouds hide the disc
RADIUS = 0.012  # of the disc, with the glare around it, as a fraction of the focal length
GLOW, GLOW_WIDTH = 90.0, 0.35  # brightness of the sky around the sun; its width in focal lengths
VEIL, VEIL_WIDTH = 70.0, 1.1  # scattered light
BLOOM, BLOOM_WIDTH = 260.0, 0.09
STREAK, STREAK_WIDTH, STREAK_LENGTH = 120.0, 0.008, 0.7
STREAKS = 3  # lines through the sun
GHOSTS = (  # place on the line from the sun (0) through the centre (1), radius in focal lengths, brightness
    (-0.35, 0.05, 26.0),
    (0.45, 0.09, 20.0),
    (0.8, 0.03, 40.0),
    (1.5, 0.14, 16.0),
    (1.9, 0.06, 30.0),
)


def add_sun(sky: np.ndarray, sun: Tuple[float, float], f: float, direct: float) -> None:
    """Adds glow and disc to the sky (rows, columns), float32, in place.

    :param sun: its pixel, which may be outside
    :param f: focal length, pixels
    :param direct: fraction of directional light
    """
    distance = _distance(sky.shape, sun) / f
    glow = np.float32((GLOW * direct) * np.exp(-distance / GLOW_WIDTH))
    sky += cv2.resize(glow, sky.shape[::-1], interpolation=cv2.INTER_LINEAR)
    if direct > HIDDEN:
        cv2.circle(sky, (round(sun[0]), round(sun[1])), max(1, round(RADIUS * f)), DISC * direct, -1)


def visible_sun(light: np.ndarray, sun: Tuple[float, float], f: float) -> float:
    """Fraction of the disc, drawn by add_sun(), that nothing hides; 1 outside the image."""
    (u, v), (rows, columns) = sun, light.shape
    if not (0 <= u < columns and 0 <= v < rows):
        return 1.0
    radius = max(2.0, RADIUS * f)
    left, top = (max(0, round(each - radius)) for each in sun)
    square = light[top : round(v + radius) + 1, left : round(u + radius) + 1]
    return min(1.0, float(np.mean(square > DISC / 20)) * 4 / np.pi)


def add_flare(light: np.ndarray, sun: Tuple[float, float], f: float, strength: float) -> None:
    """Adds the light that a lens scatters, in place.

    :param sun: pixel of the sun, which may be outside the image
    :param f: focal length, pixels
    :param strength: brightness; 1: a usual lens in full sun
    """
    shape, distance = light.shape, _distance(light.shape, sun) / f
    scattered = VEIL * np.exp(-distance / VEIL_WIDTH) + BLOOM * np.exp(-distance / BLOOM_WIDTH)
    scattered += _streaks(shape, sun, f) * np.exp(-distance / STREAK_LENGTH)
    _ghosts(scattered, shape, sun, f)
    light += cv2.resize(np.float32(strength * scattered), shape[::-1], interpolation=cv2.INTER_LINEAR)


def _offsets(shape: Tuple[int, int], sun: Tuple[float, float]) -> Tuple[np.ndarray, np.ndarray]:
    """Pixels right of and below the sun, of every COARSE-th pixel."""
    y, x = (COARSE * (np.arange(-(-side // COARSE), dtype=np.float32) + 0.5) - 0.5 for side in shape)
    return (x - np.float32(sun[0]))[None], (y - np.float32(sun[1]))[:, None]


def _distance(shape: Tuple[int, int], sun: Tuple[float, float]) -> np.ndarray:
    return np.hypot(*_offsets(shape, sun))


def _streaks(shape: Tuple[int, int], sun: Tuple[float, float], f: float) -> np.ndarray:
    x, y = _offsets(shape, sun)
    lines = np.zeros((y.shape[0], x.shape[1]), np.float32)
    for angle in np.float32(0.3 + np.pi * np.arange(STREAKS) / STREAKS):
        lines += np.exp(-np.abs(x * np.sin(angle) - y * np.cos(angle)) / np.float32(STREAK_WIDTH * f))
    return STREAK * lines


def _ghosts(scattered: np.ndarray, shape: Tuple[int, int], sun: Tuple[float, float], f: float) -> None:
    """Adds discs on the line through the sun and the image centre, in place."""
    centre = np.array([shape[1] - 1, shape[0] - 1]) / 2
    for place, radius, tone in GHOSTS:
        x, y = (sun + place * (centre - sun)) / COARSE
        disc = np.zeros(scattered.shape, np.float32)
        cv2.circle(disc, (round(x), round(y)), max(1, round(radius * f / COARSE)), tone, -1, cv2.LINE_AA)
        scattered += disc
