# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plots of an evaluation of places: precision over recall, and reliability of the probabilities."""

from itertools import cycle
from pathlib import Path
from typing import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from sextant.base.plot_colours import COLOURS
from sextant.base.plot_file import save_figure
from sextant.places.place_metrics import PrecisionRecall, perfect_frequencies, reliability

BLUE, GREY = COLOURS[0], "#777777"
EDGES = np.linspace(0.0, 1.0, 21)  # of the histogram's bins


def plot_precision_recall(path: Path, curves: Mapping[str, PrecisionRecall]) -> None:
    """Plots precision-recall curves.

    :param path: of the PNG file
    :param curves: by the name in the legend
    :raises OSError: the file cannot be written; an existing one is unchanged
    """
    figure = Figure(figsize=(6.4, 5.2), constrained_layout=True)  # not pyplot, which has global state
    axes = figure.subplots()
    for colour, (name, curve) in zip(cycle(COLOURS), curves.items()):
        precision = np.append(curve.precision[:1], curve.precision)
        recall = np.append(0.0 * curve.recall[:1], curve.recall)
        label = f"{name}: area {curve.area:.3f}"
        axes.plot(recall, precision, color=colour, label=label, clip_on=False)
        axes.plot(recall[-1:], precision[-1:], "o", color=colour, clip_on=False, zorder=3)
    _finish(axes, "recall", "precision")
    axes.set_title("Precision and recall over falling probability; dot: all predictions", fontsize="medium")
    axes.legend(loc="lower left")
    save_figure(path, figure)


def plot_reliability(path: Path, probabilities: Sequence[float], correct: Sequence[bool]) -> None:
    """Plots a reliability diagram and the histogram of the probabilities.

    :param path: of the PNG file
    :param probabilities: correct: see place_metrics.reliability()
    :raises OSError: the file cannot be written; an existing one is unchanged
    """
    figure = Figure(figsize=(6.4, 6.8), constrained_layout=True)
    upper, lower = figure.subplots(2, 1, sharex=True, gridspec_kw={"height_ratios": [4, 1]})
    _draw_reliability(upper, probabilities, correct)
    lower.hist(np.clip(probabilities, 0, 1), EDGES, color=BLUE, alpha=0.7)
    lower.set(xlabel="predicted probability", ylabel="predictions")
    lower.yaxis.set_major_locator(MaxNLocator(4, integer=True))
    lower.grid(alpha=0.3)
    save_figure(path, figure)


def _draw_reliability(axes: Axes, probabilities: Sequence[float], correct: Sequence[bool]) -> None:
    axes.plot([0, 1], [0, 1], "--", color=GREY, linewidth=1)
    _finish(axes, "", "fraction of correct predictions")
    axes.set_title("Reliability of the probabilities", fontsize="medium", pad=28)
    if not len(probabilities):
        axes.text(0.5, 0.4, "no predictions", ha="center")
        return
    bins = reliability(probabilities, correct)
    predicted = np.array([each.probability for each in bins])
    observed = np.array([each.frequency for each in bins])
    low, high = perfect_frequencies(probabilities)
    axes.vlines(
        predicted, low, high, color=GREY, alpha=0.35, linewidth=9, label="95 % interval if calibrated"
    )  # fmt: skip
    smallest, largest = min(each.count for each in bins), max(each.count for each in bins)
    counts = f"{smallest}" if smallest == largest else f"{smallest} to {largest}"
    label = f"{len(probabilities)} predictions, {counts} per dot"
    axes.plot(predicted, observed, "o", color=BLUE, label=label, clip_on=False, zorder=3)
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=2, frameon=False)  # above the dots


def _finish(axes: Axes, x: str, y: str) -> None:
    axes.set(xlabel=x, ylabel=y, xlim=(0, 1), ylim=(0, 1))
    axes.grid(alpha=0.3)
