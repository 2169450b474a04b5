# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import cv2
import numpy as np
import pytest

import sextant
from sextant.evaluation.drive_bands import DriveEstimate, plot_bands

SECOND = 10**9
TIMES = range(100)


def path(shift=0.0, times=TIMES):
    """A straight line, with this error of y."""
    places = {t * SECOND // 10: [0.05 * t, 0.02 * t + shift, 0.0] for t in times}
    return {stamp: sextant.pose_from_xyz_rpy(xyz, [0.0, 0.0, 0.0]) for stamp, xyz in places.items()}


def estimate(shift, sigma, times=TIMES):
    poses = path(shift, times)
    return DriveEstimate(poses, {stamp: sigma**2 * np.eye(6) for stamp in poses})


def band_height(picture, row):
    """Pixels of the panel's band in the middle of the drive; row: 0 to 2."""
    height, width = picture.shape[:2]
    column = picture[row * height // 3 : (row + 1) * height // 3, int(0.77 * width)].astype(int)
    return int((column[:, 0] - column[:, 2] > 20).sum())  # bluish


@pytest.mark.slow
def test_bands_are_two_deviations_wide(tmp_path):
    heights = {}
    for sigma in (0.1, 0.2):
        both = {"a": estimate(0.0, sigma), "b": estimate(1.0, 1e-4)}  # the other sets the scale
        plot_bands(str(tmp_path / "a.png"), both, path())
        heights[sigma] = band_height(cv2.imread(str(tmp_path / "a.png")), 1)
    assert heights[0.2] == pytest.approx(2.0 * heights[0.1], rel=0.35)


@pytest.mark.slow
def test_without_truth_or_covariances_and_with_a_gap(tmp_path):
    gap = DriveEstimate(path(0.5, [*range(20), *range(80, 100)]), {})
    plot_bands(str(tmp_path / "a.png"), {"/odom": estimate(0.0, 0.1), "/pose": gap})
    plot_bands(str(tmp_path / "b.png"), {"one pose": DriveEstimate(path(0.0, [5]), {})})
    assert min((tmp_path / name).stat().st_size for name in ("a.png", "b.png")) > 10000


@pytest.mark.slow
def test_the_band_of_a_single_topic_is_not_cut_off(tmp_path):
    plot_bands(str(tmp_path / "a.png"), {"a": estimate(0.0, 0.5)}, path())
    picture = cv2.imread(str(tmp_path / "a.png"))
    panel = 0.88 / 3.6 * len(picture)  # pixels
    assert band_height(picture, 1) == pytest.approx(panel / 1.3, rel=0.1)


@pytest.mark.slow
def test_a_wide_band_does_not_change_the_scale(tmp_path):
    pictures = []
    for sigma in (3.0, 300.0):
        plot_bands(str(tmp_path / "a.png"), {"a": estimate(0.0, 0.1), "b": estimate(1.0, sigma)}, path())
        pictures.append(cv2.imread(str(tmp_path / "a.png")))
    assert np.mean(np.any(pictures[0] != pictures[1], axis=2)) < 1e-3


@pytest.mark.slow
def test_a_negative_variance_has_no_band(tmp_path, recwarn):
    negative = DriveEstimate(path(), {stamp: -np.eye(6) for stamp in path()})
    plot_bands(str(tmp_path / "a.png"), {"a": negative}, path())
    assert band_height(cv2.imread(str(tmp_path / "a.png")), 1) < 20 and not list(recwarn)
