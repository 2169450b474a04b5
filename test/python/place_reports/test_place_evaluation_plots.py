# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The plots of an evaluation: all are written, and show as much as there is."""

import cv2
import numpy as np
import pytest
from made_evaluations import evaluation_of, half_right, result_of

from sextant.place_reports.place_comparison import ComparedMethod
from sextant.place_reports.place_comparison_plot import plot_comparison
from sextant.place_reports.place_evaluation_plots import plot_names, write_plots
from sextant.place_reports.place_predictor_plots import plot_distributions, plot_predictors
from sextant.place_reports.place_predictors import predictors

BLUE, ORANGE = (0, 114, 178), (213, 94, 0)  # COLOURS


def share_of(path, colour):
    """Share of the pixels of exactly this colour."""
    image = cv2.imread(str(path))[:, :, ::-1]
    return np.mean(np.abs(image.astype(int) - colour).max(axis=2) <= 2)


@pytest.mark.slow
@pytest.mark.parametrize("is_comparison", [False, True])
def test_every_plot_has_its_file(is_comparison, tmp_path):
    found = (
        {"sift": half_right(), "two words, 3": half_right(10)} if is_comparison else {"single": half_right()}
    )
    compared = [ComparedMethod(name, 0, each, each, np.nan) for name, each in found.items() if is_comparison]
    written = write_plots(tmp_path, found, compared, [5.0, 10.0], "m")
    names = plot_names(list(found), is_comparison)
    assert [path.name for path in written] == names
    assert {path.name for path in tmp_path.iterdir()} == set(names)
    assert ("comparison.png" in names) == ("reliability_two_words_3.png" in names) == is_comparison
    assert all(cv2.imread(str(path)).shape[1] > 500 for path in written)


@pytest.mark.slow
def test_longer_bars_are_of_better_methods(tmp_path):
    def compared(*numbers):
        found = evaluation_of(*(result_of([1], [(number, 0.9)]) for number in numbers))
        return ComparedMethod("sift", 0, found, found, np.nan)

    for name, numbers in (("none", (5, 5)), ("half", (1, 5)), ("all", (1, 1))):
        plot_comparison(tmp_path / f"{name}.png", [compared(*numbers)], [1.0], "m")
    blue = [share_of(tmp_path / f"{name}.png", BLUE) for name in ("none", "half", "all")]
    assert blue[2] - blue[1] == pytest.approx(blue[1] - blue[0], rel=0.05) and blue[1] > blue[0]


@pytest.mark.slow
def test_clusters_have_a_mark_of_their_own(tmp_path):
    found = half_right(4)
    for count in (0, 3):
        method = ComparedMethod("sift", count, found, found, 0.5 if count else np.nan)
        plot_comparison(tmp_path / f"{count}.png", [method], [10.0, 20.0], "px")
    assert share_of(tmp_path / "0.png", ORANGE) == 0 < share_of(tmp_path / "3.png", ORANGE)


@pytest.mark.slow
def test_what_predicts_is_drawn_and_of_nothing_nothing(tmp_path):
    nothing, right = evaluation_of(result_of([1], [])), evaluation_of(result_of([1], [(1, 0.9)]))
    for name, evaluation in (("some", half_right()), ("nothing", nothing), ("right", right)):
        found = predictors(evaluation)
        plot_predictors(tmp_path / f"{name}.png", {name: found})
        plot_distributions(tmp_path / f"{name}_each.png", name, found)
    assert share_of(tmp_path / "some.png", BLUE) > 5 * share_of(tmp_path / "nothing.png", BLUE)
    assert share_of(tmp_path / "nothing_each.png", BLUE) == share_of(tmp_path / "right_each.png", ORANGE) == 0
    assert min(share_of(tmp_path / "some_each.png", colour) for colour in (BLUE, ORANGE)) > 0.001


def test_a_folder_that_is_not_there_is_named(tmp_path):
    with pytest.raises(OSError, match="nowhere"):
        write_plots(tmp_path / "nowhere", {"single": half_right(4)}, [], [], "m")
