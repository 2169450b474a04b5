#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the recognition of places: time and memory, and how they grow with the map.

Exit status: 0 when every bar holds, 1 when one fails, 2 when something could not be measured.
"""

import sys

from command import Results, run
from place_size import size_tables
from place_speed import speed_tables

TOPICS = {
    "speed": lambda options: speed_tables(options.quick),
    "size": lambda options: size_tables(options.quick),
}


def plot(folder: str, results: Results) -> None:
    """Nothing yet: time and memory are read best as figures."""


if __name__ == "__main__":
    sys.exit(run(TOPICS, __doc__, plot, sys.argv[1:]))
