# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
from dataclasses import replace

import cv2
import numpy as np
import pytest

from sextant.base.plot_colours import COLOURS
from sextant.evaluation.comparison_plots import plot_comparison, plot_points
from sextant.evaluation.error_statistics import error_statistics
from sextant.evaluation.pose_series import pose_series, series_statistics
from sextant.evaluation.surveyed_points import SurveyedPoint, SurveyedPoints
from sextant.simulation.room_markers import default_map

PLACES = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.5), (0.0, 1.0, None)]
TRUTH = SurveyedPoints([SurveyedPoint("a", {"x": x, "y": y, "z": 0.0, "yaw": yaw}) for x, y, yaw in PLACES])


def statistics(methods=("nearest", "joint"), counts=(30, 30, 0), outlier=0.0):
    random, found = np.random.default_rng(1), []
    for method, sigma in zip(methods, (0.05, 0.01)):
        for number, count in enumerate(counts, 1):
            poses = np.nan_to_num(TRUTH.at(number)) + sigma * random.normal(size=(count, 6))
            poses[:1, 0] += outlier
            one = pose_series(number, "a.bag", range(count), poses, images=40)
            found.append(series_statistics(replace(one, method=method), TRUTH))
    return found


def pixels(path, colour):
    """How many pixels of a colour are in the left and in the right half, above the legend."""
    picture = cv2.imread(str(path))
    found = np.all(picture == [int(colour[i : i + 2], 16) for i in (5, 3, 1)], axis=2)
    return [int(half.sum()) for half in np.array_split(found[: int(0.85 * len(found))], 2, axis=1)]


@pytest.mark.slow
@pytest.mark.parametrize("outlier", [0.0, 3.0])
def test_comparison(tmp_path, outlier):
    plot_comparison(tmp_path / "a.png", error_statistics(statistics(outlier=outlier)))
    for colour in COLOURS[:2]:
        assert min(pixels(tmp_path / "a.png", colour)) > 50


@pytest.mark.slow
def test_points(tmp_path):
    plot_points(tmp_path / "a.png", statistics(), default_map().markers)
    assert pixels(tmp_path / "a.png", "#000000")[0] > 1000


@pytest.mark.slow
@pytest.mark.parametrize("counts", [(0, 0, 0), (1, 0, 0)])
def test_little_to_draw(tmp_path, counts):
    plot_comparison(tmp_path / "a.svg", error_statistics(statistics(("",), counts)))
    plot_points(tmp_path / "b.svg", statistics(("",), counts))
    assert min((tmp_path / name).stat().st_size for name in ("a.svg", "b.svg")) > 1000


def test_another_format(tmp_path):
    with pytest.raises(ValueError, match="'xlsx' is not an image format"):
        plot_comparison(tmp_path / "a.xlsx", error_statistics(statistics()))
    assert list(tmp_path.iterdir()) == []
