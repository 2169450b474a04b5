# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Evaluation of a place map, or comparison of methods, as one self-contained HTML page."""

from pathlib import Path
from typing import Mapping, NamedTuple, Optional, Sequence

import numpy as np

from sextant.base.html_report import Row, Table, embedded, write_report
from sextant.place_reports.place_evaluation_report import report_lines
from sextant.place_reports.place_predictors import Predictor, predictors
from sextant.places.place_evaluation import PlaceEvaluation

TEMPLATE = """\
{% extends "report" %}
{% from "macros" import table %}
{% block content %}
<h1>{{ title }}</h1>
<p class="note">{{ what }}</p>
{%- if comparison %}
<h2>Comparison</h2>
{{ table(comparison) }}
<p class="note">Each image is localized on its own. Query: extraction of the features, search and
localization of a new photo, median and 95th percentile. Shares: best hypothesis within this distance of the
truth, of the photos that are in the map.</p>
{%- endif %}
{%- for method in methods %}
<h2>{{ method.name }}</h2>
<ul>
{%- for line in method.lines %}
<li>{{ line }}</li>
{%- endfor %}
</ul>
{%- endfor %}
<h2>What predicts a correct answer</h2>
<p class="note">Area under the ROC curve of each quantity: the probability that a correct best hypothesis has
a higher value than a wrong one. ↑ high values predict a correct answer, ↓ low values do; without an arrow the
area is within the 95 % interval of a quantity that predicts nothing. Distances are those of descriptors.</p>
{{ table(predictors) }}
<h2>Plots</h2>
{%- for plot in plots %}
<p><img alt="{{ plot.name }}" src="{{ plot.source }}"></p>
{%- endfor %}
{% endblock %}
"""


class MethodText(NamedTuple):
    """Report of a method."""

    name: str  # heading
    lines: Sequence[str]  # of the report


class PagePlot(NamedTuple):
    """A plot of the page."""

    name: str  # for readers without images
    source: str  # src of an img element


def write_evaluation_page(
    path: Path,
    what: str,
    evaluations: Mapping[str, PlaceEvaluation],
    unit: str,
    plots: Sequence[Path],
    comparison: Optional[Table] = None,
) -> None:
    """Writes the page atomically.

    :param what: map and queries, in words
    :param evaluations: by the name of the method
    :param unit: of position errors
    :param plots: PNG files, which are embedded
    :param comparison: comparison_table()
    :raises OSError: the page cannot be written, or a plot cannot be read
    """
    content = {
        "title": "Places",
        "what": what,
        "comparison": comparison,
        "methods": [MethodText(name, report_lines(each, unit)) for name, each in evaluations.items()],
        "predictors": predictor_table(evaluations),
        "plots": [PagePlot(plot.stem, embedded(plot.read_bytes())) for plot in plots],
    }
    write_report(path, TEMPLATE, content)


def predictor_table(evaluations: Mapping[str, PlaceEvaluation]) -> Table:
    """Areas under the ROC curve: a row per quantity of predictors(), a column per method."""
    columns = [predictors(evaluation) for evaluation in evaluations.values()]
    firsts = [column[0] for column in columns]
    answers = [f"{len(each.right)}, {len(each.wrong)}" for each in firsts]
    rows = [Row(("correct, wrong", *answers)), Row(("area by chance", *map(_chance, firsts)))]
    for row in zip(*columns):
        name = row[0].name.replace("_", " ")
        rows.append(Row((name, *map(_area, row)), highlighted=any(each.direction for each in row)))
    return Table(("quantity", *evaluations), rows)


def _chance(predictor: Predictor) -> str:
    low, high = predictor.chance
    return "–" if np.isnan(predictor.area) else f"{low:.2f} to {high:.2f}"


def _area(predictor: Predictor) -> str:
    arrow = {-1: " ↓", 0: "", 1: " ↑"}[predictor.direction]
    return "–" if np.isnan(predictor.area) else f"{predictor.area:.2f}{arrow}"
