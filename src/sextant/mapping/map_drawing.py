# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws a marker map from above."""

from typing import Dict, List, Tuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import Collection, EllipseCollection, LineCollection
from matplotlib.lines import Line2D

from sextant.base.plot_colours import COLOURS
from sextant.mapping.label_placement import place_labels
from sextant.mapping.map_findings import list_findings
from sextant.mapping.map_links import Key
from sextant.mapping.map_quality import MapQuality

LINK, WEAK, ANCHOR, CONFLICTING, ELLIPSE = COLOURS[5], COLOURS[1], COLOURS[2], COLOURS[3], COLOURS[0]
MARGIN = 0.06  # fraction of the larger extent, at least 0.5 m
WIDTH, MIN_HEIGHT, MAX_HEIGHT = 12.0, 3.0, 9.0  # of the axes, inches
LEFT, RIGHT, BELOW = 0.75, 0.2, 0.6  # margins of the axes, inches
LEGEND = 7  # maximum number of entries
LEGEND_WIDTH, LEGEND_HEIGHT = 3.0, 0.24  # of an entry, inches
BOARD = 0.011  # minimum length of a marker's line, extents: 20 cm are invisible in a building of 60 m
NORMAL = 0.009  # length of a marker's normal, extents
MAX_ELLIPSE = 0.03  # semi-axis, extents
FACTORS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)  # exaggeration of the ellipses
PATH_GAP = 1.0  # m between two images, beyond which no path is drawn
# Name of the argument; the second one until Matplotlib 3.4
OFFSET_TRANSFORM = "offset_transform" if hasattr(Collection, "set_offset_transform") else "transOffset"
UPRIGHT = 0.3  # minimum horizontal part of the normal of a marker that is drawn as a line


