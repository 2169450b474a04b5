# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plots of the ball task: time and position at the end of each run."""

from functools import partial
from pathlib import Path
from typing import Dict, List

from matplotlib.axes import Axes
from pictures import Panel, save_picture
from tables import Table

from sextant.evaluation.ball_score import STOP, STOP_ERROR


def plot(folder: Path, results: Dict[str, List[Table]]) -> None:
    """Writes folder/task.png."""
    if "task" in results:
        (table,) = results["task"]
        save_picture(folder / "task.png", [Panel(table.title, partial(_draw_ends, table))], columns=1)


def _draw_ends(table: Table, axes: Axes) -> None:
    """Of samples (n, 2): seconds until the ball was through, metres from the line to the robot at the end."""
    for name, ends in table.samples.items():
        axes.plot(ends[:, 0], 100.0 * ends[:, 1], "o", markersize=4, label=name)
    axes.axhspan(100.0 * (STOP - STOP_ERROR), 100.0 * (STOP + STOP_ERROR), color="0.9", zorder=0)
    axes.set(xlabel="s until the ball is through", ylabel="cm from the line to the robot at the end")
    axes.legend()
