# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of how good a recognition is: that they show as much as there is, and of nothing nothing."""

import cv2
import numpy as np
import pytest

from sextant.place_reports.place_plots import plot_precision_recall, plot_reliability
from sextant.places.place_metrics import PrecisionRecall, precision_recall

NOTHING = PrecisionRecall(np.zeros(0), np.zeros(0), np.nan)


def coloured(path):
    """Share of the pixels that are neither grey nor white."""
    image = cv2.imread(str(path)).astype(int)
    return np.mean(image.max(axis=2) - image.min(axis=2) > 60)


def test_a_curve_is_drawn_as_long_as_it_is(tmp_path):
    whole = precision_recall(np.linspace(1, 0, 50), np.ones(50, bool))
    half = precision_recall(np.linspace(1, 0, 50), np.ones(50, bool), findable=100)
    for name, curve in (("whole", whole), ("half", half), ("nothing", NOTHING)):
        plot_precision_recall(tmp_path / f"{name}.png", {"filter": curve})
    parts = [coloured(tmp_path / f"{name}.png") for name in ("nothing", "half", "whole")]
    assert 0 < parts[0] < parts[1] < parts[2]  # of nothing its line in the legend
    assert parts[2] - parts[1] == pytest.approx(parts[1] - parts[0], rel=0.25)


def test_answers_are_drawn_and_none_too(tmp_path):
    rng = np.random.default_rng(1)
    p = rng.random(200)
    plot_reliability(tmp_path / "some.png", p, rng.random(200) < p)
    plot_reliability(tmp_path / "none.png", [], [])
    assert coloured(tmp_path / "some.png") > 0.02 > coloured(tmp_path / "none.png")


def test_a_folder_that_is_not_there_is_named(tmp_path):
    with pytest.raises(OSError, match="nowhere"):
        plot_reliability(tmp_path / "nowhere" / "a.png", [0.5], [True])
