#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures how good maps are that are made of recorded drives, and what accuracy_statistics says of series.

Exit status: 0 when every bar holds, 1 when one fails, 2 when something could not be measured.
"""

import sys

from command import Results, run

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


def plot(folder: str, results: Results) -> None:
    """How often an error of the simulated maps is exceeded."""
    from mapping.map_error_plot import plot_map_errors  # only now: matplotlib takes a second to load

    plot_map_errors(folder, results)


if __name__ == "__main__":
    sys.exit(run(TOPICS, __doc__, plot, sys.argv[1:]))
