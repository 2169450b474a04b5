# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of how good a recognition is: precision over recall, and whether its probabilities are true."""

from itertools import cycle
from pathlib import Path
from typing import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from sextant.base.atomic_file import atomic_file
from sextant.base.plot_colours import COLOURS
from sextant.places.place_metrics import PrecisionRecall, perfect_frequencies, reliability

BLUE, GREY = COLOURS[0], "#777777"
SHARES = np.linspace(0.0, 1.0, 21)  # bars of how often a probability is said


def plot_precision_recall(path: Path, curves: Mapping[str, PrecisionRecall]) -> None:
    """A curve each, by name, with its end: all answers.

    :param path: a PNG
    :raises OSError: the file cannot be written; an old one stays as it was
    """
    figure = Figure(figsize=(6.4, 5.2), layout="constrained")
    FigureCanvasAgg(figure)  # not pyplot: it needs a window system and has a state of its own
    axes = figure.subplots()
    for colour, (name, curve) in zip(cycle(COLOURS), curves.items()):
        precision = np.append(curve.precision[:1], curve.precision)
        recall = np.append(0.0 * curve.recall[:1], curve.recall)
        label = f"{name}: area {curve.area:.3f}"
        axes.plot(recall, precision, color=colour, label=label, clip_on=False)
        axes.plot(recall[-1:], precision[-1:], "o", color=colour, clip_on=False, zorder=3)
    _finish(axes, "recall: of all queries that are in the map", "precision: of the answers so far")
    axes.set_title("Answers, the most probable first; dot: all of them", fontsize="medium")
    axes.legend(loc="lower left")
    _save(path, figure)


def plot_reliability(path: Path, probabilities: Sequence[float], right: Sequence[bool]) -> None:
    """How often what was said is so, and how often what is said.

    :param path: a PNG
    :param probabilities: right: as place_metrics.reliability()
    :raises OSError: the file cannot be written; an old one stays as it was
    """
    figure = Figure(figsize=(6.4, 6.8), layout="constrained")
    FigureCanvasAgg(figure)
    upper, lower = figure.subplots(2, 1, sharex=True, gridspec_kw={"height_ratios": [4, 1]})
    _draw_reliability(upper, probabilities, right)
    lower.hist(np.clip(probabilities, 0, 1), SHARES, color=BLUE, alpha=0.7)
    lower.set(xlabel="probability that is said", ylabel="answers")
    lower.yaxis.set_major_locator(MaxNLocator(4, integer=True))
    lower.grid(alpha=0.3)
    _save(path, figure)


def _draw_reliability(axes: Axes, probabilities: Sequence[float], right: Sequence[bool]) -> None:
    axes.plot([0, 1], [0, 1], "--", color=GREY, linewidth=1)
    _finish(axes, "", "share of right answers")
    axes.set_title("Do the probabilities say what is so?", fontsize="medium", pad=28)
    if not len(probabilities):
        axes.text(0.5, 0.4, "there is no answer", ha="center")
        return
    bins = reliability(probabilities, right)
    said, so = np.array([each.probability for each in bins]), np.array([each.frequency for each in bins])
    low, high = perfect_frequencies(probabilities)
    axes.vlines(
        said, low, high, color=GREY, alpha=0.35, linewidth=9, label="95 % of perfect forecasters"
    )  # fmt: skip
    least, most = min(each.count for each in bins), max(each.count for each in bins)
    counts = f"{least}" if least == most else f"{least} to {most}"
    label = f"{len(probabilities)} answers, {counts} a dot"
    axes.plot(said, so, "o", color=BLUE, label=label, clip_on=False, zorder=3)
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=2, frameon=False)  # dots may be anywhere


def _finish(axes: Axes, x: str, y: str) -> None:
    axes.set(xlabel=x, ylabel=y, xlim=(0, 1), ylim=(0, 1))
    axes.grid(alpha=0.3)


def _save(path: Path, figure: Figure) -> None:
    with atomic_file(path, "wb") as file:
        figure.savefig(file, format="png", dpi=110)
