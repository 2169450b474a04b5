# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import re

import numpy as np
import pytest
from printed_pages import detector, pictures, texts

import sextant
from sextant.printing.board_sheet import BoardParams, board_map, min_gap, rounded_min_gap, write_board
from sextant.printing.marker_sheet import SheetParams

DPI = 150
CASES = [
    # family, ids, size, (columns, rows, gap), page
    ("tag36h11", list(range(3, 15)), 0.04, (4, 3, 0.005), "A4"),
    ("tagStandard41h12", [9, 2, 7, 0, 1, 5], 0.03, (2, 3, 0.03), "Letter"),
    ("DICT_5X5_100", list(range(40)), 0.03, (8, 5, 0.012), "A3"),
    ("tag16h5", [3], 0.1, (1, 1, 0.0), "A4"),
]


def write(folder, family="tag36h11", ids=(0, 1, 2, 3, 4, 5), size=0.04, board=(3, 2, 0.01), **params):
    pdf = folder / "board.pdf"
    marker_map = write_board(pdf, family, list(ids), size, BoardParams(*board), SheetParams(**params))
    return pdf, marker_map


@pytest.mark.parametrize("family, ids, size, board, page", CASES)
def test_markers_lie_where_the_map_has_them(tmp_path, family, ids, size, board, page):
    pdf, marker_map = write(tmp_path, family, ids, size, board, page=page)
    [picture] = pictures(pdf, DPI)
    markers = {marker.id: marker for marker in detector(family).detect(picture)}
    assert sorted(markers) == sorted(ids) == sorted(marker.id for marker in marker_map.markers)
    corners = np.column_stack([sextant.marker_corners(size), np.ones(4)])
    expected = np.concatenate([(corners @ marker.T_map_marker.T)[:, :2] for marker in marker_map.markers])
    seen = np.concatenate([markers[marker.id].corners for marker in marker_map.markers])
    seen = 0.0254 / DPI * seen * [1, -1]  # y up
    np.testing.assert_allclose(
        seen - seen.mean(axis=0), expected, atol=1e-4
    )  # the map's origin is its middle


def test_ids_go_row_by_row_from_the_top_left():
    T = {
        marker.id: marker.T_map_marker
        for marker in board_map("tag36h11", [5, 1, 9, 3], 0.1, BoardParams(2, 2, 0.02)).markers
    }
    np.testing.assert_allclose(
        [T[id][:2, 3] for id in (5, 1, 9, 3)], 0.06 * np.array([[-1, 1], [1, 1], [-1, -1], [1, -1]])
    )
    for pose in T.values():
        np.testing.assert_array_equal(pose[:3, :3], np.eye(3))


def test_map_survives_its_file(tmp_path):
    _, marker_map = write(tmp_path)
    sextant.write_marker_map(marker_map, str(tmp_path / "board.yaml"))
    again = sextant.read_marker_map(str(tmp_path / "board.yaml"))
    assert again.frame == "board"
    for marker, copy in zip(marker_map.markers, again.markers):
        assert (marker.family, marker.id, marker.size) == (copy.family, copy.id, copy.size)
        np.testing.assert_array_equal(marker.T_map_marker, copy.T_map_marker)


def test_sheet_describes_what_is_on_it(tmp_path):
    pdf, _ = write(tmp_path, ids=[4, 5, 6, 0, 1, 2])
    [words] = texts(pdf)
    line = " ".join(words)
    for text in (
        "id 4-6,0-2",
        "40 mm",
        "10 mm",
        "tag36h11, size 0.04 m",
        "gap 0.01 m",
        "row by row from the top left",
    ):
        assert text in line


@pytest.mark.parametrize("family, white", [("tag36h11", 0.01), ("tagCircle49h12", 0.08 / 5 * 7)])
def test_smallest_gap_leaves_a_module_of_white(family, white):
    """tagCircle49h12 has three modules outside of its edge on either side."""
    assert min_gap(family, 0.08, 1.0) == pytest.approx(white)
    assert white <= rounded_min_gap(family, 0.08, 1.0) < white + 0.001
    assert rounded_min_gap("tag36h11", 0.08, 1.0) == 0.01


def test_largest_markers_that_are_reported_fit_and_no_larger_ones(tmp_path):
    with pytest.raises(ValueError, match="the board does not fit on A4; ") as refused:
        write(tmp_path, size=0.2, board=(3, 2, 0.03))
    reported = re.findall(r"([\d.]+) m on (\w+)(?:,|$)", str(refused.value))
    assert [page for _, page in reported] == ["A4", "A3", "Letter"]
    for size, page in reported:
        write(tmp_path, size=float(size), board=(3, 2, 0.03), page=page)
        with pytest.raises(ValueError):
            write(tmp_path, size=float(size) + 0.0001, board=(3, 2, 0.03), page=page)


@pytest.mark.parametrize(
    "wrong, reason",
    [
        (dict(board=(4, 2, 0.01)), "a board of 4 x 2 needs 8 ids, 6 are given"),
        (dict(board=(3, 2, 0.004)), "gap is 0.004 m, the white rim between adjacent markers needs 0.005 m"),
        (dict(board=(3, 2, float("nan"))), "gap: must be"),
        (dict(board=(0, 2, 0.01)), "columns: must be"),
        (dict(ids=[0, 1, 2, 3, 4, 4]), "id 4 is given twice"),
        (dict(family="tag99h9"), "tag99h9"),
        (dict(page="A5"), "page: must be"),
    ],
)
def test_what_is_refused(tmp_path, wrong, reason):
    with pytest.raises(ValueError, match=re.escape(reason)):
        write(tmp_path, **wrong)
    assert list(tmp_path.iterdir()) == []