class MapPlan:
    """Lays out and draws a map from above; x to the right, y up, metres."""

    def __init__(self, result, quality: MapQuality):
        """:param result: sextant.MappingResult with one marker or more"""
        self._quality = quality
        self._markers = {(each.family, each.id): each for each in result.map.markers}
        self._at = {key: each.T_map_marker[:2, 3] for key, each in self._markers.items()}
        self._path = _path(result.T_map_base)
        self._arrows = self._find_arrows()
        self._low, self._high = self._limits()
        self._extent = float(max(self._high - self._low))
        width, height = self._high - self._low
        scale = min(WIDTH / width, MAX_HEIGHT / height)
        inner = np.array([max(scale * width, 0.5 * WIDTH), max(scale * height, MIN_HEIGHT)])
        self._columns = int(inner[0] / LEGEND_WIDTH)
        above = LEGEND_HEIGHT * (1 + -(-LEGEND // self._columns))
        self.figure_size = tuple(inner + [LEFT + RIGHT, BELOW + above])  # inches
        w, h = self.figure_size
        self.axes_place = (LEFT / w, BELOW / h, inner[0] / w, inner[1] / h)  # fractions of the figure

    def _find_arrows(self) -> List[Tuple[Key, np.ndarray, np.ndarray]]:
        """Returns (key, from, to) of markers with a wrong entry or conflicting poses."""
        wrong = [
            (each.key, each.known_position[:2], (each.known_position + each.offset)[:2])
            for each in self._quality.wrong
        ]
        conflicting = [(each.key, each.place[:2], each.position[:2]) for each in self._quality.conflicting]
        return wrong + conflicting

    def _limits(self) -> Tuple[np.ndarray, np.ndarray]:
        """Returns the corners of the map and the path near it; outliers of the path do not enlarge them."""
        points = [*self._at.values(), *(point for _, *ends in self._arrows for point in ends)]
        low, high = np.min(points, axis=0), np.max(points, axis=0)
        around = 0.3 * max(*(high - low), 1.0)
        near = [p for p in self._path if np.all(p > low - around) and np.all(p < high + around)]
        low, high = np.min([low, *near], axis=0), np.max([high, *near], axis=0)
        margin = max(0.5, MARGIN * max(high - low))
        return low - margin, high + margin

    def draw(self, axes: Axes) -> None:
        """Draws the map."""
        axes.set_xlim(self._low[0], self._high[0])
        axes.set_ylim(self._low[1], self._high[1])
        axes.set(xlabel="x, m", ylabel="y, m", aspect="equal")
        axes.grid(alpha=0.25, zorder=0)
        self._draw_links(axes)
        axes.plot(*self._path.T, "-", color="#888888", linewidth=0.8, alpha=0.7, zorder=2)
        factor = self._draw_ellipses(axes)
        self._draw_boards(axes)
        self._draw_arrows(axes)
        self._draw_names(axes)
        axes.legend(
            handles=_legend(factor, bool(self._arrows)),
            loc="lower left",
            bbox_to_anchor=(0.0, 1.0),
            ncol=self._columns,
            frameon=False,
            borderaxespad=0.2,
        )

    def _draw_links(self, axes: Axes) -> None:
        weak = {frozenset(pair) for cut in self._quality.weak for pair in cut.links}
        firm, loose = [], []
        for pair, images in self._quality.links.items():
            (loose if frozenset(pair) in weak else firm).append((pair, images))
        for links, colour, style, alpha in ((firm, LINK, "-", 0.45), (loose, WEAK, "--", 0.9)):
            lines = [[self._at[a], self._at[b]] for (a, b), _ in links]
            widths = [0.35 * np.log2(1 + images) + (0.8 if colour == WEAK else 0.0) for _, images in links]
            shown = LineCollection(
                lines, linewidths=widths, colors=colour, linestyles=style, alpha=alpha, zorder=1
            )
            axes.add_collection(shown)

    def _draw_ellipses(self, axes: Axes) -> int:
        """Draws three standard deviations, exaggerated; returns the factor."""
        shapes = [np.linalg.eigh(each.covariance[:2, :2]) for each in self._markers.values()]
        axes_of = np.array([3.0 * np.sqrt(np.maximum(values, 0.0)) for values, _ in shapes])
        largest = max(float(axes_of.max()), 1e-9)
        factor = max(each for each in FACTORS if each == 1 or each * largest <= MAX_ELLIPSE * self._extent)
        # eigenvalues of eigh() ascend
        angles = [np.degrees(np.arctan2(vectors[1, 1], vectors[0, 1])) for _, vectors in shapes]
        ellipses = EllipseCollection(
            2 * factor * axes_of[:, 1],
            2 * factor * axes_of[:, 0],
            angles,
            units="xy",
            offsets=list(self._at.values()),
            **{OFFSET_TRANSFORM: axes.transData},
            facecolors=ELLIPSE,
            alpha=0.3,
            zorder=3,
        )
        axes.add_collection(ellipses)
        return factor

    def _draw_boards(self, axes: Axes) -> None:
        anchors = {marker.key for marker in self._quality.markers if marker.is_anchor}
        for key in self._markers:
            colour = ANCHOR if key in anchors else "black"
            outline = self._outline(key)
            if len(outline) == 1:
                axes.plot(*outline.T, "s", color=colour, markersize=5, fillstyle="none", zorder=5)
                continue
            left, at, right, front = outline
            axes.plot(*np.c_[left, right], color=colour, linewidth=4, solid_capstyle="butt", zorder=5)
            axes.plot(*np.c_[at, front], color=colour, linewidth=1.2, zorder=5)

    def _outline(self, key: Key) -> np.ndarray:
        """Returns (4, 2) left end, centre, right end, tip of the normal; (1, 2) of a horizontal marker."""
        at, normal = self._at[key], self._normal(key)
        if np.linalg.norm(normal) < UPRIGHT:  # on the floor or ceiling
            return at[None]
        normal = normal / np.linalg.norm(normal)
        half = 0.5 * max(self._markers[key].size, BOARD * self._extent) * np.array([-normal[1], normal[0]])
        return np.array([at - half, at, at + half, at + NORMAL * self._extent * normal])

    def _normal(self, key: Key) -> np.ndarray:
        """Returns the (2,) horizontal part of the unit normal."""
        return self._markers[key].T_map_marker[:2, 2]

    def _draw_arrows(self, axes: Axes) -> None:
        for _, start, end in self._arrows:
            axes.plot(*end, "X", color=CONFLICTING, markersize=7, zorder=6)
            if np.linalg.norm(end - start) > 1e-3:
                axes.plot(*start, "x", color=CONFLICTING, markersize=6, zorder=6)
                arrow = dict(arrowstyle="->", color=CONFLICTING, linewidth=1.5)
                axes.annotate("", end, start, arrowprops=arrow, zorder=6)

    def _draw_names(self, axes: Axes) -> None:
        """Draws the names behind the boards; bold if the report has a finding."""
        named = {key for finding in list_findings(self._quality) for key in finding.keys}
        wanted = {key: (self._at[key], -self._normal(key)) for key in self._at}
        drawn = np.concatenate([self._outline(key) for key in wanted])
        texts: Dict[Key, str] = {key: self._quality.name(key) for key in wanted}
        size = 9 if len(wanted) <= 40 else 7
        for key, offset in place_labels(axes, wanted, texts, size, drawn).items():
            axes.annotate(
                texts[key],
                wanted[key][0],
                offset,
                textcoords="offset points",
                ha="center",
                va="center",
                fontsize=size,
                weight="bold" if key in named else "normal",
                color=WEAK if key in named else "black",
                annotation_clip=True,
                zorder=7,
            )


def _path(poses) -> np.ndarray:
    """Returns (N, 2) positions of the base, metres, with NaN rows at jumps."""
    points: List[np.ndarray] = []
    for pose in poses:
        if pose is None:
            continue
        if points and np.linalg.norm(pose[:2, 3] - points[-1]) > PATH_GAP:
            points.append(np.full(2, np.nan))
        points.append(pose[:2, 3])
    return np.array(points).reshape(-1, 2)


def _legend(factor: int, arrows: bool) -> List[Line2D]:
    times = f", drawn {factor} times as large" if factor > 1 else ""
    shown = [
        Line2D([], [], color="black", linewidth=4, label="marker and its normal"),
        Line2D([], [], color=ANCHOR, linewidth=4, label="defines the frame"),
        Line2D(
            [], [], color=ELLIPSE, alpha=0.3, linestyle="", marker="o", markersize=10, label=f"3 sigma{times}"
        ),
        Line2D([], [], color="#888888", linewidth=0.8, label="path of the base"),
        Line2D([], [], color=LINK, linewidth=2, label="in one image; thick: in many"),
        Line2D([], [], color=WEAK, linewidth=2, linestyle="--", label="weak link"),
    ]
    if arrows:
        shown.append(
            Line2D([], [], color=CONFLICTING, linestyle="-", marker="X", label="moved or wrong: from x to X")
        )
    return shown
