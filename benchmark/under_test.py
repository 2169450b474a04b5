# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The objects under test: detectors and locators with default parameters, and maps for them."""

from typing import Iterable

import sextant

MODES = ("nearest", "average", "joint")


def detector(family: str, **changed) -> "sextant.MarkerDetector":
    """Returns a detector of one family; changed: fields of sextant.DetectorParams with other values."""
    params = sextant.DetectorParams()
    for name, value in {"families": [family], **changed}.items():
        setattr(params, name, value)
    return sextant.MarkerDetector(params)


def locator(mode: str) -> "sextant.MarkerLocator":
    """Returns a locator in one mode of MODES."""
    params = sextant.LocatorParams()
    params.mode = mode
    return sextant.MarkerLocator(params)


def map_of(markers: Iterable["sextant.MappedMarker"]) -> "sextant.MarkerMap":
    """Returns a map of these markers in the frame `map`."""
    result = sextant.MarkerMap()
    for marker in markers:
        result.add(marker)
    return result
