# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plot of a landmark map and of the drives that it was built from, from above."""

from collections import Counter
from pathlib import Path
from typing import List, Union

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Ellipse

import sextant
from sextant.base.plot_file import figure_png, new_figure, save_figure
from sextant.landmarks.landmark_colours import colour_of_class
from sextant.landmarks.slam_run import DriveSegment, LandmarkResult

SIGMAS = 2.0  # semi-axes of the ellipses, standard deviations
WIDTH, MIN_HEIGHT, MAX_HEIGHT = 10.0, 4.0, 12.0  # inches of the plot itself
LEFT, RIGHT, BELOW, ABOVE = 0.8, 0.3, 0.6, 0.4  # inches around it
LEGEND_ROW, LEGEND_COLUMNS = 0.25, 4  # inches, entries
MARGIN = 0.06  # of the larger extent, and at least 0.5 m
MAX_NAMES = 60  # landmarks with a label; more labels would overlap
ROBOT_COLOUR, ODOMETRY_COLOUR = "#333333", "#b5b5b5"
ENDINGS = (".png", ".pdf", ".svg")


def write_plot(path: Union[str, Path], result: LandmarkResult) -> None:
    """Plots landmarks in their classes' colours with 2-sigma ellipses, and the paths of robot and odometry.

    :param path: image file; its ending sets the format (ENDINGS)
    :raises OSError: it cannot be written
    """
    save_figure(path, _figure(path, result))


def plot_png(result: LandmarkResult) -> bytes:
    """The plot of write_plot() for a page."""
    return figure_png(_figure("map.png", result))


def _figure(path: Union[str, Path], result: LandmarkResult) -> Figure:
    landmark_map = result.map
    segments = [segment for segment in result.segments if segment.robot]
    low, high = _limits(landmark_map, segments)
    legend = _legend(landmark_map)
    above = ABOVE + LEGEND_ROW * -(-len(legend) // LEGEND_COLUMNS)
    extent = high - low
    scale = min(WIDTH / extent[0], MAX_HEIGHT / extent[1])
    inner = np.maximum(scale * extent, [WIDTH, MIN_HEIGHT])
    width, height = inner + [LEFT + RIGHT, BELOW + above]
    figure = new_figure(path, width, height)
    axes = figure.add_axes((LEFT / width, BELOW / height, inner[0] / width, inner[1] / height))
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel=f"x in {landmark_map.frame}, m", ylabel="y, m")
    axes.grid(alpha=0.25)
    for segment in segments:
        _draw_segment(axes, segment)
    _draw_landmarks(axes, landmark_map)
    place = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0), "ncol": LEGEND_COLUMNS, "frameon": False}
    axes.legend(handles=legend, **place)
    return figure


def _limits(landmark_map: "sextant.LandmarkMap", segments: List[DriveSegment]):
    """Extent of the map and the robot's path, without that of odometry, which may drift far away."""
    points = [landmark.position for landmark in landmark_map.landmarks]
    points += [pose[:2] for segment in segments for pose in segment.robot.values()] or [np.zeros(2)]
    low, high = np.min(points, axis=0), np.max(points, axis=0)
    margin = max(0.5, MARGIN * float(np.max(high - low)))
    return low - margin, high + margin


def _draw_segment(axes: Axes, segment: DriveSegment) -> None:
    first = next(iter(segment.robot))
    odometry = [pose for stamp, pose in segment.odometry.items() if stamp >= first]
    axes.plot(*_placed(odometry, segment.robot[first]).T, "-", color=ODOMETRY_COLOUR, linewidth=1.0, zorder=1)
    path = np.array(list(segment.robot.values()))
    axes.plot(*path[:, :2].T, "-", color=ROBOT_COLOUR, linewidth=1.2, zorder=2)
    for pose, shape in ((path[0], "^"), (path[-1], "s")):
        axes.plot(*pose[:2], shape, color=ROBOT_COLOUR, markeredgecolor="white", markersize=9, zorder=5)


def _placed(odometry: List[np.ndarray], start: np.ndarray) -> np.ndarray:
    """Positions (N, 2) of odometry, transformed to begin at start (3,)."""
    poses = np.array(odometry)
    turn = start[2] - poses[0, 2]
    c, s = np.cos(turn), np.sin(turn)
    return start[:2] + (poses[:, :2] - poses[0, :2]) @ np.array([[c, s], [-s, c]])


def _draw_landmarks(axes: Axes, landmark_map: "sextant.LandmarkMap") -> None:
    has_names = len(landmark_map.landmarks) <= MAX_NAMES
    at = 3  # row of the covariance; the first three are the robot's
    for landmark, label in zip(landmark_map.landmarks, landmark_map.labels):
        colour = colour_of_class(label.class_name)
        values, axis = np.linalg.eigh(landmark_map.covariance[at : at + 2, at : at + 2])
        at += 2 if landmark.heading is None else 3
        widths = 2 * SIGMAS * np.sqrt(np.maximum(values, 0.0))
        angle = np.degrees(np.arctan2(axis[1, 0], axis[0, 0]))
        ellipse = Ellipse(landmark.position, *widths, angle=angle, facecolor=(*colour, 0.3), edgecolor=colour)
        axes.add_patch(ellipse).set_zorder(3)
        axes.plot(*landmark.position, "o", color=colour, markeredgecolor="black", markersize=6, zorder=4)
        if landmark.heading is not None:
            _draw_heading(axes, landmark.position, landmark.heading, colour)
        if has_names:
            name = label.class_name + ("" if label.id is None else f" {label.id}")
            _draw_name(axes, landmark.position, name)


def _draw_name(axes: Axes, position: np.ndarray, name: str) -> None:
    """Label to the right of the landmark, or to the left near the right edge."""
    low, high = axes.get_xlim()
    x, side = (-6, "right") if position[0] > 0.1 * low + 0.9 * high else (6, "left")
    axes.annotate(name, position, (x, 5), textcoords="offset points", ha=side, fontsize=8, zorder=6)


def _draw_heading(axes: Axes, position: np.ndarray, heading: float, colour) -> None:
    arrow = {"arrowstyle": "-|>", "color": colour, "shrinkA": 0, "shrinkB": 0}
    tip = position + 0.4 * np.array([np.cos(heading), np.sin(heading)])
    axes.annotate("", tip, position, arrowprops=arrow, zorder=4)


def _legend(landmark_map: "sextant.LandmarkMap") -> List[Line2D]:
    counts = Counter(label.class_name for label in landmark_map.labels)
    dot = {"linestyle": "", "markersize": 7}
    classes = [
        Line2D([], [], marker="o", color=colour_of_class(name), markeredgecolor="black",
               label=f"{name} ({count})", **dot)
        for name, count in sorted(counts.items())
    ]  # fmt: skip
    return [
        *classes,
        Line2D([], [], color=ROBOT_COLOUR, label="robot"),
        Line2D([], [], color=ODOMETRY_COLOUR, label="odometry alone"),
        Line2D([], [], marker="^", color=ROBOT_COLOUR, label="start", **dot),
        Line2D([], [], marker="s", color=ROBOT_COLOUR, label="end", **dot),
    ]
