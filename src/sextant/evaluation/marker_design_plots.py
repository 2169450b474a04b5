# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Heat maps of a sweep of marker_design. A field shows the worst of the combinations that it stands for.

Errors within the target are bold; `none`: too few images with a pose; white: the markers do not fit into the
image.
"""

from pathlib import Path
from typing import Callable, Dict, List, NamedTuple, Sequence, Tuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize

from sextant.base.plot_file import new_figure, save_figure
from sextant.evaluation.marker_design import QUANTILE, CellResult, Setup, Target
from sextant.evaluation.marker_design_report import in_view_text, values_of

FIELD = (0.5, 0.3)  # inches
NONE = "#444444"  # background of a field without a pose

Results = Sequence[CellResult]


class Quantity(NamedTuple):
    """A figure of the results, and how it is drawn."""

    title: str  # with its unit
    value: Callable[[CellResult], float]  # in this unit
    worst: Callable[[List[float]], float]  # max or min
    norm: Normalize  # range of the colours
    colours: str  # name of the colour map
    good: float = -np.inf  # values up to it are bold
    partial: bool = True  # shown even if a part of the combinations does not fit into the image


class Column(NamedTuple):
    """Panels of one figure."""

    name: str  # in the titles of the panels
    results: Results  # what they show
    quantity: Quantity  # the figure


class Axis(NamedTuple):
    """Values along an axis of a heat map."""

    label: str  # with its unit
    value: Callable[[CellResult], float]  # by which the results are sorted into fields


DISTANCE = Axis("distance, m", lambda each: each.cell.distance)
SIZE = Axis("edge length, m", lambda each: each.cell.size)
ANGLE = Axis("angle, degrees", lambda each: each.cell.angle)
NOISE = Axis("noise, grey levels", lambda each: each.cell.setup.noise)
LIGHT = Axis("light, grey levels", lambda each: each.cell.setup.light)

DETECTED = Quantity(
    "markers detected, %", lambda each: 100.0 * each.detected, min, Normalize(0.0, 100.0), "cividis"
)


def error_of(target: Target) -> Quantity:
    """Returns the position error in centimetres."""
    title = f"{100 * QUANTILE:g} % position error, cm"
    good = 100.0 * target.error
    return Quantity(
        title, lambda each: 100.0 * each.error, max, LogNorm(0.1, 100.0), "cividis_r", good, False
    )


def cpu_of(results: Results) -> Quantity:
    """Returns the CPU time; its colours span the results."""
    times = [1e3 * each.cpu for each in results if each.images] or [1.0]
    norm = Normalize(0.0, 1.5 * max(times))
    return Quantity("CPU per image, ms", lambda each: 1e3 * each.cpu, max, norm, "cividis_r")


def plot_setup(path: Path, results: Results, setup: Setup, title: str, target: Target) -> None:
    """Draws all figures of a setup: size over distance, and below, for each size, angle over distance.

    :param path: of the PNG file
    :raises OSError: the file cannot be written; an existing one is unchanged
    """
    own = [each for each in results if each.cell.setup == setup]
    columns = [*_errors(own, target), Column("", own, DETECTED), Column("", own, cpu_of(own))]
    rows = [("worst angle", SIZE, lambda part: part)]
    for size in values_of(own, "size"):
        rows.append((f"{size:g} m", ANGLE, lambda part, size=size: [r for r in part if r.cell.size == size]))
    heights = [len({axis.value(each) for each in own}) for _, axis, _ in rows]
    figure, panels = _figure(path, title, len(columns), heights, len(values_of(own, "distance")))
    for row, (name, y, chosen) in zip(panels, rows):
        for axes, column in zip(row, columns):
            _draw(axes, chosen(column.results), (DISTANCE, y), column.quantity)
            below = ", ".join(filter(None, [column.name, name]))
            axes.set_title(f"{column.quantity.title}\n{below}", fontsize="small")
    save_figure(path, figure)


def plot_conditions(path: Path, results: Results, title: str, target: Target) -> None:
    """Draws the position error at the target's distance, light over noise, for each size and number in view.

    :param results: of one resolution and family
    :param path: of the PNG file
    :raises OSError: the file cannot be written; an existing one is unchanged
    """
    there = [each for each in results if each.cell.distance == target.distance]
    sizes, counts = values_of(there, "size"), _errors(there, target)
    heights = [len({LIGHT.value(each) for each in there})] * len(counts)
    figure, panels = _figure(path, title, len(sizes), heights, len({NOISE.value(each) for each in there}))
    for row, count in zip(panels, counts):
        for axes, size in zip(row, sizes):
            of_size = [each for each in count.results if each.cell.size == size]
            _draw(axes, of_size, (NOISE, LIGHT), count.quantity)
            axes.set_title(f"{size:g} m, {count.name}", fontsize="small")
    save_figure(path, figure)


def _errors(results: Results, target: Target) -> List[Column]:
    """Returns the position error for every number in view."""
    return [
        Column(in_view_text(n), [each for each in results if each.cell.in_view == n], error_of(target))
        for n in values_of(results, "in_view")
    ]


def _figure(path: Path, title: str, columns: int, heights: List[int], fields: int):
    """Returns a figure and its panels, an array of axes.

    :param heights: number of fields of each row of panels
    :param fields: number of fields across a panel
    """
    heights = [max(each, 2) for each in heights]  # for the label of the axis
    width = columns * (max(fields, 4) * FIELD[0] + 0.9)
    height = sum(heights) * FIELD[1] + 1.0 * len(heights) + 0.5
    figure = new_figure(path, width, height, constrained_layout=True)
    figure.suptitle(title, fontsize="medium")
    grid = {"height_ratios": heights}
    return figure, figure.subplots(len(heights), columns, squeeze=False, gridspec_kw=grid)


def _draw(axes: Axes, results: Results, axis: Sequence[Axis], quantity: Quantity) -> None:
    fields = _fields(results, axis)
    x, y = map(sorted, map(set, zip(*fields)))
    for (of_x, of_y), field in fields.items():
        seen = [each for each in field if each.images]
        if seen and (quantity.partial or len(seen) == len(field)):
            worst = quantity.worst(list(map(quantity.value, seen)))
            _draw_field(axes, (x.index(of_x), y.index(of_y)), quantity, worst)
    axes.set(xlim=(-0.5, len(x) - 0.5), ylim=(-0.5, len(y) - 0.5), xticks=range(len(x)), yticks=range(len(y)))
    axes.set_xlabel(axis[0].label, fontsize="small")
    axes.set_ylabel(axis[1].label, fontsize="small")
    axes.set_xticklabels([f"{each:g}" for each in x], fontsize="small")
    axes.set_yticklabels([f"{each:g}" for each in y], fontsize="small")


def _fields(results: Results, axis: Sequence[Axis]) -> Dict[Tuple[float, float], List[CellResult]]:
    """Returns the results by their values along both axes."""
    fields: Dict[Tuple[float, float], List[CellResult]] = {}
    for each in results:
        fields.setdefault((axis[0].value(each), axis[1].value(each)), []).append(each)
    return fields


def _draw_field(axes: Axes, place: Sequence[int], quantity: Quantity, value: float) -> None:
    x, y = place
    colours = ScalarMappable(quantity.norm, quantity.colours)
    colour = colours.to_rgba(value) if np.isfinite(value) else NONE
    axes.fill([x - 0.5, x + 0.5, x + 0.5, x - 0.5], [y - 0.5, y - 0.5, y + 0.5, y + 0.5], color=colour)
    dark = not np.isfinite(value) or np.dot(colour[:3], [0.3, 0.6, 0.1]) < 0.5
    style = {"weight": "bold"} if value <= quantity.good else {}
    text = "none" if np.isinf(value) else f"{value:.2g}" if value < 99.5 else f"{value:.0f}"
    axes.text(x, y, text, ha="center", va="center", fontsize=7, color="white" if dark else "black", **style)
