# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plot of a drive: top view, and errors over time."""

from itertools import cycle
from typing import List, Mapping, Sequence, Tuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sextant.base.plot_colours import COLOURS
from sextant.base.plot_file import new_figure, save_figure
from sextant.evaluation.trajectory import Trajectory
from sextant.evaluation.trajectory_metrics import TrajectoryErrors, trajectory_errors

LONG = 3.0  # ratio of length to width from which the top view is above the panels, not beside them


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
    figure, (position, angle) = drive_figure(path, truth, estimates, markers, 2)
    start = min(truth)
    _draw_errors(position, errors, start, "position", 100.0, "position error, cm")
    _draw_errors(angle, errors, start, "angle", 180.0 / np.pi, "angle error, degrees")
    save_figure(path, figure)


def drive_figure(
    path: str, truth: Trajectory, estimates: Mapping[str, Trajectory], markers: Sequence, panels: int
) -> Tuple[Figure, List[Axes]]:
    """Creates a figure with the top view; returns it with the axes of panels over time, below one another.

    :param truth: empty: unknown

    Other parameters as plot_drive().
    :raises ValueError: the ending is not an image format
    """
    limits = _limits(truth, estimates, markers)
    length, width = np.diff(limits).ravel()
    is_long = length > LONG * width
    parts = _long_figure(path, panels, width / length) if is_long else _figure(path, panels)
    figure, top_view, others = parts
    _draw_top_view(top_view, truth, estimates, markers)
    top_view.set(xlim=limits[0], ylim=limits[1])
    place = {"bbox_to_anchor": (1.0, 1.02), "borderaxespad": 0.0, "ncol": 6} if is_long else {}
    top_view.legend(loc="lower right", markerscale=3, **place)
    return figure, others


def _figure(path: str, panels: int) -> Tuple[Figure, Axes, List[Axes]]:
    """Arranges the top view beside the panels."""
    figure = new_figure(path, 13, 4.5 + panels)
    grid = figure.add_gridspec(
        panels, 2, left=0.05, right=0.985, bottom=0.07, top=0.95, wspace=0.15, hspace=0.3
    )
    top_view = figure.add_subplot(grid[:, 0], title="top view")
    return figure, top_view, [figure.add_subplot(grid[row, 1]) for row in range(panels)]


def _long_figure(path: str, panels: int, ratio: float) -> Tuple[Figure, Axes, List[Axes]]:
    """Arranges the top view above the panels. :param ratio: of its height to its width"""
    left, right, above, under, between, below, panel = 0.75, 0.15, 0.5, 0.4, 0.5, 0.55, 2.0  # inches
    view = max(0.6, (13.0 - left - right) * ratio)
    height = above + view + under + panels * (between + panel) + below
    figure = new_figure(path, 13, height)

    def axes(bottom: float, of_height: float) -> Axes:
        box = (left / 13.0, bottom / height, 1.0 - (left + right) / 13.0, of_height / height)
        return figure.add_axes(box)

    top_view = axes(height - above - view, view)
    top_view.set_title("top view", loc="left")
    return figure, top_view, [axes(below + row * (between + panel), panel) for row in reversed(range(panels))]


def _limits(truth: Trajectory, estimates: Mapping[str, Trajectory], markers: Sequence) -> np.ndarray:
    """Returns (2, 2) limits of x and y, from truth and map only: outliers must not enlarge them."""
    paths = [truth] if truth else list(estimates.values())
    shown = np.hstack([*map(_positions, paths), *(marker.T_map_marker[:2, 3:] for marker in markers)])
    return np.transpose([shown.min(axis=1) - 0.5, shown.max(axis=1) + 0.5])


def _draw_top_view(
    axes: Axes, truth: Trajectory, estimates: Mapping[str, Trajectory], markers: Sequence
) -> None:
    for colour, (name, estimate) in zip(cycle(COLOURS), estimates.items()):
        axes.plot(*_positions(estimate), ".", color=colour, markersize=3, label=name)
    if truth:
        axes.plot(*_positions(truth), "-", color="black", linewidth=1.0, label="truth")
    for marker in markers:
        draw_marker(axes, marker)
    axes.set(xlabel="x, m", ylabel="y, m", aspect="equal")
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
