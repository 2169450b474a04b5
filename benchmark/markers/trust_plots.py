# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of what marker_trust.py measured: one a topic, drawn from the samples of its tables."""

from functools import partial
from pathlib import Path
from typing import Callable, Dict, List

import numpy as np
from matplotlib.axes import Axes
from pictures import Panel, readable_decades, save_picture, shares
from scipy.stats import chi2
from tables import Table

from markers.head_on import JUMP
from markers.moved_marker import OFFSET, OFFSETS
from markers.recorded_trust import OUTSIDE

COLUMNS = {2: 2, 4: 2}  # by panels; 3 of any other number
RIGHT_MAP = {"color": "k", "lw": 2, "label": "right map", "zorder": 3}
WRONG_MAP = {"color": "tab:red", "lw": 0.6}


def plot(folder: Path, results: Dict[str, List[Table]]) -> None:
    """Writes folder/TOPIC.png of every topic."""
    for topic, tables in results.items():
        panels = [panel for table in tables for panel in PANELS[topic](table)]
        save_picture(folder / f"{topic}.png", panels, COLUMNS.get(len(panels), 3))


def _coverage(table: Table) -> List[Panel]:
    """Shares of the poses in the regions that should hold so many: on the diagonal is honest."""
    return [Panel(table.title.replace(": ", ":\n"), partial(_draw_coverage, table))]


def _draw_coverage(table: Table, axes: Axes) -> None:
    lenses = {title.split(",")[0] for title in table.samples}
    for lens in sorted(lenses):
        nees = [each for title, each in table.samples.items() if title.split(",")[0] == lens]
        axes.plot(*shares(100.0 * chi2.cdf(np.concatenate(nees), 6)), lw=1.2, label=lens)
    axes.plot([0, 100], [0, 100], "k:", lw=1, label="exact")
    axes.plot([95, 95], [93, 97], "k", lw=4, alpha=0.5)
    axes.set(xlabel="region of the published covariance (6 d.o.f.), %", ylabel="poses in it, %")
    axes.set(xlim=(0, 100), ylim=(0, 100))
    axes.legend(fontsize="small", loc="lower right")


def _head_on(table: Table) -> List[Panel]:
    return [Panel(name, partial(_draw_head_on, each)) for name, each in table.samples.items()]


def _draw_head_on(samples: np.ndarray, axes: Axes) -> None:
    distance, error, sigma, jump = samples[np.argsort(samples[:, 0])].T
    axes.fill_between(distance, -2 * sigma, 2 * sigma, alpha=0.4, lw=0, label="± 2 published deviations")
    axes.plot(distance, error, "k.", ms=2, label="error")
    far = jump > JUMP
    axes.plot(distance[far], error[far], "rx", label=f"jump beyond {JUMP:g} deviations")
    axes.set(xlabel="distance to the marker, m", ylabel="error across the line of sight, cm")
    axes.legend(fontsize="small", loc="upper left")


def _moved_marker(table: Table) -> List[Panel]:
    return [
        Panel(table.title, partial(_draw_errors, table)),
        Panel("Estimated offset of the moved marker", partial(_draw_offsets, table)),
    ]


def _draw_errors(table: Table, axes: Axes) -> None:
    for name, errors in table.samples.items():
        if name != OFFSETS:
            axes.plot(*shares(errors), **(RIGHT_MAP if name == "right map" else WRONG_MAP))
    axes.plot([], [], label="one entry wrong, a line each", **WRONG_MAP)
    axes.axvline(100.0 * OFFSET, color="grey", ls=":", label="the entry's own error")
    readable_decades(axes)
    axes.set(xlabel="position error, cm", ylabel="poses with less, %", ylim=(0, 100))


def _draw_offsets(table: Table, axes: Axes) -> None:
    offsets = table.samples[OFFSETS]
    names = [name for name, _ in table.rows[1:]]
    axes.barh(np.arange(len(offsets)), offsets, color="tab:blue", alpha=0.7, label="estimated")
    axes.axvline(-100.0 * OFFSET, color="k", ls="--", label="truth")
    axes.set_yticks(np.arange(len(names)))
    axes.set_yticklabels(names, fontsize=6)
    for row in np.flatnonzero(np.isnan(offsets)):
        axes.text(-1.0, row, "not named", ha="right", va="center", fontsize=6)
    axes.set(xlabel="seen minus mapped along the moved axis, cm", xlim=(-200.0 * OFFSET, 0.0))
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.legend(fontsize="small", loc="upper left")


def _real(table: Table) -> List[Panel]:
    return [Panel(f"{table.title}, every marker alone", partial(_draw_distances, table))]


def _draw_distances(table: Table, axes: Axes) -> None:
    distances = table.samples["single markers"]
    edges = np.linspace(0.0, max(20.0, np.percentile(distances, 99.9)), 60)
    axes.hist(np.minimum(distances, edges[-1]), edges, color="tab:blue", alpha=0.7, label="published poses")
    expected = len(distances) * np.diff(chi2.cdf(edges, 3))
    axes.stairs(expected, edges, color="k", label="chi-square, 3 d.o.f.")
    axes.axvline(OUTSIDE, color="r", ls="--", label=f"{OUTSIDE}: one of 400 is beyond")
    axes.set(xlabel="squared Mahalanobis distance in position (last bar: all beyond)")
    axes.set(ylabel="poses", yscale="log", ylim=(0.5, None))


def _speed(table: Table) -> List[Panel]:
    return [Panel(table.title.replace(", ", "\n", 1), partial(_draw_speed, table))]


def _draw_speed(table: Table, axes: Axes) -> None:
    names = [name for name, _ in table.rows]
    cpu = [cells[0].value for _, cells in table.rows]
    axes.bar(range(len(cpu)), cpu, color=["tab:grey", "tab:blue", "tab:green"], alpha=0.7)
    for at, (_, cells) in enumerate(table.rows):
        axes.text(at, cells[0].value, f"{cells[0].value:.2f}", ha="center", va="bottom", fontsize="small")
        if cells[1].at_most is not None:
            label = None if axes.get_legend_handles_labels()[0] else "bar"
            axes.plot([at - 0.4, at + 0.4], [cells[1].at_most * cpu[0]] * 2, "r--", label=label)
    axes.set_xticks(range(len(names)))
    axes.set_xticklabels(names, fontsize="small")
    axes.set(ylabel="CPU an image, ms")
    axes.margins(y=0.15)


def _chain(table: Table) -> List[Panel]:
    if not table.samples:  # the stages
        return []
    return [Panel(table.title.replace("; ", "\n"), partial(_draw_latencies, table))]


def _draw_latencies(table: Table, axes: Axes) -> None:
    for (name, latencies), colour in zip(table.samples.items(), ("tab:blue", "tab:orange")):
        axes.step(*shares(latencies), where="post", color=colour, label=name)
    for (name, cells), colour in zip(table.rows, ("tab:blue", "tab:orange")):
        figure = dict(zip(table.columns, cells))
        if figure["of the library's time"].at_most is not None:
            bar = figure["of the library's time"].at_most * figure["library's time, ms"].value
            axes.axvline(bar, color=colour, ls="--", label=f"bar of the median, {name.split()[0]}")
    readable_decades(axes)
    axes.set(xlabel="latency from image to pose, ms", ylabel="poses with less, %", ylim=(0, 100))


PANELS: Dict[str, Callable[[Table], List[Panel]]] = {
    "consistency": _coverage,
    "head_on": _head_on,
    "moved_marker": _moved_marker,
    "real": _real,
    "speed": _speed,
    "chain": _chain,
}
