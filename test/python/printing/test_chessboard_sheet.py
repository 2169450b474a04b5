# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import re

import cv2
import numpy as np
import pytest
from printed_pages import paper, pictures, texts

from sextant.printing.chessboard_sheet import Chessboard, largest_square, write_chessboard
from sextant.printing.print_layout import PAGES, Paper

DPI = 100
FLAGS = cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE  # those of camera_calibration
CASES = [(8, 6, 0.025, "A4"), (9, 6, 0.034, "A3"), (6, 8, 0.02, "Letter"), (7, 5, 0.0255, "A4")]


def write(folder, columns=8, rows=6, square=0.02, **paper):
    pdf = folder / "board.pdf"
    write_chessboard(pdf, Chessboard(columns, rows, square), Paper(**paper))
    return pdf


@pytest.mark.parametrize("columns, rows, square, page", CASES)
def test_inner_corners_are_found_and_as_far_apart_as_the_sheet_states(tmp_path, columns, rows, square, page):
    pdf = write(tmp_path, columns, rows, square, page=page)
    assert sorted(paper(pdf)) == pytest.approx([1000.0 * edge for edge in PAGES[page]], abs=0.01)
    [picture] = pictures(pdf, DPI)
    # as if glued onto something dark that ends with the paper
    picture = cv2.copyMakeBorder(picture, 100, 100, 100, 100, cv2.BORDER_CONSTANT, value=0)
    found, corners = cv2.findChessboardCorners(picture, (columns, rows), flags=FLAGS)
    assert found
    criteria = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_MAX_ITER, 50, 1e-3)
    corners = cv2.cornerSubPix(picture, corners, (7, 7), (-1, -1), criteria).reshape(rows, columns, 2)
    for axis in (0, 1):
        steps = 25.4 / DPI * np.linalg.norm(np.diff(corners, axis=axis), axis=2)
        np.testing.assert_allclose(steps, 1000.0 * square, atol=0.1)
    across, down = (25.4 / DPI * np.linalg.norm(corners[i, j] - corners[0, 0]) for i, j in ((0, -1), (-1, 0)))
    assert across == pytest.approx(1000.0 * square * (columns - 1), abs=0.1)
    assert down == pytest.approx(1000.0 * square * (rows - 1), abs=0.1)


def test_sheet_states_what_to_type_and_what_to_measure(tmp_path):
    [words] = texts(write(tmp_path, 9, 6, 0.0215))
    line = " ".join(words)
    for text in (
        "--size 9x6 --square 0.0215",
        "inner corners",
        "21.5 mm",
        "9 x 6 inner corners, 10 x 7 squares",
        "100 mm long",
    ):
        assert text in line


def test_no_seams_and_no_ink_around(tmp_path):
    pdf, dpi, square = write(tmp_path, 8, 6, 0.02), 97, 0.02
    [picture] = pictures(pdf, dpi)
    found, corners = cv2.findChessboardCorners(picture, (8, 6), flags=FLAGS)
    corners = corners.reshape(-1, 2)
    edge = 1000.0 * square / 25.4 * dpi
    low, high = corners.min(axis=0) - edge, corners.max(axis=0) + edge
    rim = picture.copy()
    rim[int(low[1]) - 3 : int(high[1]) + 4, int(low[0]) - 3 : int(high[0]) + 4] = 255
    outer = np.concatenate([low - 0.5 * edge, high + 0.5 * edge]).round().astype(int)
    assert rim[outer[1] + 1 : outer[3] - 1, outer[0] + 1 : outer[2] - 1].min() == 255
    middles = [(low + edge * np.array([i + 0.5, j + 0.5])).astype(int) for i in range(9) for j in range(7)]
    reach = int(0.4 * edge)
    contrast = [np.ptp(picture[y - reach : y + reach, x - reach : x + reach]) for x, y in middles]
    assert contrast == [0] * 63


@pytest.mark.parametrize("margin", [0.0, 0.008, 0.03])
@pytest.mark.parametrize("columns, rows", [(8, 6), (6, 8), (12, 3)])
def test_largest_square_fits_and_no_larger_one(tmp_path, columns, rows, margin):
    for page in PAGES:
        square = largest_square(columns, rows, Paper(page, margin))
        assert round(1000.0 * square, 6) == round(1000.0 * square) > 5.0
        write(tmp_path, columns, rows, square, page=page, margin=margin)
        with pytest.raises(ValueError):
            write(tmp_path, columns, rows, square + 0.001, page=page, margin=margin)


def test_largest_squares_that_are_reported_fit(tmp_path):
    with pytest.raises(ValueError, match="the board does not fit on A4; ") as refused:
        write(tmp_path, square=0.1)
    reported = re.findall(r"([\d.]+) m on (\w+)(?:,|$)", str(refused.value))
    assert [page for _, page in reported] == list(PAGES)
    for square, page in reported:
        write(tmp_path, square=float(square), page=page)
        with pytest.raises(ValueError):
            write(tmp_path, square=float(square) + 0.0001, page=page)


@pytest.mark.parametrize(
    "wrong, reason",
    [
        (dict(columns=1), "columns: must be"),
        (dict(rows=101), "rows: must be"),
        (dict(square=0.0), "square: must be"),
        (dict(square=float("nan")), "square: must be"),
        (dict(page="A5"), "page: must be"),
        (dict(margin=1.0), "margin: must be"),
    ],
)
def test_what_is_refused(tmp_path, wrong, reason):
    with pytest.raises(ValueError, match=re.escape(reason)):
        write(tmp_path, **wrong)
    assert list(tmp_path.iterdir()) == []
