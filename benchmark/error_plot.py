# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Picture of how often an error is exceeded, by mode."""

from functools import partial
from typing import List

import numpy as np
from matplotlib.axes import Axes
from pictures import Panel, save_picture
from tables import Table


def plot_errors(path: str, tables: List[Table]) -> None:
    """One diagram a table: share of the poses whose error stays below x.

    :param path: picture file; the ending chooses the format
    :raises ValueError: there is nothing to plot, or the ending is no picture
    """
    if not tables:
        raise ValueError("--plot: none of the parts that were run has errors by mode")
    panels = [Panel("\n".join(table.title.split("; ")), partial(_draw, table)) for table in tables]
    save_picture(path, panels, columns=len(panels))


def _draw(table: Table, axes: Axes) -> None:
    for mode, errors in table.samples.items():
        share = 100.0 * np.arange(1, len(errors) + 1) / len(errors)
        axes.step(np.maximum(np.sort(errors), 1e-3), share, where="post", label=mode)
    axes.set(xscale="log", xlabel="position error, cm", ylabel="poses with less, %", ylim=(0, 100))
