# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rendering speed of the ball task's simulation: colour and depth of 640×480 pixels on one core."""

import time
from typing import List

import cv2
import numpy as np
from tables import Table, Value

from sextant.simulation.ball_simulation import BallSimulation, BallSimulationParams
from sextant.simulation.ball_world import random_world

WORLDS, SHOTS, QUICK_WORLDS = 20, 10, 2  # worlds; image pairs in each; worlds of a quick run
FRAMES = 15.0  # minimum rate of image pairs, Hz


def arena_tables(quick: bool) -> List[Table]:
    """One table of rates by CPU time: in each world the minimum of SHOTS image pairs."""
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    seconds = [_least(seed) for seed in range(QUICK_WORLDS if quick else WORLDS)]
    cv2.setNumThreads(threads)
    rate = Value(1.0 / np.median(seconds), 1, at_least=None if quick else FRAMES)
    worst = Value(1.0 / max(seconds), 1)
    return [
        Table(
            "drawing colour and depth, 640×480",
            ["frames a second", "in the slowest world"],
            [("one core", [rate, worst])],
        )
    ]


def _least(seed: int) -> float:
    """Minimum CPU time of a pair of images, seconds."""
    simulation = BallSimulation(random_world(3, seed), BallSimulationParams(seed=seed))
    seconds = []
    for _ in range(SHOTS):
        begin = time.process_time()
        simulation.take_images()
        seconds.append(time.process_time() - begin)
    return min(seconds)
