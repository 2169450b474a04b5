# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Colours of landmark classes, as the nodelet shows them in rviz."""

import colorsys
from typing import Tuple

Colour = Tuple[float, float, float]  # red, green, blue, [0, 1]

NAMED = {
    "blue": (0.15, 0.4, 0.95),
    "red": (0.85, 0.15, 0.15),
    "green": (0.15, 0.65, 0.2),
    "yellow": (0.95, 0.85, 0.15),
    "orange": (1.0, 0.55, 0.1),
    "purple": (0.6, 0.25, 0.75),
    "white": (0.95, 0.95, 0.95),
    "black": (0.12, 0.12, 0.12),
}


def colour_of_class(class_name: str) -> Colour:
    """Colour named in the class, or else one derived from a hash of the class."""
    named = (colour for name, colour in NAMED.items() if name in class_name)
    return next(named, None) or _of_hue(_hash(class_name) * 2654435769 % 2**32 / 2**32)


def _of_hue(hue: float) -> Colour:
    red, green, blue = colorsys.hsv_to_rgb(hue, 1.0, 1.0)
    return 0.2 + 0.7 * red, 0.2 + 0.7 * green, 0.2 + 0.7 * blue


def _hash(text: str) -> int:
    """FNV-1a of 32 bits."""
    value = 2166136261
    for byte in text.encode():
        value = (value ^ byte) * 16777619 % 2**32
    return value
