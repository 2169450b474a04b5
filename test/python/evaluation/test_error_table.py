# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
from random_drives import pose

from sextant.evaluation.error_table import error_table
from sextant.evaluation.trajectory_metrics import trajectory_errors


def test_table():
    truth = {stamp: pose() for stamp in range(4)}
    series = {"joint": {0: pose(0.01), 1: pose(0.03, rotvec=(0, np.pi / 2, 0))}, "none": {}}
    table = error_table({name: trajectory_errors(truth, estimate) for name, estimate in series.items()})
    assert table.splitlines() == [
        "        position error, cm         angle error, degrees       frames",
        "         mean    95 %    worst      mean    95 %    worst   with a pose",
        "joint    2.00    2.90     3.00     45.00   85.50    90.00   2 of 4",
        "none      nan     nan      nan       nan     nan      nan   0 of 4",
    ]
