# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes picture files with several diagrams; needs no display."""

from pathlib import Path
from typing import Callable, List, NamedTuple, Tuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter


class Panel(NamedTuple):
    """One diagram: its title and the function that draws it."""

    title: str
    draw: Callable[[Axes], None]


def readable_decades(axes: Axes) -> None:
    """Labels 1, 2, 5, 10 on a logarithmic x axis."""
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(FormatStrFormatter("%g"))
    axes.xaxis.set_minor_formatter(NullFormatter())


def shares(values: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Empirical distribution: the sorted values (N,), and the percentage of values up to each."""
    return np.sort(values), 100.0 * np.arange(1, len(values) + 1) / len(values)


def save_picture(path: Path, panels: List[Panel], columns: int) -> None:
    """Writes panels in a grid; adds a legend to panels that have none.

    :param path: picture file; its extension determines the format
    :param columns: maximum number of columns
    """
    columns = min(columns, len(panels))
    rows = -(-len(panels) // columns)
    figure = Figure(figsize=(5.5 * columns, 4.2 * rows))
    FigureCanvasAgg(figure)  # not pyplot, which has global state
    grid = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes, panel in zip(grid, panels):
        panel.draw(axes)
        axes.set_title(panel.title, fontsize="small")
        axes.grid(which="both", alpha=0.3)
        if axes.get_legend_handles_labels()[0] and not axes.get_legend():
            axes.legend(fontsize="small")
    for axes in grid[len(panels) :]:
        axes.set_visible(False)
    figure.tight_layout()
    figure.savefig(path, dpi=110)
