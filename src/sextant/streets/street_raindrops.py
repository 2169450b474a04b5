# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Raindrops on the lens of a camera: each shows a blurred, upside down image of the scene."""

import cv2
import numpy as np

BLUR = 24  # pixels that are averaged to one of the image in a drop
RADIUS = (0.012, 0.045)  # least and greatest radius, as a fraction of the image width
RIM = 0.25  # width of the soft rim, as a fraction of the radius


def add_raindrops(light: np.ndarray, mean: float, rng: np.random.Generator) -> np.ndarray:
    """The brightness (rows, columns), float32, behind drops at random positions; mean: number of them."""
    rows, columns = light.shape
    cover, width = np.zeros(light.shape, np.uint8), 1
    for _ in range(int(rng.poisson(mean))):
        x, y, radius = rng.uniform(0, columns), rng.uniform(0, rows), columns * rng.uniform(*RADIUS)
        axes = (max(1, round(radius)), max(1, round(radius * rng.uniform(1.0, 1.4))))
        cv2.ellipse(cover, (round(x), round(y)), axes, 0, 0, 360, 255, -1)
        width = max(width, 2 * round(RIM * radius / 2) + 1)
    if not cover.any():
        return light
    small = cv2.resize(light, (-(-columns // BLUR), -(-rows // BLUR)), interpolation=cv2.INTER_AREA)
    seen = cv2.resize(small[::-1, ::-1], (columns, rows), interpolation=cv2.INTER_CUBIC)
    share = cv2.blur(cover, (width, width)) * np.float32(1 / 255)
    return light + share * (seen - light)
