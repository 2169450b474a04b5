# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A marker map drawn from above."""

from typing import Dict, List, Tuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.lines import Line2D

from sextant.base.plot_colours import COLOURS
from sextant.mapping.map_findings import list_findings
from sextant.mapping.map_labels import place_labels
from sextant.mapping.map_links import Key
from sextant.mapping.map_quality import MapQuality

LINK, WEAK, HELD, ELSEWHERE, ELLIPSE = COLOURS[5], COLOURS[1], COLOURS[2], COLOURS[3], COLOURS[0]
MARGIN = 0.06  # of the larger extent, and at least 0.5 m
WIDTH, LEAST_HEIGHT, GREATEST_HEIGHT = 12.0, 3.0, 9.0  # inches of the drawing itself
LEFT, RIGHT, BELOW = 0.75, 0.2, 0.6  # inches around it
LEGEND = 7  # entries at most, above the drawing
LEGEND_WIDTH, LEGEND_HEIGHT = 3.0, 0.24  # inches of an entry
BOARD = 0.011  # least length of a marker's line in extents: 20 cm cannot be seen in a building of 60 m
NORMAL = 0.009
LARGEST_ELLIPSE = 0.03  # semi-axis in extents
FACTORS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
JUMP = 1.0  # m between two images; the path is not drawn through walls
UPRIGHT = 0.3  # least horizontal part of a normal that has a direction in the plan


