# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Background of a simulated street: clouds, and trees and hills at the horizon.

A cylindrical panorama at infinity; rows are linear in the tangent of the elevation.
"""

import cv2
import numpy as np

from sextant.streets.street_surface import repeating_noise, rough_noise

SIDE = 8192  # texels in 360 degrees
TOP = 0.6  # tangent of the elevation at the upper edge
TOP_TONE, HORIZON_TONE = 235.0, 205.0  # brightness
CLOUDS = {"summer": 9.0, "autumn": 12.0, "bare": 14.0, "winter": 5.0, "snow": 8.0}  # deviation of brightness
TREES = {  # brightness, standard deviation
    "summer": (118.0, 11.0),
    "autumn": (135.0, 13.0),
    "bare": (128.0, 14.0),
    "winter": (165.0, 14.0),
    "snow": (195.0, 14.0),
}
LEAFLESS = ("bare", "winter", "snow")
TEXELS = SIDE / (2 * np.pi)  # per radian of azimuth, and per unit of the tangent of the elevation


def panorama(seed: int, season: str, look: int, haze: float = 1.0) -> np.ndarray:
    """Panorama, uint8 (rows, SIDE): azimuth by column, the horizon is the last row.

    :param look: random seed of the clouds; the seed determines the rest
    :param haze: density; above 1: hills and trees fade
    """
    rng, look_rng = np.random.default_rng([seed, 7]), np.random.default_rng([seed, 8, look])
    rows = int(TOP * TEXELS)
    coarse = repeating_noise(look_rng, SIDE // 8, 1.6)[: rows // 4]
    clouds = cv2.resize(np.ascontiguousarray(coarse), (SIDE, rows), interpolation=cv2.INTER_CUBIC)
    sky = np.linspace(TOP_TONE, HORIZON_TONE, rows, dtype=np.float32)[:, None] + CLOUDS[season] * clouds
    elevation = np.linspace(TOP, 0, rows, dtype=np.float32)[:, None]
    hills = elevation < 0.035 + 0.012 * _ridge(rng, 1.8)
    sky[hills] = 178.0
    tone, deviation = TREES[season]
    crowns = tone + deviation * np.hstack([rough_noise(rng, rows, SIDE // 4) for _ in range(4)])
    trees = elevation < 0.02 + 0.007 * _ridge(rng, 0.9)
    if season in LEAFLESS:  # the sky is visible between bare branches
        trees &= crowns < tone + deviation
    sky[trees] = crowns[trees]
    if haze > 1:
        sky[hills | trees] += (1 - 1 / haze) * (HORIZON_TONE - sky[hills | trees])
    return np.clip(sky, 0, 255).astype(np.uint8)


def _ridge(rng: np.random.Generator, smoothness: float) -> np.ndarray:
    """Periodic random heights (SIDE,) with standard deviation 1."""
    spectrum = np.fft.rfft(rng.normal(size=SIDE))
    spectrum /= np.maximum(np.arange(len(spectrum)), 4) ** smoothness
    spectrum[0] = 0
    heights = np.fft.irfft(spectrum, SIDE)
    return (heights / heights.std()).astype(np.float32)
