#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures whether poses from markers can be trusted: covariance, ambiguity, moved markers, real recordings;
and what they cost.

Exit status: 0 when every bar holds, 1 when one fails, 2 when something could not be measured.
"""

import sys

from command import run

from markers.chain import chain_tables
from markers.consistency import consistency_tables
from markers.detector_speed import speed_tables
from markers.head_on import head_on_tables
from markers.moved_marker import moved_marker_tables
from markers.recorded_trust import trust_tables

TOPICS = {
    "consistency": lambda options: consistency_tables(options.quick),
    "head_on": lambda options: head_on_tables(options.quick),
    "moved_marker": lambda options: moved_marker_tables(options.quick),
    "real": lambda options: trust_tables(options.data / "markers", options.quick),
    "speed": lambda options: speed_tables(options.quick),
    "chain": lambda options: chain_tables(options.quick),
}


if __name__ == "__main__":
    sys.exit(run(TOPICS, __doc__, "markers.trust_plots"))
