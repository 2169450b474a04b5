#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the ball task: how fast its world is drawn, the network that finds objects, where they are, how
often the robot brings the ball through the goal. The long run, with 200 worlds each, is score_ball_task.

Exit status: 0 when every bar holds, 1 when one fails, 2 when something could not be measured.
"""

import sys
from typing import List

from ball.arena_speed import arena_tables
from ball.ball_matches import match_tables
from ball.object_detector import detector_tables
from ball.object_places import place_tables
from command import Results, run
from tables import Table

from sextant.objects.shipped_model import shipped_model
from sextant.objects.yolo_detector import YoloDetector, YoloParams


def places(quick: bool) -> List[Table]:
    """By the network's boxes, then by true ones that are a little off."""
    network = YoloDetector(YoloParams(model=str(shipped_model())))
    return [*place_tables(quick, network), *place_tables(quick)]


TOPICS = {
    "world": lambda options: arena_tables(options.quick),
    "detector": lambda options: detector_tables(options.quick),
    "places": lambda options: places(options.quick),
    "task": lambda options: match_tables(options.quick),
}


def plot(folder: str, results: Results) -> None:
    """What the network takes for what."""
    from ball.ball_plots import plot_ball_task  # only now: matplotlib takes a second to load

    plot_ball_task(folder, results)


if __name__ == "__main__":
    sys.exit(run(TOPICS, __doc__, plot, sys.argv[1:]))
