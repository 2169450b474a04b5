#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures place recognition: recall, calibration, metric poses, time and memory.

Exit status: 0 when every bar holds, 1 when one fails, 2 when something could not be measured.
"""

import sys

from command import run

from places.metric_pose import metric_pose_tables
from places.place_budget import budget_tables
from places.place_calibration import calibration_tables
from places.place_recall import recall_tables
from places.place_seasons import season_tables
from places.place_size import size_tables
from places.place_speed import speed_tables

TOPICS = {
    "recall": lambda options: recall_tables(options.data / "places", options.quick),
    "calibration": lambda options: calibration_tables(options.data / "places", options.quick),
    "seasons": lambda options: season_tables(options.quick),
    "metric_pose": lambda options: metric_pose_tables(options.quick),
    "budget": lambda options: budget_tables(options.quick),
    "speed": lambda options: speed_tables(options.quick),
    "size": lambda options: size_tables(options.quick),
}


if __name__ == "__main__":
    sys.exit(run(TOPICS, __doc__, "places.place_recall_plot"))
