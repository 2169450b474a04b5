#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures landmark SLAM: consistency, data association, recorded drives and their maps by all observations,
simulated drives with their faults, what makes both difficult, time, bad messages and hours in a large map,
late observations, printed markers, and relocalization.

Exit status: 0 when every bar holds, 1 when one fails, 2 when something could not be measured.
"""

import sys

from command import run

from landmarks.landmark_accuracy import accuracy_tables
from landmarks.landmark_association import association_tables
from landmarks.landmark_batch import batch_tables
from landmarks.landmark_cost import cost_tables
from landmarks.landmark_delay import delay_tables
from landmarks.landmark_drive_figures import drive_figure_tables
from landmarks.landmark_fusion import fusion_tables
from landmarks.landmark_kidnap import kidnap_tables
from landmarks.landmark_limits import limit_tables
from landmarks.landmark_real_drives import real_drive_tables
from landmarks.landmark_realistic import realistic_tables
from landmarks.landmark_victoria_park import victoria_park_tables

TOPICS = {
    "accuracy": lambda options: accuracy_tables(options.quick),
    "association": lambda options: association_tables(options.quick),
    "victoria_park": lambda options: victoria_park_tables(options.data / "landmarks", options.quick),
    "real_drives": lambda options: real_drive_tables(options.data / "landmarks" / "mrclam", options.quick),
    "batch": lambda options: batch_tables(options.data / "landmarks" / "mrclam", options.quick),
    "drive_figures": lambda options: drive_figure_tables(
        options.data / "landmarks" / "mrclam", options.quick
    ),
    "realistic": lambda options: realistic_tables(options.quick),
    "cost": lambda options: cost_tables(options.quick),
    "limits": lambda options: limit_tables(options.quick),
    "delay": lambda options: delay_tables(options.quick),
    "fusion": lambda options: fusion_tables(options.quick),
    "kidnap": lambda options: kidnap_tables(options.quick),
}


if __name__ == "__main__":
    sys.exit(run(TOPICS, __doc__, "landmarks.landmark_plots"))
