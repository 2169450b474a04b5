# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Accuracy report of pose series as one self-contained HTML page; errors in centimetres and degrees."""

from pathlib import Path
from typing import Dict, List, Sequence, Union

import numpy as np

from sextant.base.html_report import PagePlot, Row, Table, embedded, write_report
from sextant.evaluation.error_statistics import (
    ALL,
    QUANTITIES,
    QUANTITY_UNITS,
    ErrorStatistics,
    error_statistics,
    overall,
    share_text,
)
from sextant.evaluation.pose_series import AXES, POINT, UNITS, PoseSeries, SeriesStatistics

SHOWN = {"m": (100.0, "cm"), "rad": (180.0 / np.pi, "°")}  # factor and unit of errors
HEADS = ("mean", "deviation", "95 %", "worst")
POSITION_HEADS = tuple(f"{name}, cm" for name in HEADS)
MISSING = "–"

TEMPLATE = """\
{% extends "report" %}
{% from "macros" import table %}
{% block content %}
<h1>Accuracy</h1>
{%- for line in verdict %}
<p class="verdict">{{ line }}</p>
{%- endfor %}
<h2>All {{ places }}</h2>
<p class="note">Errors of the position over all poses: mean, standard deviation, 95th percentile, maximum.
Images without a pose have no error: read both columns.</p>
{{ table(together) }}
<p class="note">Errors by axis. The mean has a sign: estimate minus truth; 95 % and worst are absolute.</p>
{{ table(together_axes) }}
<h2>Plots</h2>
{%- for plot in plots %}
<p><img alt="{{ plot.name }}" src="{{ plot.source }}"></p>
{%- endfor %}
<h2>By {{ place }}</h2>
{{ table(by_place) }}
<details>
<summary>By {{ place }} and axis</summary>
{{ table(by_place_axes) }}
</details>
<h2>Poses</h2>
<p class="note">True poses and means of the estimates; x, y, z in metres; roll, pitch, yaw in degrees.</p>
{{ table(poses) }}
<h2>Bags</h2>
<p class="note">Stale: left out, stamped before the bag began. Invalid: left out, not a pose.</p>
{{ table(bags) }}
{%- for note in notes %}
<p class="note">{{ note }}</p>
{%- endfor %}
{% endblock %}
"""


def write_page(
    path: Union[str, Path],
    series: Sequence[PoseSeries],
    statistics: Sequence[SeriesStatistics],
    plots: Sequence[Path],
    notes: Sequence[str] = (),
) -> None:
    """Writes the page atomically.

    :param series: the result of by_distance(), not empty
    :param statistics: those of each series, in the same order
    :param plots: PNG files, which are embedded
    :param notes: paragraphs at the end
    :raises OSError: the page cannot be written, or a plot cannot be read
    """
    place = POINT if statistics[0].axis == POINT else "distance"
    errors = error_statistics(statistics)
    content = {
        "title": "Accuracy",
        "verdict": [_verdict(each) for each in overall(errors)],
        "place": place,
        "places": f"{place}s",
        "together": _position_table(overall(errors)),
        "together_axes": _axis_table(overall(errors), with_place=False),
        "plots": [PagePlot(plot.stem.rpartition("_")[2], embedded(plot.read_bytes())) for plot in plots],
        "by_place": _side_by_side(errors),
        "by_place_axes": _axis_table(errors),
        "poses": _pose_table(statistics),
        "bags": _bag_table(series, statistics),
        "notes": notes,
    }
    write_report(path, TEMPLATE, content)


def _verdict(of: ErrorStatistics) -> str:
    name = f"{of.method}: " if of.method else ""
    if np.isnan(of.mean[0]):
        return f"{name}{share_text(of)}; the true position is unknown, or there is no pose."
    return (
        f"{name}{100.0 * of.mean[0]:.1f} cm mean error, 95 % below {100.0 * of.p95[0]:.1f} cm,"
        f" worst {100.0 * of.worst[0]:.1f} cm; images with a pose: {share_text(of)}."
    )


def _position_table(errors: Sequence[ErrorStatistics]) -> Table:
    rows = [Row((each.method or ALL, share_text(each), *_cells(each, 0))) for each in errors]
    return Table(("", "images with a pose", *POSITION_HEADS), rows)


def _side_by_side(errors: Sequence[ErrorStatistics]) -> Table:
    """One row per place, the methods beside one another."""
    heads = [""]
    for method in dict.fromkeys(each.method for each in errors):
        heads += [f"{method} {name}".strip() for name in ("with a pose, %", *POSITION_HEADS)]
    cells: Dict[str, List[str]] = {each.place: [each.place] for each in errors}
    for each in errors:
        cells[each.place] += [_number(100.0 * each.share, 1), *_cells(each, 0)]
    return Table(tuple(heads), [Row(tuple(row)) for row in cells.values()])


def _axis_table(errors: Sequence[ErrorStatistics], with_place: bool = True) -> Table:
    """One row per axis whose true value is known."""
    rows = []
    for each in errors:
        for index in range(1, len(QUANTITIES)):
            if each.poses and np.isnan(each.mean[index]):
                continue
            unit = SHOWN[QUANTITY_UNITS[index]][1]
            name = each.label if with_place else each.method or ALL
            rows.append(Row((name, QUANTITIES[index], unit, *_cells(each, index))))
    return Table(("", "axis", "unit", *HEADS), rows, (0, 1, 2))


def _cells(of: ErrorStatistics, index: int) -> List[str]:
    factor, _ = SHOWN[QUANTITY_UNITS[index]]
    return [_number(factor * each[index], 2) for each in (of.mean, of.std, of.p95, of.worst)]


def _pose_table(statistics: Sequence[SeriesStatistics]) -> Table:
    rows = []
    for place in dict.fromkeys(each.place for each in statistics):
        here = [each for each in statistics if each.place == place]
        rows.append(Row((place, "truth", *_pose_cells(here[0].truth)), highlighted=True))
        rows += [Row((place, each.method or "mean", *_pose_cells(each.mean))) for each in here]
    return Table(("", "", *AXES), rows, (0, 1))


def _pose_cells(pose: np.ndarray) -> List[str]:
    degrees = [1.0 if unit == "m" else 180.0 / np.pi for unit in UNITS]
    return [_number(value * factor, 3 if factor == 1.0 else 2) for value, factor in zip(pose, degrees)]


def _bag_table(series: Sequence[PoseSeries], statistics: Sequence[SeriesStatistics]) -> Table:
    rows = []
    for of, its in zip(series, statistics):
        for bag in of.counts:
            counts = (bag.images, bag.poses, bag.stale, bag.invalid)
            rows.append(Row((its.label, bag.bag, *(MISSING if n is None else str(n) for n in counts))))
    return Table(("", "bag", "images", "poses", "stale", "invalid"), rows, (0, 1))


def _number(value: float, digits: int) -> str:
    return MISSING if np.isnan(value) else f"{round(value, digits) + 0.0:.{digits}f}"  # without -0.00
