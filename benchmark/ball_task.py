#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the ball task: rendering speed, accuracy of the locator, and success rate in 40 worlds each.
score_ball_task is the long run with 200 worlds each; objects.py runs 200 hard ones.

Exit status: 0 when every bar holds, 1 when one fails, 2 when something could not be measured.
"""

import sys
from typing import List

from ball.arena_speed import arena_tables
from ball.ball_matches import match_tables
from ball.object_places import FAULTY, place_tables
from command import run
from tables import Table

from sextant.objects.shipped_model import shipped_model
from sextant.objects.yolo_detector import YoloDetector, YoloParams


def places(quick: bool) -> List[Table]:
    """Tables of located objects: with the network's boxes, jittered true boxes, and a poor depth camera."""
    network = YoloDetector(YoloParams(model=str(shipped_model())))
    return [*place_tables(quick, network), *place_tables(quick), *place_tables(quick, camera=FAULTY)]


TOPICS = {
    "world": lambda options: arena_tables(options.quick),
    "places": lambda options: places(options.quick),
    "task": lambda options: match_tables(options.quick),
}


if __name__ == "__main__":
    sys.exit(run(TOPICS, __doc__, "ball.ball_plots"))
