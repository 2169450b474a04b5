#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the quality of maps from recorded drives, and the results of accuracy_statistics for series.

Exit status: 0 when every bar holds, 1 when one fails, 2 when something could not be measured.
"""

import sys

from command import run

from mapping.many_bags import bag_tables
from mapping.recorded_maps import recorded_map_tables
from mapping.simulated_maps import simulated_tables, taped_tables
from mapping.simulated_series import series_tables

TOPICS = {
    "simulated": lambda options: simulated_tables(options.quick),
    "taped": lambda options: taped_tables(options.quick),
    "real": lambda options: recorded_map_tables(options.data / "markers", options.quick),
    "series": lambda options: series_tables(options.quick),
    "bags": lambda options: bag_tables(options.quick),
}


if __name__ == "__main__":
    sys.exit(run(TOPICS, __doc__, "mapping.map_error_plot"))
