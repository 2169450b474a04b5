# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Picture of how often an error is exceeded, by mode."""

from typing import List

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from tables import Table


def plot_errors(path: str, tables: List[Table]) -> None:
    """One diagram a table: share of the poses whose error stays below x.

    :param path: picture file; the ending chooses the format
    :raises ValueError: there is nothing to plot, or the ending is no picture
    """
    if not tables:
        raise ValueError("--plot: none of the parts that were run has errors by mode")
    figure = Figure(figsize=(5.5 * len(tables), 4.2))
    FigureCanvasAgg(figure)  # not pyplot: it needs a window system and has a state of its own
    for axes, table in zip(figure.subplots(1, len(tables), squeeze=False)[0], tables):
        for mode, errors in table.samples.items():
            share = 100.0 * np.arange(1, len(errors) + 1) / len(errors)
            axes.step(np.maximum(np.sort(errors), 1e-3), share, where="post", label=mode)
        axes.set(xscale="log", xlabel="position error, cm", ylabel="poses with less, %", ylim=(0, 100))
        axes.set_title("\n".join(table.title.split("; ")), fontsize="small")
        axes.grid(which="both", alpha=0.3)
        axes.legend()
    figure.tight_layout()
    figure.savefig(path, dpi=110)
