# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plot of several estimates of one drive: top view; x, y and yaw over time with bands of two sigma."""

from itertools import cycle
from typing import Dict, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from matplotlib.axes import Axes

from sextant.base.plot_colours import COLOURS
from sextant.base.plot_file import save_figure
from sextant.evaluation.drive_plot import drive_figure
from sextant.evaluation.trajectory import Trajectory

SIGMAS = 2.0  # half width of a band, standard deviations
GAP = 1.0  # seconds between two poses above which a curve is interrupted
INSIDE = (1.0, 99.0)  # percentiles of the curves' and bands' values that a panel shows
AXES = {"x": 0, "y": 1, "yaw": 5}  # index in a covariance


class DriveEstimate(NamedTuple):
    """Poses of one topic or mode."""

    poses: Trajectory  # in the frame of the plot
    covariances: Dict[int, np.ndarray]  # (6, 6) by stamp, as PoseWithCovariance; no band without


def plot_bands(
    path: str,
    estimates: Mapping[str, DriveEstimate],
    truth: Optional[Trajectory] = None,
    markers: Sequence = (),
) -> None:
    """Writes the plot: errors over time if there is a true trajectory, else the poses themselves.

    :param path: image file; the ending selects the format (.png, .pdf, .svg)
    :param estimates: by name, at least one, each with a pose
    :param truth: at the stamps of all estimates; None: unknown
    :param markers: sextant.MappedMarker of the map, drawn from above
    :raises OSError: the file cannot be written
    :raises ValueError: the ending is not an image format
    """
    paths = {name: each.poses for name, each in estimates.items()}
    figure, panels = drive_figure(path, truth or {}, paths, markers, len(AXES))
    start = min(min(each.poses) for each in estimates.values())
    for panel, axis in zip(panels, AXES):
        for colour, (name, each) in zip(cycle(COLOURS), estimates.items()):
            _draw(panel, _curve(each, truth, axis, start), colour, name)
        _finish(panel, axis, truth is not None)
    panels[0].set_title(f"bands: {SIGMAS:g} standard deviations", fontsize=11)
    save_figure(path, figure)


def _curve(
    of: DriveEstimate, truth: Optional[Trajectory], axis: str, start: int
) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns times (N,) in seconds, values and standard deviations (N,) in the plotted unit;
    NaN in gaps."""
    stamps = np.array(sorted(of.poses), dtype=np.int64)
    values = _values(of.poses, stamps, axis)
    if truth is not None:
        values = values - _values(truth, stamps, axis)
    if axis == "yaw":
        values = (values + np.pi) % (2.0 * np.pi) - np.pi
    index, nothing = AXES[axis], np.full((6, 6), np.nan)
    variances = np.array([of.covariances.get(int(stamp), nothing)[index, index] for stamp in stamps])
    sigmas = np.sqrt(np.where(variances >= 0.0, variances, np.nan))  # some filters publish negative ones
    seconds = 1e-9 * (stamps - start)
    jumps = (np.diff(seconds) > GAP) | ((axis == "yaw") & (np.abs(np.diff(values)) > np.pi))
    scale = 180.0 / np.pi if axis == "yaw" else 100.0 if truth is not None else 1.0
    gaps = np.flatnonzero(jumps) + 1
    return tuple(np.insert(each, gaps, np.nan) for each in (seconds, scale * values, scale * sigmas))


def _values(trajectory: Trajectory, stamps: np.ndarray, axis: str) -> np.ndarray:
    poses = np.array([trajectory[int(stamp)] for stamp in stamps])
    return np.arctan2(poses[:, 1, 0], poses[:, 0, 0]) if axis == "yaw" else poses[:, AXES[axis], 3]


def _draw(axes: Axes, curve: Tuple[np.ndarray, np.ndarray, np.ndarray], colour: str, name: str) -> None:
    seconds, values, sigmas = curve
    axes.plot(seconds, values, ".-", color=colour, markersize=2, linewidth=1, label=name)
    axes.fill_between(
        seconds, values - SIGMAS * sigmas, values + SIGMAS * sigmas, color=colour, alpha=0.2, linewidth=0
    )


def _finish(axes: Axes, axis: str, is_error: bool) -> None:
    unit = "degrees" if axis == "yaw" else "cm" if is_error else "m"
    axes.set(xlabel="time, s" if axis == "yaw" else "", ylabel=f"{axis}{' error' * is_error}, {unit}")
    axes.grid(alpha=0.3)
    if is_error:
        axes.axhline(0.0, color="black", linewidth=1)
    curves = [line.get_ydata() for line in axes.lines if len(line.get_ydata()) > 2]
    bands = [path.vertices[:, 1] for band in axes.collections for path in band.get_paths()]
    low, high = _percentiles([*curves, *bands])
    if len(curves) > 1:  # a wide band does not hide the other curves
        least, most = _percentiles(curves)
        low, high = max(low, 2.0 * least - most), min(high, 2.0 * most - least)
    margin = max(0.15 * (high - low), 1e-3)
    axes.set_ylim(low - margin, high + margin)


def _percentiles(drawn: Sequence[np.ndarray]) -> np.ndarray:
    """Low and high percentile of what is drawn."""
    return np.nanpercentile(np.concatenate(drawn) if drawn else np.zeros(1), INSIDE)
