#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Compares Sextant with other packages that rospack finds, on the same simulated input.

Exit status: 0 when every bar holds, 1 when one fails, 2 when something could not be measured.
"""

import sys

from command import run
from peers.ekf_corridor import corridor_tables
from peers.marker_peers import marker_tables
from peers.navigation import navigation_tables
from ros_session import in_own_process

TOPICS = {
    "markers": lambda options: in_own_process(marker_tables, options.quick),
    "navigation": lambda options: in_own_process(navigation_tables, options.quick),
    "corridor": lambda options: in_own_process(corridor_tables, options.quick),
}


if __name__ == "__main__":
    sys.exit(run(TOPICS, __doc__))
