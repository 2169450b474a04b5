# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Report on a new landmark map: one self-contained HTML file."""

from pathlib import Path
from typing import Dict, List, Mapping, Sequence, Union

import numpy as np

from sextant.base.findings import Finding
from sextant.base.html_report import Row, Table, embedded, write_report
from sextant.landmarks.landmark_drawing import plot_png
from sextant.landmarks.landmark_findings import list_findings, scatter, spread, verdict
from sextant.landmarks.slam_run import LandmarkResult
from sextant.landmarks.slam_summary import position_sigmas

TEMPLATE = """\
{% extends "report" %}
{% from "macros" import findings_list, table %}
{% block content %}
<h1>Landmark map</h1>
<p class="verdict">{{ verdict }}</p>
{{ findings_list(findings) }}
{%- if warnings %}
<h2>Warnings</h2>
<ul class="findings">
{%- for warning in warnings %}
<li>{{ warning }}</li>
{%- endfor %}
</ul>
{%- endif %}
<h2>Top view</h2>
<p class="note">Ellipses are two standard deviations.</p>
<img alt="the map from above" src="{{ plan }}">
<h2>Landmarks</h2>
<p class="note">The standard deviation is that of the position along its worst axis, in the map frame.
Detected: the share of the scans with this landmark in view that observed it. Scatter: residuals of the
observations over the standard deviations that the sensor states, without the worst tenth; about 1 is
expected.</p>
{{ table(landmarks) }}
<h2>How the map was made</h2>
<ul>
{%- for line in summary %}
<li>{{ line }}</li>
{%- endfor %}
</ul>
{{ table(origin) }}
{% endblock %}
"""
HEADS = (
    "landmark",
    "remarks",
    "x, m",
    "y, m",
    "standard deviation, m",
    "observations",
    "detected, %",
    "scatter",
    "directions, deg",
    "first, s",
    "last, s",
)


def write_landmark_report(
    path: Union[str, Path],
    result: LandmarkResult,
    summary: Sequence[str],
    warnings: Sequence[str],
    origin: Mapping[str, object],
) -> None:
    """Writes the report atomically.

    :param result: of batch_map()
    :param summary, warnings: lines of slam_summary
    :param origin: bags and options of the command, by name
    :raises OSError: the file cannot be written
    """
    origin_rows = [Row((name, str(value))) for name, value in origin.items()]
    content: Dict[str, object] = {
        "title": "Landmark map",
        "verdict": verdict(result),
        "findings": list_findings(result),
        "warnings": warnings,
        "plan": embedded(plot_png(result)),
        "landmarks": _landmark_table(result),
        "summary": summary,
        "origin": Table(("what", "value"), origin_rows, (0, 1)),
    }
    write_report(path, TEMPLATE, content)


def _landmark_table(result: LandmarkResult) -> Table:
    findings, sigmas = list_findings(result), position_sigmas(result.map)
    begin = min((each.stamps.min() for each in result.sightings if len(each.stamps)), default=0.0)
    order = sorted(range(len(sigmas)), key=lambda i: (*_sort_key(result, i), i))
    return Table(HEADS, [_row(result, index, sigmas[index], findings, begin) for index in order], (0, 1))


def _sort_key(result: LandmarkResult, index: int):
    label = result.map.labels[index]
    return label.class_name, -1 if label.id is None else label.id


def _row(result: LandmarkResult, index: int, sigma: float, findings: List[Finding], begin: float) -> Row:
    label, (x, y) = result.map.labels[index], result.map.landmarks[index].position
    remarks = [finding.word for finding in findings if index in finding.keys]
    name = label.class_name + ("" if label.id is None else f" {label.id}")
    cells = (name, "; ".join(remarks), f"{x:.3f}", f"{y:.3f}", f"{sigma:.3f}")
    return Row((*cells, *_sighting_cells(result, index, begin)), highlighted=bool(remarks))


def _sighting_cells(result: LandmarkResult, index: int, begin: float) -> Sequence[str]:
    of = result.sightings[index]
    if not len(of.stamps):
        return ("0", *[""] * 5)
    return (
        str(len(of.stamps)),
        f"{100 * of.detection:.0f}",
        f"{scatter(of):.2f}",
        f"{np.degrees(spread(of.directions)):.0f}",
        f"{of.stamps.min() - begin:.0f}",
        f"{of.stamps.max() - begin:.0f}",
    )
