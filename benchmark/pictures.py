# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of several diagrams, without a window system."""

from typing import Callable, List, NamedTuple

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter


class Panel(NamedTuple):
    """One diagram: title, and what draws it."""

    title: str
    draw: Callable[[Axes], None]


def readable_decades(axes: Axes) -> None:
    """Labels 1, 2, 5, 10 on a logarithmic x axis."""
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(FormatStrFormatter("%g"))
    axes.xaxis.set_minor_formatter(NullFormatter())


def save_picture(path: str, panels: List[Panel], columns: int) -> None:
    """Side by side in so many columns; a panel without a legend of its own gets one.

    :param path: picture file; the ending chooses the format
    """
    columns = min(columns, len(panels))
    rows = -(-len(panels) // columns)
    figure = Figure(figsize=(5.5 * columns, 4.2 * rows))
    FigureCanvasAgg(figure)  # not pyplot: it has a state of its own
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
