#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the marker chain on real and simulated input, and checks the figures of README.md.

Exit status: 0 when every bar holds, 1 when one fails, 2 when something could not be measured.
"""

import sys

from command import run
from real_data import Photos

from markers.chain import chain_tables
from markers.real_photos import photo_tables
from markers.recorded_drives import recording_tables
from markers.simulated_drives import drive_tables

TOPICS = {
    "photos": lambda options: photo_tables(Photos(options.data / "markers/photos")),
    "tagslam": lambda options: recording_tables(options.data / "markers"),
    "simulated": lambda options: drive_tables(options.quick),
    "chain": lambda options: chain_tables(options.quick),
}


if __name__ == "__main__":
    sys.exit(run(TOPICS, __doc__, "markers.error_plot"))
