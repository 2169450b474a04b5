# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page of an evaluation: one file with all figures."""

import base64

import cv2
import numpy as np
import pytest
from html_page import Page
from made_evaluations import evaluation_of, half_right, result_of

from sextant.base.html_report import Row, Table
from sextant.place_reports.place_evaluation_page import write_evaluation_page

HOSTILE = "<script>alert(1)</script> {{ 7 * 7 }}"


@pytest.fixture
def page(tmp_path):
    plot = tmp_path / "comparison.png"
    cv2.imwrite(str(plot), np.zeros((4, 4, 3), np.uint8))

    def written(evaluations, what="Map: park.txt.", comparison=None):
        write_evaluation_page(
            tmp_path / "a.html", what, evaluations, "m", [plot], list(evaluations)[:1], comparison
        )
        return Page((tmp_path / "a.html").read_text()), plot.read_bytes()

    return written


def test_figures_predictors_and_plots_are_on_the_page(page):
    comparison = Table(("method", "keypoints"), [Row(("orb", "500"))])
    found, plot = page({"orb": half_right(), "orb, 3 clusters": half_right(10)}, comparison=comparison)
    assert ["orb", "500"] in found.rows
    figures = next(row for row in found.rows if row[0] == "orb" and len(row) > 2)
    assert figures[1:4] == ["40", "0", "0.500"]
    assert found.row("correct, wrong") == ["correct, wrong", "20, 20"]  # of exact positions only
    assert found.row("area by chance")[1] == "0.32 to 0.68"
    assert found.row("mean distance")[1].endswith("↓") and found.row("probability")[1] == "0.50"
    assert f"data:image/png;base64,{base64.b64encode(plot).decode()}" in dict(found.attributes).values()


def test_what_is_unknown_is_a_dash(page):
    found, _ = page({"single": evaluation_of(result_of([1], []))})
    assert found.row("probability") == ["probability", "–"]
    assert found.row("area by chance")[1] == "–" and "Comparison" not in found.text


def test_names_are_text(page):
    found, _ = page({"single": half_right(4)}, HOSTILE)
    assert HOSTILE in found.text and all(name != "onload" for name, _ in found.attributes)
