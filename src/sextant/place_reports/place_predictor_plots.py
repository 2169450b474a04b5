# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plots of the quantities of localized images: which of them predicts that the best hypothesis is correct."""

from itertools import cycle
from pathlib import Path
from typing import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from sextant.base.plot_colours import COLOURS
from sextant.base.plot_file import new_figure, save_figure
from sextant.place_reports.place_predictors import Predictor

RIGHT, WRONG = COLOURS[:2]
COLUMNS = 4  # panels in a row
SPREAD = 0.6  # of all methods in the row of a quantity
SEED = 1  # of the dots' vertical positions


def plot_predictors(path: Path, predictors: Mapping[str, Sequence[Predictor]]) -> None:
    """Plots the area under the ROC curve of each quantity, with its 95 % interval if it predicts nothing.

    :param path: of the PNG file
    :param predictors: by the name of the method, at least one, each with the same quantities
    :raises OSError: the file cannot be written; an existing one is unchanged
    """
    names = [each.name for each in next(iter(predictors.values()))]
    step = SPREAD / len(predictors)
    figure = new_figure(path, 9, 1.4 + len(names) * (0.22 + 0.08 * len(predictors)), constrained_layout=True)
    axes = figure.subplots()
    axes.axvline(0.5, color="#777777", linewidth=1)
    for number, (colour, (method, quantities)) in enumerate(zip(cycle(COLOURS), predictors.items())):
        rows = np.arange(len(names)) - SPREAD / 2 + (number + 0.5) * step
        areas = np.array([each.area for each in quantities])
        low, high = np.transpose([each.chance for each in quantities])
        known = np.isfinite(areas)
        axes.hlines(rows[known], low[known], high[known], color=colour, alpha=0.25, linewidth=5)
        axes.plot(areas, rows, "o", color=colour, markersize=5, label=_label(method, quantities))
    axes.set(xlim=(0, 1), ylim=(len(names) - 0.5, -0.5), yticks=range(len(names)))
    axes.set_yticklabels([name.replace("_", " ") for name in names])
    axes.set_xlabel("area under the ROC curve; left: low if the answer is correct, right: high if correct")
    axes.set_title("dot outside of its bar: the quantity predicts a correct answer", fontsize="medium")
    axes.grid(alpha=0.3)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    save_figure(path, figure)


def _label(method: str, quantities: Sequence[Predictor]) -> str:
    return f"{method}\n{len(quantities[0].right)} correct, {len(quantities[0].wrong)} wrong"


def plot_distributions(path: Path, method: str, predictors: Sequence[Predictor]) -> None:
    """Plots the values of each quantity for correct and for wrong answers, with median and quartiles.

    :param path: of the PNG file
    :param method: its name, for the title
    :raises OSError: the file cannot be written; an existing one is unchanged
    """
    rows = -(-len(predictors) // COLUMNS)
    figure = new_figure(path, 3.2 * COLUMNS, 1.9 * rows + 0.6, constrained_layout=True)
    panels = list(figure.subplots(rows, COLUMNS, squeeze=False).flat)
    for axes, predictor in zip(panels, predictors):
        _draw_distribution(axes, predictor)
    for axes in panels[len(predictors) :]:
        axes.axis("off")
    title = _label(method, predictors).replace("\n", ": ")
    figure.suptitle(f"{title}; bar: quartiles, line: median", fontsize="medium")
    save_figure(path, figure)


def _draw_distribution(axes: Axes, predictor: Predictor) -> None:
    rng = np.random.default_rng(SEED)
    for row, (values, colour) in enumerate(((predictor.right, RIGHT), (predictor.wrong, WRONG))):
        axes.plot(values, row + rng.uniform(-0.25, 0.25, len(values)), ".", color=colour, alpha=0.5)
        if len(values):
            low, middle, high = np.quantile(values, (0.25, 0.5, 0.75))
            axes.barh(row, high - low, 0.7, low, color=colour, alpha=0.2)
            axes.vlines(middle, row - 0.35, row + 0.35, color=colour, linewidth=2)
    axes.use_sticky_edges = False  # keeps a margin beside the bars
    axes.set(ylim=(1.6, -0.6), yticks=(0, 1))
    axes.set_yticklabels(("correct", "wrong"))
    verdict = {-1: ", low if correct", 0: "", 1: ", high if correct"}[predictor.direction]
    area = "" if np.isnan(predictor.area) else f": area {predictor.area:.2f}{verdict}"
    axes.set_title(f"{predictor.name.replace('_', ' ')}{area}", fontsize="small")
    axes.grid(axis="x", alpha=0.3)
