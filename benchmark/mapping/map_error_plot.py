# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Picture of how often a marker's position in a map is off by how much."""

from functools import partial
from pathlib import Path
from typing import Dict, List

import numpy as np
from matplotlib.axes import Axes
from pictures import Panel, save_picture
from tables import Table


def plot_map_errors(folder: str, results: Dict[str, List[Table]]) -> None:
    """Writes folder/simulated.png, if that topic was measured; makes the folder."""
    Path(folder).mkdir(parents=True, exist_ok=True)
    for table in results.get("simulated", []):
        save_picture(
            str(Path(folder) / "simulated.png"), [Panel(table.title, partial(_draw, table))], columns=1
        )


def _draw(table: Table, axes: Axes) -> None:
    for name, errors in table.samples.items():
        share = 100.0 * np.arange(1, len(errors) + 1) / len(errors)
        axes.step(np.sort(errors), share, where="post", label=name)
    axes.set(
        xscale="log", xlabel="position error of a marker, mm", ylabel="markers with less, %", ylim=(0, 100)
    )
