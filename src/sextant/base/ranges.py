# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks that all parameters of a component are in their ranges."""

from typing import Tuple


def check_ranges(params: object, **ranges: Tuple[float, float]) -> None:
    """:raises ValueError: names the first field out of its (low, high), its value and what is allowed."""
    for name, (low, high) in ranges.items():
        value = getattr(params, name)
        if not low <= value <= high:
            raise ValueError(f"{name} is {value}, allowed is [{low}, {high}]")