class MapPlan:
    """Lays out and draws a map seen from above; x to the right, y up, metres."""

    def __init__(self, made, quality: MapQuality):
        """:param made: sextant.MadeMap with one marker or more"""
        self._quality = quality
        self._markers = {(each.family, each.id): each for each in made.map.markers}
        self._at = {key: each.T_map_marker[:2, 3] for key, each in self._markers.items()}
        self._path = _path(made.T_map_base)
        self._arrows = self._find_arrows()
        self._low, self._high = self._limits()
        self._extent = float(max(self._high - self._low))
        width, height = self._high - self._low
        scale = min(WIDTH / width, GREATEST_HEIGHT / height)
        inner = np.array([max(scale * width, 0.5 * WIDTH), max(scale * height, LEAST_HEIGHT)])
        self._columns = int(inner[0] / LEGEND_WIDTH)
        above = LEGEND_HEIGHT * (1 + -(-LEGEND // self._columns))
        self.figure_size = tuple(inner + [LEFT + RIGHT, BELOW + above])  # inches
        w, h = self.figure_size
        self.axes_place = (LEFT / w, BELOW / h, inner[0] / w, inner[1] / h)  # of the figure

    def _find_arrows(self) -> List[Tuple[Key, np.ndarray, np.ndarray]]:
        """(key, from, to) of markers that are not where they were taken to be."""
        wrong = [
            (each.key, each.known_position[:2], (each.known_position + each.offset)[:2])
            for each in self._quality.wrong
        ]
        elsewhere = [(each.key, each.place[:2], each.position[:2]) for each in self._quality.elsewhere]
        return wrong + elsewhere

    def _limits(self) -> Tuple[np.ndarray, np.ndarray]:
        """The map decides, and the path near it: one wild pose does not shrink it to a dot."""
        points = [*self._at.values(), *(point for _, *ends in self._arrows for point in ends)]
        low, high = np.min(points, axis=0), np.max(points, axis=0)
        around = 0.3 * max(*(high - low), 1.0)
        near = [p for p in self._path if np.all(p > low - around) and np.all(p < high + around)]
        low, high = np.min([low, *near], axis=0), np.max([high, *near], axis=0)
        margin = max(0.5, MARGIN * max(high - low))
        return low - margin, high + margin

    def draw(self, axes: Axes) -> None:
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
        """Three standard deviations, exaggerated. :returns: how much"""
        shapes = [np.linalg.eigh(each.covariance[:2, :2]) for each in self._markers.values()]
        axes_of = np.array([3.0 * np.sqrt(np.maximum(values, 0.0)) for values, _ in shapes])
        largest = max(float(axes_of.max()), 1e-9)
        factor = max(
            each for each in FACTORS if each == 1 or each * largest <= LARGEST_ELLIPSE * self._extent
        )
        # eigh() gives the smaller one first
        angles = [np.degrees(np.arctan2(vectors[1, 1], vectors[0, 1])) for _, vectors in shapes]
        ellipses = EllipseCollection(
            2 * factor * axes_of[:, 1],
            2 * factor * axes_of[:, 0],
            angles,
            units="xy",
            offsets=list(self._at.values()),
            offset_transform=axes.transData,
            facecolors=ELLIPSE,
            alpha=0.3,
            zorder=3,
        )
        axes.add_collection(ellipses)
        return factor

    def _draw_boards(self, axes: Axes) -> None:
        holds = {marker.key for marker in self._quality.markers if marker.holds}
        for key in self._markers:
            colour = HELD if key in holds else "black"
            outline = self._outline(key)
            if len(outline) == 1:
                axes.plot(*outline.T, "s", color=colour, markersize=5, fillstyle="none", zorder=5)
                continue
            left, at, right, front = outline
            axes.plot(*np.c_[left, right], color=colour, linewidth=4, solid_capstyle="butt", zorder=5)
            axes.plot(*np.c_[at, front], color=colour, linewidth=1.2, zorder=5)

    def _outline(self, key: Key) -> np.ndarray:
        """(4, 2) one end of its board, middle, other end, where its stroke ends; (1, 2) if it lies flat."""
        at, normal = self._at[key], self._normal(key)
        if np.linalg.norm(normal) < UPRIGHT:  # on the floor or under the ceiling
            return at[None]
        normal = normal / np.linalg.norm(normal)
        half = 0.5 * max(self._markers[key].size, BOARD * self._extent) * np.array([-normal[1], normal[0]])
        return np.array([at - half, at, at + half, at + NORMAL * self._extent * normal])

    def _normal(self, key: Key) -> np.ndarray:
        """(2) where it looks, shorter than 1 unless it is upright."""
        return self._markers[key].T_map_marker[:2, 2]

    def _draw_arrows(self, axes: Axes) -> None:
        for _, start, end in self._arrows:
            axes.plot(*end, "X", color=ELSEWHERE, markersize=7, zorder=6)
            if np.linalg.norm(end - start) > 1e-3:
                axes.plot(*start, "x", color=ELSEWHERE, markersize=6, zorder=6)
                axes.annotate(
                    "", end, start, arrowprops=dict(arrowstyle="->", color=ELSEWHERE, linewidth=1.5), zorder=6
                )

    def _draw_names(self, axes: Axes) -> None:
        """Behind the boards, where nobody looks; bold for those that are named in the report."""
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
    """(N, 2) positions of the base, metres; not a number between two that no drive connects."""
    points: List[np.ndarray] = []
    for pose in poses:
        if pose is None:
            continue
        if points and np.linalg.norm(pose[:2, 3] - points[-1]) > JUMP:
            points.append(np.full(2, np.nan))
        points.append(pose[:2, 3])
    return np.array(points).reshape(-1, 2)


def _legend(factor: int, arrows: bool) -> List[Line2D]:
    times = f", drawn {factor} times as large" if factor > 1 else ""
    shown = [
        Line2D([], [], color="black", linewidth=4, label="marker, and where it looks"),
        Line2D([], [], color=HELD, linewidth=4, label="holds the frame"),
        Line2D(
            [], [], color=ELLIPSE, alpha=0.3, linestyle="", marker="o", markersize=10, label=f"3 sigma{times}"
        ),
        Line2D([], [], color="#888888", linewidth=0.8, label="path of the base"),
        Line2D([], [], color=LINK, linewidth=2, label="in one image; wide: in many"),
        Line2D([], [], color=WEAK, linewidth=2, linestyle="--", label="weak link"),
    ]
    if arrows:
        shown.append(
            Line2D([], [], color=ELSEWHERE, linestyle="-", marker="X", label="moved or wrong: from x to X")
        )
    return shown
