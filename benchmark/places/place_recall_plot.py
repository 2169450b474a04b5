# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plots of the recall in the corridor, mode by mode."""

from pathlib import Path
from typing import Dict, List

from tables import Table

from sextant.place_reports.place_plots import plot_precision_recall, plot_reliability
from sextant.places.place_metrics import precision_recall


def plot(folder: Path, results: Dict[str, List[Table]]) -> None:
    """Writes recall.png and reliability_MODE.png into the folder, if that topic was measured."""
    predicted = {mode: each for table in results.get("recall", []) for mode, each in table.samples.items()}
    if predicted:
        curves = {mode: precision_recall(p, right) for mode, (p, right) in predicted.items()}
        plot_precision_recall(folder / "recall.png", curves)
    for mode, (p, right) in predicted.items():
        plot_reliability(folder / f"reliability_{mode}.png", p, right)
