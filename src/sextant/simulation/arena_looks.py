# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Random colours and light of an arena."""

from typing import Dict, Tuple

import numpy as np

import sextant
from sextant.objects.object_kinds import BALL

COLOURS: Dict[str, Tuple[float, float, float]] = {  # reflectance of red, green and blue
    BALL: (0.85, 0.62, 0.04),
    "blue_pillar": (0.04, 0.12, 0.55),
    "green_pillar": (0.05, 0.40, 0.10),
    "red_pillar": (0.62, 0.05, 0.05),
}
COLOUR_CHANGE = 0.15  # maximum relative deviation of an object's reflectance from that of its class


def random_paint(class_name: str, random: np.random.Generator) -> np.ndarray:
    """Random reflectance (3,) of red, green and blue for an object of a class."""
    change = random.uniform(1.0 - COLOUR_CHANGE, 1.0 + COLOUR_CHANGE, 3)
    return np.clip(np.array(COLOURS[class_name]) * change, 0.0, 1.0)


def random_light(random: np.random.Generator) -> "sextant.ArenaLight":
    """Random light: dim to bright, with the colour of lamps to that of daylight."""
    light = sextant.ArenaLight()
    light.brightness = float(np.exp(random.uniform(np.log(0.45), np.log(1.4))))
    light.direct = float(random.uniform(0.2, 0.65))
    azimuth, height = random.uniform(-np.pi, np.pi), random.uniform(0.4, 1.4)
    light.toward = np.array([np.cos(azimuth), np.sin(azimuth), height])
    warmth = random.uniform(-0.12, 0.12)
    light.tint = np.array([1.0 + warmth, 1.0, 1.0 - warmth])
    return light
