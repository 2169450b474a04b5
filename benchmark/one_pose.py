#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the one pose of markers, landmarks, places and odometry in a simulated building, its
maps, and the CPU time of its nodes.

Exit status: 0 when every bar holds, 1 when one fails, 2 when something could not be measured.
"""

import sys

from command import run
from one_pose.cost import cost_tables
from one_pose.failures import failure_tables
from one_pose.kidnappings import kidnapping_tables
from one_pose.maps_of_a_round import map_tables

TOPICS = {
    "kidnappings": lambda options: kidnapping_tables(options.quick),
    "failures": lambda options: failure_tables(options.quick),
    "maps": lambda options: map_tables(options.quick),
    "cost": lambda options: cost_tables(options.quick),  # last: the threads of rospy must not be forked
}


if __name__ == "__main__":
    sys.exit(run(TOPICS, __doc__))
