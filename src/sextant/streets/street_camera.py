# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Cameras of a simulated street: field of view, mount, exposure, tone curve and vignetting."""

from dataclasses import dataclass

import cv2
import numpy as np

from sextant.base.strict_params import StrictParams, param, within
from sextant.simulation.camera import HORIZONTAL_FOV
from sextant.simulation.camera_effects import fall_off

WHITE = 255.0  # brightness that saturates the image
METERED = 110.0  # mean brightness that metering aims at


@dataclass(frozen=True)
class StreetCamera(StrictParams):
    """Camera with a horizontal optical axis; the defaults are those of an ideal one."""

    horizontal_fov: float = param(HORIZONTAL_FOV, "horizontal field of view", within(0.1, 2.8), "rad")
    height: float = param(1.5, "height above the ground", within(0.2, 3.0), "m")
    horizon: float = param(0.0, "row of the horizon below the middle / image height", within(-0.4, 0.4))
    exposure: float = param(1.0, "gain", within(0.05, 20.0))
    exposure_error: float = param(0.0, "standard deviation of an image's exposure", within(0, 3), "stops")
    metering: float = param(0.0, "how much the mean brightness is compensated for", within(0, 1))
    gamma: float = param(1.0, "exponent of the tone curve; above 1: harder shadows", within(0.2, 5.0))
    vignetting: float = param(0.0, "loss of light in the corners", within(0, 1))
    red: float = param(0.0, "loss of light from the blue sky by a sensor for red light", within(0, 1))
    flare: float = param(0.0, "light that the lens scatters, relative to a usual lens", within(0, 5))

    def focal_length(self, width: int) -> float:
        """Pixels."""
        return 0.5 * width / np.tan(self.horizontal_fov / 2)


CAMERAS = {
    "ideal": StreetCamera(),
    "phone": StreetCamera(1.3, 1.7, -0.04, 1.1, 0.55, 0.6, 1.25, 0.4, 0.2, 1.0),
}


def exposed(light: np.ndarray, camera: StreetCamera, rng: np.random.Generator) -> np.ndarray:
    """Image, float32 in [0, WHITE], of the brightness (rows, columns) at the lens.

    :param rng: of the exposure's error
    """
    gain = camera.exposure * 2 ** (camera.exposure_error * rng.standard_normal())
    gain *= (METERED / max(float(light.mean()), 1.0)) ** camera.metering
    collected = light * (np.float32(gain) * fall_off(light.shape, camera.vignetting))
    return tone_curve(collected, camera.gamma)


def tone_curve(collected: np.ndarray, gamma: float) -> np.ndarray:
    """Grey levels, float32, of collected light: saturated at WHITE, which every curve keeps."""
    fraction = np.clip(collected, 0, WHITE) * np.float32(1 / WHITE)
    return np.float32(WHITE) * cv2.pow(fraction, gamma)
