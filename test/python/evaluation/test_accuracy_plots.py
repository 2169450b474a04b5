# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import cv2
import numpy as np
import pytest

from sextant.evaluation.accuracy_plots import BLUE, GREEN, RED, plot_errors, plot_spread
from sextant.evaluation.pose_series import GroundTruth, pose_series, series_statistics

FACING = GroundTruth(others={"roll": np.pi})
NOT_MEASURED = GroundTruth(others=dict.fromkeys(("x", "y", "roll", "pitch", "yaw")))


def series(distance, count, sigma=0.01, bias=0.02, published=True):
    random = np.random.default_rng(count)
    poses = np.array([0, 0, distance + bias, np.pi, 0, 0]) + random.normal(0.0, sigma, (count, 6))
    covariances = np.tile(sigma**2 * np.eye(6), (count, 1, 1)) if published else None
    return pose_series(distance, "a.bag", range(count), poses, covariances)


def statistics(truths=FACING, **arguments):
    all_of_them = [series(1.0, 40, **arguments), series(2.0, 60, 0.05), series(3.0, 1), series(7.0, 0)]
    return [series_statistics(each, truths) for each in all_of_them]


def pixels(path, colour):
    """How many pixels of a colour are in each of the six panels, above the legend."""
    picture = cv2.imread(str(path))
    assert picture.shape == (825, 1430, 3)
    found = np.all(picture == [int(colour[i : i + 2], 16) for i in (5, 3, 1)], axis=2)[:750]
    return [int(part.sum()) for half in np.array_split(found, 2) for part in np.array_split(half, 3, axis=1)]


@pytest.mark.slow
def test_errors(tmp_path):
    plot_errors(tmp_path / "errors.png", statistics())
    assert min(pixels(tmp_path / "errors.png", RED)) > 100
    assert min(pixels(tmp_path / "errors.png", BLUE)) > 50
    plot_errors(tmp_path / "errors.png", statistics(NOT_MEASURED))
    red = pixels(tmp_path / "errors.png", RED)
    assert red[2] > 100 and red[:2] + red[3:] == [0] * 5


@pytest.mark.slow
def test_spread(tmp_path):
    plot_spread(tmp_path / "spread.png", statistics())
    assert min(pixels(tmp_path / "spread.png", BLUE)) > 10
    assert min(pixels(tmp_path / "spread.png", GREEN)) > 10
    none = [series_statistics(series(d, 20, published=False), FACING) for d in (1.0, 2.0)]
    plot_spread(tmp_path / "spread.png", none)
    assert max(pixels(tmp_path / "spread.png", GREEN)) == 0


@pytest.mark.slow
def test_order_does_not_matter(tmp_path):
    for name, order in (("a.png", 1), ("b.png", -1)):
        plot_errors(tmp_path / name, statistics()[::order])
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize(
    "plot, one",
    [
        (plot_errors, series(1.0, 0)),
        (plot_spread, series(1.0, 1)),
        (plot_spread, series(1.0, 9, sigma=0.0, bias=0.0)),
    ],
)
def test_little_to_draw(tmp_path, plot, one):
    plot(tmp_path / "a.svg", [series_statistics(one, FACING)])
    assert (tmp_path / "a.svg").stat().st_size > 1000


@pytest.mark.parametrize("plot", [plot_errors, plot_spread])
def test_what_cannot_be_drawn(tmp_path, plot):
    with pytest.raises(ValueError, match="no statistics"):
        plot(tmp_path / "a.png", [])
    with pytest.raises(ValueError, match="'xlsx' is not an image format"):
        plot(tmp_path / "a.xlsx", statistics())
    with pytest.raises(OSError):
        plot(tmp_path / "absent" / "a.png", statistics()[:1])
    assert list(tmp_path.iterdir()) == []
