# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Season, light and day of a simulated street."""

from dataclasses import dataclass, replace
from typing import Tuple

import numpy as np

from sextant.base.strict_params import StrictParams, one_of, param, within

SEASONS = ("summer", "autumn", "bare", "winter", "snow")  # bare: no leaves, no snow; snow: much more of it


@dataclass(frozen=True)
class StreetConditions(StrictParams):
    """Conditions that change between two walks along the same street."""

    season: str = param("summer", "season or light", one_of(*SEASONS))
    look: int = 0  # random seed of blinds, posters, leaves, cars and people
    sun: float = 0.6  # azimuth of the sun, radians from x
    direct: float = param(0.35, "fraction of directional light", within(0, 1))
    exposure: float = param(1.0, "relative brightness", within(1e-3, 4))
    noise: float = param(3.0, "standard deviation of the image noise", within(0, 50), "grey levels")
    sun_height: float = param(0.7, "tangent of the sun's elevation", within(0.05, 10))
    cast: bool = False  # shadows have outlines and fall on everything; False: rough ones, random on walls
    wet: float = param(0.0, "how much wet ground reflects", within(0, 1))
    parked: float = param(0.0, "further parked cars and vans per 10 m of the street", within(0, 2))
    haze: float = param(1.0, "density of the haze", within(0, 20))
    drops: float = param(0.0, "raindrops on the lens", within(0, 200))
    people: float = param(0.0, "pedestrians per 10 m of the street", within(0, 20))


LATITUDE = np.deg2rad(50.0)  # of the street, whose y axis points north
DECEMBER = np.deg2rad(-23.4)  # declination of the sun on the shortest day


def sun_at(hour: float, declination: float = DECEMBER) -> Tuple[float, float]:
    """Azimuth of the sun (radians from x, which is east) and tangent of its elevation.

    Spherical astronomy: sin(elevation) = sin(latitude) sin(declination) + cos cos cos(hour angle).

    :param hour: true solar time, 12: the sun is in the south
    :param declination: radians
    """
    angle = np.deg2rad(15.0 * (hour - 12.0))
    east = -np.cos(declination) * np.sin(angle)
    north = np.cos(LATITUDE) * np.sin(declination) - np.sin(LATITUDE) * np.cos(declination) * np.cos(angle)
    up = np.sin(LATITUDE) * np.sin(declination) + np.cos(LATITUDE) * np.cos(declination) * np.cos(angle)
    return float(np.arctan2(north, east)), float(up / np.hypot(east, north))


def at_hour(conditions: StreetConditions, hour: float) -> StreetConditions:
    """The conditions at another hour of a day in December.

    :raises ValueError: the sun is too low
    """
    azimuth, height = sun_at(hour)
    return replace(conditions, sun=azimuth, sun_height=height)


CONDITIONS = {
    "summer": StreetConditions(),
    "evening": StreetConditions("summer", 1, 2.4, 0.55, 0.7),
    "autumn": StreetConditions("autumn", 2, 1.2, 0.3, 0.9),
    "winter": StreetConditions("winter", 3, -0.6, 0.1, 1.05),
    "dusk": StreetConditions("winter", 4, 2.9, 0.6, 0.35, 6.0),
    "low_sun": at_hour(
        StreetConditions("bare", 5, direct=0.9, noise=4.0, cast=True, parked=0.5, haze=2.0, people=1.0),
        14.0,
    ),
    "wet": at_hour(
        StreetConditions(
            "bare",
            6,
            direct=0.15,
            exposure=0.7,
            noise=6.0,
            cast=True,
            wet=0.9,
            parked=0.5,
            haze=3.0,
            drops=20.0,
            people=1.0,
        ),
        13.0,
    ),
    "snow": at_hour(
        StreetConditions(
            "snow", 7, direct=0.6, exposure=1.1, noise=4.0, cast=True, parked=0.4, haze=3.0, people=0.7
        ),
        10.0,
    ),
}
