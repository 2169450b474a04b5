# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is measured: detectors and locators with their default parameters."""

import sextant

MODES = ("nearest", "average", "joint")


def detector(family: str, **changed) -> "sextant.MarkerDetector":
    """Of one family; changed: fields of sextant.DetectorParams that are not their default."""
    params = sextant.DetectorParams()
    for name, value in {"families": [family], **changed}.items():
        setattr(params, name, value)
    return sextant.MarkerDetector(params)


def locator(mode: str) -> "sextant.MarkerLocator":
    """Of one mode."""
    params = sextant.LocatorParams()
    params.mode = mode
    return sextant.MarkerLocator(params)
