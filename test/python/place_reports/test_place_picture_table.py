# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The table with a row per picture: what it has of each is what was found."""

import csv

import pytest
from made_evaluations import evaluation_of, result_of

from sextant.place_reports.place_picture_table import write_picture_table


def rows_of(path, evaluations, unit="m"):
    write_picture_table(path, evaluations, unit)
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def test_every_column_of_a_picture(tmp_path):
    result = result_of(
        [1], [(3, 0.5), (1, 0.3), (9, 0.1)], position=(12.0, 5.0), seconds=0.25, name="walk/7.png",
        distances=[1.0, 2.0, 6.0], matches=2, unknown=0.05,
    )  # fmt: skip
    (row,) = rows_of(tmp_path / "a.csv", {"sift": evaluation_of(result, pixels=(0.5, 2.0))})
    assert row == {
        **{"method": "sift", "image": "walk/7.png", "in_map": "1", "status": "AMBIGUOUS"},
        **{"answer": "3.png", "right": "0", "rank": "2"},
        **{"keypoints": "3", "matches": "3", "kept_matches": "2", "photo_matches": "2"},
        **{"min_distance": "1", "mean_distance": "3", "max_distance": "6", "total_distance": "9"},
        **{"probability": "0.5", "margin": "0.2", "unknown_probability": "0.05"},
        # 30, 10 and 90 along x, 12 is the truth; half a metre per pixel
        **{"best_error_m": "9", "second_error_m": "1", "worst_error_m": "39", "ms": "250"},
    }


def test_what_is_unknown_is_empty(tmp_path):
    rows = rows_of(
        tmp_path / "a.csv",
        {"orb": evaluation_of(result_of([], [(3, 0.5)]), result_of([2], [])), "default": evaluation_of()},
        "px",
    )
    assert [row["method"] for row in rows] == ["orb", "orb"]
    assert [row["best_error_px"] for row in rows] == ["", ""]  # nobody knows where; no answer
    assert (rows[1]["answer"], rows[1]["rank"], rows[1]["right"]) == ("", "", "0")
    assert (rows[0]["in_map"], rows[1]["in_map"]) == ("0", "1")


def test_a_file_that_cannot_be_written_is_named(tmp_path):
    with pytest.raises(OSError, match="nowhere"):
        write_picture_table(tmp_path / "nowhere/a.csv", {"a": evaluation_of(result_of([], []))}, "m")
