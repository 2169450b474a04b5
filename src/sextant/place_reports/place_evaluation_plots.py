# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""All plots of an evaluation of places, or of a comparison of methods."""

import re
from functools import partial
from pathlib import Path
from typing import Callable, Dict, List, Mapping, Sequence

from sextant.place_reports.place_comparison import ComparedMethod
from sextant.place_reports.place_comparison_plot import plot_comparison
from sextant.place_reports.place_plots import plot_precision_recall, plot_reliability
from sextant.place_reports.place_predictor_plots import plot_distributions, plot_predictors
from sextant.place_reports.place_predictors import predictors
from sextant.places.place_evaluation import PlaceEvaluation

EACH = ("distributions", "reliability")  # plots of one method


def plot_names(methods: Sequence[str], is_comparison: bool) -> List[str]:
    """File names of the plots; those of one method contain its name if methods are compared."""
    each = [f"_{re.sub(r'[^A-Za-z0-9]+', '_', method)}" if is_comparison else "" for method in methods]
    first = ["comparison.png"] if is_comparison else []
    files = [f"{plot}{method}.png" for method in each for plot in EACH]
    return [*first, "precision_recall.png", "predictors.png", *files]


def write_plots(
    folder: Path,
    evaluations: Mapping[str, PlaceEvaluation],
    compared: Sequence[ComparedMethod],
    distances: Sequence[float],
    unit: str,
) -> List[Path]:
    """Writes the plots; see plot_names().

    :param evaluations: on exact positions, by the name of the method
    :param compared: also on clusters; empty: no comparison
    :param distances: unit: see plot_comparison()
    :returns: the files
    :raises OSError: a file cannot be written
    """
    of_methods = {name: predictors(evaluation) for name, evaluation in evaluations.items()}
    plots: List[Callable[[Path], None]] = []
    if compared:
        plots.append(partial(plot_comparison, compared=compared, distances=distances, unit=unit))
    curves = {name: evaluation.curve for name, evaluation in evaluations.items()}
    plots.append(partial(plot_precision_recall, curves=curves))
    plots.append(partial(plot_predictors, predictors=of_methods))
    for name, evaluation in evaluations.items():
        probabilities, correct = evaluation.predictions
        plots.append(partial(plot_distributions, method=name, predictors=of_methods[name]))
        plots.append(partial(plot_reliability, probabilities=probabilities, correct=correct))
    names = plot_names(list(evaluations), bool(compared))
    files: Dict[Path, Callable[[Path], None]] = {folder / name: plot for name, plot in zip(names, plots)}
    for path, plot in files.items():
        plot(path)
    return list(files)
