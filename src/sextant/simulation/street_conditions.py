# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Season, light and day of a simulated street."""

from dataclasses import dataclass

from sextant.base.strict_params import StrictParams, one_of, param, within

SEASONS = ("summer", "autumn", "winter")


@dataclass(frozen=True)
class StreetConditions(StrictParams):
    """Conditions that change between two walks along the same street."""

    season: str = param("summer", "season or light", one_of(*SEASONS))
    look: int = 0  # random seed of blinds, posters, leaves and cars
    sun: float = 0.6  # azimuth of the sun, radians from x
    direct: float = param(0.35, "fraction of directional light", within(0, 1))
    exposure: float = param(1.0, "relative brightness", within(1e-3, 4))
    noise: float = param(3.0, "standard deviation of the image noise", within(0, 50), "grey levels")


CONDITIONS = {
    "summer": StreetConditions(),
    "evening": StreetConditions("summer", 1, 2.4, 0.55, 0.7),
    "autumn": StreetConditions("autumn", 2, 1.2, 0.3, 0.9),
    "winter": StreetConditions("winter", 3, -0.6, 0.1, 1.05),
    "dusk": StreetConditions("winter", 4, 2.9, 0.6, 0.35, 6.0),
}
