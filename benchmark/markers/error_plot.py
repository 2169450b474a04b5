# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Picture of how often an error is exceeded, by mode."""

from functools import partial
from pathlib import Path
from typing import Dict, List

import numpy as np
from matplotlib.axes import Axes
from pictures import Panel, save_picture, shares
from tables import Table

BY_MODE = ("tagslam", "simulated")  # topics


def plot(folder: Path, results: Dict[str, List[Table]]) -> None:
    """Writes folder/TOPIC.png of those that have errors by mode, one diagram a table."""
    for topic in set(results) & set(BY_MODE):
        tables = [table for table in results[topic] if table.samples]
        panels = [Panel("\n".join(table.title.split("; ")), partial(_draw, table)) for table in tables]
        save_picture(folder / f"{topic}.png", panels, columns=len(panels))


def _draw(table: Table, axes: Axes) -> None:
    for mode, errors in table.samples.items():
        axes.step(*shares(np.maximum(errors, 1e-3)), where="post", label=mode)
    axes.set(xscale="log", xlabel="position error, cm", ylabel="poses with less, %", ylim=(0, 100))
