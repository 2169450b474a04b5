#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the detection of objects on real photos, and damaged files of labels, images and networks.

Exit status: 0 when every bar holds, 1 when one fails, 2 when something could not be measured.
"""

import sys

from command import run
from objects.damaged_files import damaged_file_tables
from objects.false_alarms import false_alarm_tables

TOPICS = {
    "photos": lambda options: false_alarm_tables(options.data / "places", options.quick),
    "damaged": lambda options: damaged_file_tables(options.quick),
}


if __name__ == "__main__":
    sys.exit(run(TOPICS, __doc__))
