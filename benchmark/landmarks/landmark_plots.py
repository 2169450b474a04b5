# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plots of landmark SLAM: NEES over the drives, and the real drive with its trees."""

from functools import partial
from pathlib import Path
from typing import Callable, Dict, List

from matplotlib.axes import Axes
from pictures import Panel, save_picture
from tables import Table


def plot(folder: Path, results: Dict[str, List[Table]]) -> None:
    """Writes folder/TOPIC.png of those that have a plot."""
    for topic in set(results) & set(DRAWINGS):
        (table,) = (table for table in results[topic] if table.samples)
        panel = Panel(table.title.replace(", ", "\n", 1), partial(DRAWINGS[topic], table))
        save_picture(folder / f"{topic}.png", [panel], columns=1)


def _draw_nees(table: Table, axes: Axes) -> None:
    for form, values in table.samples.items():
        axes.plot(values, label=form, linewidth=0.8)
    axes.axhline(1.0, color="black", linewidth=0.8)
    axes.set(xlabel="scan", ylabel="pose NEES / 3, mean of the drives", ylim=(0, None))


def _draw_drive(table: Table, axes: Axes) -> None:
    trees = table.samples["trees"]
    axes.scatter(*trees.T, s=8, color="tab:green", label="trees", zorder=3)
    for name in ("most probable", "invariant"):
        axes.plot(*table.samples[name].T, label=name, linewidth=0.8)
    axes.set(xlabel="x, m", ylabel="y, m", aspect="equal")
    axes.legend(fontsize="small", loc="upper right", bbox_to_anchor=(1.0, 0.8))


DRAWINGS: Dict[str, Callable[[Table, Axes], None]] = {"accuracy": _draw_nees, "victoria_park": _draw_drive}
