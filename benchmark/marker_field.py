#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures markers in the field: poor light, motion blur, the image border, a moving camera, crowds, images
without markers, wrong calibrations and maps, maps from large drives; and what the chain costs.

Exit status: 0 when every bar holds, 1 when one fails, 2 when something could not be measured.
"""

import sys

from command import run
from field.blur import blur_tables
from field.border import border_tables
from field.causes import causes_tables
from field.crowd import crowd_tables
from field.dark import dark_tables
from field.false_positives import false_positive_tables
from field.large_map import large_map_tables
from field.tracking import tracking_tables
from field.wrong_maps import wrong_map_tables

from markers.chain import chain_tables

TOPICS = {
    "dark": lambda options: dark_tables(options.data, options.quick),
    "blur": lambda options: blur_tables(options.data, options.quick),
    "border": lambda options: border_tables(options.data, options.quick),
    "tracking": lambda options: tracking_tables(options.data, options.quick),
    "crowd": lambda options: crowd_tables(options.data, options.quick),
    "false_positives": lambda options: false_positive_tables(options.data / "places", options.quick),
    "causes": lambda options: causes_tables(options.quick),
    "wrong_maps": lambda options: wrong_map_tables(options.data / "markers", options.quick),
    "large_map": lambda options: large_map_tables(options.quick),
    "chain": lambda options: chain_tables(options.quick),
}


if __name__ == "__main__":
    sys.exit(run(TOPICS, __doc__))
