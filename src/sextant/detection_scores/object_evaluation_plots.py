# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plots of evaluations of detectors."""

from pathlib import Path
from typing import List, Sequence

import numpy as np

from sextant.base.plot_colours import COLOURS
from sextant.base.plot_file import new_figure, save_figure
from sextant.detection_scores.detector_scores import plot_confusion
from sextant.detection_scores.object_evaluation import CONFIDENCES, ObjectEvaluation


def plot_evaluations(folder: Path, evaluations: Sequence[ObjectEvaluation]) -> List[Path]:
    """Writes all plots into a folder. :returns: their paths

    :raises OSError: a file cannot be written
    """
    paths = [folder / name for name in ("confidence.png", "reliability.png", "groups.png")]
    _plot_confidence(paths[0], evaluations)
    _plot_reliability(paths[1], evaluations)
    _plot_groups(paths[2], evaluations)
    for number, each in enumerate(evaluations):
        paths.append(folder / f"confusion{'' if len(evaluations) == 1 else f'_{number + 1}'}.png")
        plot_confusion(paths[-1], each.score, each.classes)
    return paths


def _plot_confidence(path: Path, evaluations: Sequence[ObjectEvaluation]) -> None:
    """Recall, precision and false alarms over the confidence."""
    figure = new_figure(path, 10.0, 3.6, constrained_layout=True)
    found, right, false = figure.subplots(1, 3)
    for each, colour in zip(evaluations, _colours(evaluations)):
        matched = each.matched
        found.plot(CONFIDENCES, [matched.recall(c) for c in CONFIDENCES], color=colour, label=each.name)
        right.plot(CONFIDENCES, [matched.precision(c) for c in CONFIDENCES], color=colour)
        alarms = [matched.false_alarms(c, each.photos) for c in CONFIDENCES]
        false.plot(CONFIDENCES, alarms, color=colour)
        for axes in (found, right, false):
            axes.axvline(each.confidence, color="0.6", linestyle=":", linewidth=1)
    found.set(ylabel="recall", ylim=(0, 1.02)), right.set(ylabel="precision", ylim=(0, 1.02))
    false.set(ylabel="false alarms per photo", ylim=(0, None))
    for axes in (found, right, false):
        axes.set(xlabel="confidence", xlim=(0, 1))
        axes.grid(alpha=0.3)
    found.legend(fontsize=8)
    save_figure(path, figure)


def _plot_reliability(path: Path, evaluations: Sequence[ObjectEvaluation]) -> None:
    """Fraction of right detections by their score."""
    figure = new_figure(path, 5.0, 4.2, constrained_layout=True)
    axes = figure.subplots()
    axes.plot([0, 1], [0, 1], color="0.6", linestyle=":", label="as the score promises")
    for each, colour in zip(evaluations, _colours(evaluations)):
        mean, right, count = each.reliability()
        axes.plot(mean, right, "o-", color=colour, label=each.name, markersize=4)
        for x, y, number in zip(mean, right, count):
            if number:
                axes.annotate(f"{number:.0f}", (x, y), textcoords="offset points", xytext=(4, -9), fontsize=6)
    axes.set(xlabel="score", ylabel="fraction of right detections", xlim=(0, 1), ylim=(0, 1.02))
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    save_figure(path, figure)


def _plot_groups(path: Path, evaluations: Sequence[ObjectEvaluation]) -> None:
    """Recall by size, light and distance."""
    names = list(evaluations[0].groups)
    figure = new_figure(path, 3.4 * max(1, len(names)), 3.6, constrained_layout=True)
    width = 0.8 / len(evaluations)
    for name, axes in zip(names, np.ravel(figure.subplots(1, max(1, len(names)), squeeze=False))):
        for number, (each, colour) in enumerate(zip(evaluations, _colours(evaluations))):
            groups = each.groups[name]
            at = np.arange(len(groups)) + (number - 0.5 * (len(evaluations) - 1)) * width
            axes.bar(at, [group.recall for group in groups], width, color=colour, label=each.name)
        axes.set_xticks(range(len(evaluations[0].groups[name])))
        labels = [f"{group.name.replace(' (', chr(10) + '(')}" for group in evaluations[0].groups[name]]
        axes.set_xticklabels(labels, fontsize=7)
        axes.set(title=f"by {name}", ylabel="recall", ylim=(0, 1.02))
    save_figure(path, figure)


def _colours(evaluations: Sequence[ObjectEvaluation]) -> List[str]:
    return [COLOURS[number % len(COLOURS)] for number in range(len(evaluations))]
