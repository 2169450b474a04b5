# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from sextant.base.plot_colours import COLOURS
from sextant.evaluation.drive_plot import plot_drive


def at(x, y):
    T = np.eye(4)
    T[:2, 3] = x, y
    return T


TRUTH = {i * 10**8: at(np.cos(0.1 * i), np.sin(0.1 * i)) for i in range(60)}
FIRST = {stamp: T @ at(0.1, 0.0) for stamp, T in TRUTH.items()}
MARKER = SimpleNamespace(id=7, size=0.5, T_map_marker=at(2.0, 0.0))


def pixels_of(picture, colour):
    bgr = [int(colour[i : i + 2], 16) for i in (5, 3, 1)]
    return int(np.all(picture == bgr, axis=2).sum())


def test_every_series_is_in_the_picture(tmp_path):
    path = str(tmp_path / "drive.png")
    plot_drive(path, TRUTH, {"first": FIRST, "empty": {}}, [MARKER])
    picture = cv2.imread(path)
    assert picture.shape == (715, 1430, 3)
    assert pixels_of(picture, COLOURS[0]) > 500
    assert pixels_of(picture, COLOURS[2]) == 0
    assert pixels_of(picture, "#000000") > 500


def test_one_wild_pose_does_not_change_the_scale(tmp_path):
    wild = dict(FIRST)
    wild[0] = at(1e6, 1e6)
    pictures = []
    for name, estimate in (("tame", FIRST), ("wild", wild)):
        plot_drive(str(tmp_path / name) + ".png", TRUTH, {"first": estimate}, [MARKER])
        pictures.append(cv2.imread(str(tmp_path / name) + ".png")[:, :640])
    assert np.mean(np.any(pictures[0] != pictures[1], axis=2)) < 1e-3


def test_a_corridor_is_drawn_above_the_errors_in_the_whole_width(tmp_path):
    path, truth = str(tmp_path / "drive.png"), {i * 10**8: at(0.1 * i, 0.0) for i in range(300)}
    plot_drive(path, truth, {"first": {stamp: T @ at(0.0, 0.1) for stamp, T in truth.items()}})
    picture = cv2.imread(path)
    line = np.all(picture == 0, axis=2)[:150].sum(axis=1)  # in the top view
    assert picture.shape[1] == 1430 and line.max() > 1200


def test_a_folder_that_is_not_there(tmp_path):
    with pytest.raises(OSError):
        plot_drive(str(tmp_path / "absent" / "drive.png"), TRUTH, {"first": FIRST})
