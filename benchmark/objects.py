#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the detection of objects: the network that comes with Sextant on simulated images and real photos,
networks that Ultralytics' software exports (needs a Python with it: SEXTANT_ULTRALYTICS), the ball task in
hard rooms, damaged files, and a network that is trained on real photos (needs PyTorch).

Exit status: 0 when every bar holds, 1 when one fails, 2 when something could not be measured.
"""

import sys

from ball.ball_matches import match_tables
from command import run
from objects.damaged_files import damaged_file_tables
from objects.exports import export_tables
from objects.false_alarms import false_alarm_tables
from objects.network_accuracy import detector_tables
from objects.own_photos import own_photo_tables

TOPICS = {
    "network": lambda options: detector_tables(options.quick),
    "photos": lambda options: false_alarm_tables(options.data / "places", options.quick),
    "exports": lambda options: export_tables(
        options.data / "places", options.data / "objects/blimp", options.quick
    ),
    "task": lambda options: match_tables(options.quick, is_hard=True),
    "damaged": lambda options: damaged_file_tables(options.quick),
    "training": lambda options: own_photo_tables(options.data / "objects/blimp", options.quick),
}


if __name__ == "__main__":
    sys.exit(run(TOPICS, __doc__, "objects.object_plots"))
