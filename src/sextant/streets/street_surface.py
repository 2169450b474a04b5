# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Surfaces of a simulated street: the texture of an upright object, and the noise of all surfaces.

Brightness is 0 to 255 in diffuse light.
"""

from functools import lru_cache
from typing import NamedTuple, Optional

import cv2
import numpy as np
from scipy import fft

TEXELS = 96  # per metre
SNOW = 225.0  # brightness of snow
TILE = 2048  # side of the texture of rough noise from which all surfaces are cut, texels


class Texture(NamedTuple):
    """Texture of an upright object; its lower edge is on the ground."""

    grey: np.ndarray  # float32 (rows, columns)
    mask: Optional[np.ndarray]  # uint8 (rows, columns), 255: opaque; None: opaque everywhere
    width: float  # metres
    height: float  # metres


def smooth_noise(rng: np.random.Generator, rows: int, columns: int, grain: float) -> np.ndarray:
    """Smooth noise of standard deviation 1, float32 (rows, columns), with spots of `grain` pixels."""
    shape = (int(rows / grain) + 4, int(columns / grain) + 4)
    return cv2.resize(
        rng.normal(size=shape).astype(np.float32), (columns, rows), interpolation=cv2.INTER_CUBIC
    )


def repeating_noise(rng: np.random.Generator, side: int, exponent: float) -> np.ndarray:
    """Periodic noise of standard deviation 1, float32 (side, side).

    :param exponent: amplitudes are proportional to frequency ** -exponent; 0: white; 1: natural images
    """
    spectrum = fft.rfft2(rng.standard_normal((side, side), np.float32))
    frequency = np.hypot(*np.meshgrid(fft.rfftfreq(side), fft.fftfreq(side))).astype(np.float32)
    spectrum *= np.maximum(side * frequency, 1) ** -exponent
    spectrum[0, 0] = 0
    waves = fft.irfft2(spectrum, (side, side))
    return waves / waves.std()


@lru_cache(maxsize=1)
def _tile() -> np.ndarray:
    return repeating_noise(np.random.default_rng(1), TILE, 0.7)


def rough_noise(rng: np.random.Generator, rows: int, columns: int) -> np.ndarray:
    """Noise of all scales, standard deviation 1, float32 (rows, columns): cut from TILE x TILE texels."""
    y, x = rng.integers(TILE - rows + 1), rng.integers(TILE - columns + 1)
    flip = slice(None, None, int(rng.choice([-1, 1])))
    return _tile()[y : y + rows, x : x + columns][flip, ::-1]
