# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Picture of how often a marker's position in a map is off by how much."""

from functools import partial
from pathlib import Path
from typing import Dict, List

from matplotlib.axes import Axes
from pictures import Panel, save_picture, shares
from tables import Table


def plot(folder: Path, results: Dict[str, List[Table]]) -> None:
    """Writes folder/simulated.png, if that topic was measured."""
    for table in results.get("simulated", []):
        save_picture(folder / "simulated.png", [Panel(table.title, partial(_draw, table))], columns=1)


def _draw(table: Table, axes: Axes) -> None:
    for name, errors in table.samples.items():
        axes.step(*shares(errors), where="post", label=name)
    axes.set(
        xscale="log", xlabel="position error of a marker, mm", ylabel="markers with less, %", ylim=(0, 100)
    )
