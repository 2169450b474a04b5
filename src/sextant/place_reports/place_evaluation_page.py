# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Evaluation of a place map, or comparison of methods, as one self-contained HTML page."""

from pathlib import Path
from typing import Mapping, Optional, Sequence

import numpy as np

from sextant.base.html_report import PagePlot, Row, Table, embedded, write_report
from sextant.place_reports.place_predictors import Predictor, predictors
from sextant.places.place_evaluation import RANKS, PlaceEvaluation

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
<h2>Figures</h2>
{{ table(figures) }}
<p class="note">As described in doc/how_to/place_accuracy.md. Position errors in {{ unit }}.</p>
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


def write_evaluation_page(
    path: Path,
    what: str,
    evaluations: Mapping[str, PlaceEvaluation],
    unit: str,
    plots: Sequence[Path],
    predicting: Sequence[str],
    comparison: Optional[Table] = None,
) -> None:
    """Writes the page atomically.

    :param what: map and queries, in words
    :param evaluations: by the name of the method
    :param unit: of position errors
    :param plots: PNG files, which are embedded
    :param predicting: names of the methods in the predictor_table()
    :param comparison: comparison_table()
    :raises OSError: the page cannot be written, or a plot cannot be read
    """
    content = {
        "title": "Places",
        "what": what,
        "comparison": comparison,
        "figures": figure_table(evaluations),
        "unit": unit,
        "predictors": predictor_table({name: evaluations[name] for name in predicting}),
        "plots": [PagePlot(plot.stem, embedded(plot.read_bytes())) for plot in plots],
    }
    write_report(path, TEMPLATE, content)


# column: figure of PlaceEvaluation.figures(), and its format
FIGURES = {
    "queries": ("queries", ".0f"),
    "not in the map": ("unmapped_queries", ".0f"),
    **{f"recall@{n}": (f"recall@{n}", ".3f") for n in RANKS},
    "area under precision-recall": ("area", ".3f"),
    "calibration error": ("calibration_error", ".3f"),
    "of a perfect one": ("perfect_calibration_error", ".3f"),
    "unknown, in the map": ("unknown_rate_in_map", ".1%"),
    "unknown, others": ("unknown_rate_off_map", ".1%"),
    "estimates": ("estimates", ".0f"),
    "position error, median": ("position_error", ".2f"),
    "90 % below": ("position_error_90", ".2f"),
    "in the 95 % ellipse": ("ellipse_coverage", ".1%"),
}


def figure_table(evaluations: Mapping[str, PlaceEvaluation]) -> Table:
    """The figures of each method."""
    rows = []
    for name, evaluation in evaluations.items():
        figures = evaluation.figures()
        rows.append(Row((name, *(_number(figures[figure], form) for figure, form in FIGURES.values()))))
    return Table(("method", *FIGURES), rows)


def _number(value: float, form: str) -> str:
    return "–" if np.isnan(value) else format(value, form)


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
    return _number(predictor.area, ".2f") + arrow
