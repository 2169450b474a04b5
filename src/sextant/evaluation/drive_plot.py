# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plot of a drive: top view, and errors over time."""

from itertools import cycle
from typing import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from sextant.base.plot_colours import COLOURS
from sextant.base.plot_file import new_figure, save_figure
from sextant.evaluation.trajectory import Trajectory
from sextant.evaluation.trajectory_metrics import TrajectoryErrors, trajectory_errors


def plot_drive(
    path: str, truth: Trajectory, estimates: Mapping[str, Trajectory], markers: Sequence = ()
) -> None:
    """Writes the plot of a drive.

    :param path: image file; the ending selects the format (.png, .pdf, .svg)
    :param truth: true trajectory, at least one pose
    :param estimates: trajectories by name; their stamps must be in truth
    :param markers: sextant.MappedMarker of the map, drawn from above
    :raises OSError: the file cannot be written
    :raises ValueError: as trajectory_errors(), or the ending is not an image format
    """
    errors = {name: trajectory_errors(truth, estimate) for name, estimate in estimates.items()}
    figure = new_figure(path, 13, 6.5)
    grid = figure.add_gridspec(2, 2, left=0.05, right=0.98, bottom=0.08, top=0.94, wspace=0.16, hspace=0.22)
    draw_top_view(figure.add_subplot(grid[:, 0]), truth, estimates, markers)
    start = min(truth)
    _draw_errors(figure.add_subplot(grid[0, 1]), errors, start, "position", 100.0, "position error, cm")
    _draw_errors(
        figure.add_subplot(grid[1, 1]), errors, start, "angle", 180.0 / np.pi, "angle error, degrees"
    )
    save_figure(path, figure)


def draw_top_view(
    axes: Axes, truth: Trajectory, estimates: Mapping[str, Trajectory], markers: Sequence
) -> None:
    """Draws trajectories and the markers of the map.

    :param truth: empty: unknown

    Other parameters as plot_drive().
    """
    for colour, (name, estimate) in zip(cycle(COLOURS), estimates.items()):
        axes.plot(*_positions(estimate), ".", color=colour, markersize=3, label=name)
    if truth:
        axes.plot(*_positions(truth), "-", color="black", linewidth=1.0, label="truth")
    for marker in markers:
        draw_marker(axes, marker)
    # Limits from truth and map only: outliers must not enlarge them.
    paths = [truth] if truth else list(estimates.values())
    shown = np.hstack([*map(_positions, paths), *(marker.T_map_marker[:2, 3:] for marker in markers)])
    xlim, ylim = np.transpose([shown.min(axis=1) - 0.5, shown.max(axis=1) + 0.5])
    axes.set(xlim=xlim, ylim=ylim, title="top view", xlabel="x, m", ylabel="y, m", aspect="equal")
    axes.legend(loc="lower right", markerscale=3)
    axes.grid(alpha=0.3)


def draw_marker(axes: Axes, marker) -> None:
    """Draws a sextant.MappedMarker from above, with its id."""
    T = np.asarray(marker.T_map_marker)
    half = 0.5 * marker.size * T[:2, 0]
    centre = T[:2, 3]
    axes.plot(
        *np.stack([centre - half, centre + half], axis=1), color="black", linewidth=4, solid_capstyle="butt"
    )
    behind = centre - 0.25 * T[:2, 2]
    axes.text(*behind, str(marker.id), ha="center", va="center", clip_on=True)


def _draw_errors(
    axes: Axes, errors: Mapping[str, TrajectoryErrors], start: int, field: str, scale: float, label: str
) -> None:
    for colour, (name, series) in zip(cycle(COLOURS), errors.items()):
        values = np.maximum(getattr(series, field) * scale, 1e-3)  # a logarithmic axis has no zero
        axes.plot((series.stamps - start) * 1e-9, values, ".", color=colour, markersize=3, label=name)
    axes.set(xlabel="time, s", ylabel=label, yscale="log")
    axes.grid(which="both", alpha=0.3)


def _positions(trajectory: Trajectory) -> np.ndarray:
    """Returns (2, N) x and y by ascending stamp, metres."""
    return np.array([trajectory[stamp][:2, 3] for stamp in sorted(trajectory)]).reshape(-1, 2).T
