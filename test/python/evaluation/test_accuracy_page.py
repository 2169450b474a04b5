# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import re
from dataclasses import replace

import numpy as np
import pytest
from html_page import Page

from sextant.evaluation.accuracy_page import write_page
from sextant.evaluation.pose_series import GroundTruth, pose_series, series_statistics

PICTURE = b"\x89PNG picture"
FACING = GroundTruth(others={"roll": np.pi})
HOSTILE = "<script>alert(1)</script>.bag"


@pytest.fixture
def page(tmp_path):
    """Writes the page of poses that are 3 cm too high (first method) or 10 cm (second) at two distances."""
    (tmp_path / "accuracy_errors.png").write_bytes(PICTURE)

    def written(methods=("nearest", "joint"), truth=FACING):
        series = []
        for method, bias in zip(methods, (0.10, 0.03)):
            for distance, count in ((1.0, 3), (2.0, 0)):
                poses = np.tile([0.0, bias, distance, np.pi, 0.0, 0.0], (count, 1))
                one = pose_series(distance, HOSTILE, range(count), poses, images=4)
                series.append(replace(one, method=method))
        statistics = [series_statistics(each, truth) for each in series]
        plots = [tmp_path / "accuracy_errors.png"]
        write_page(tmp_path / "accuracy.html", series, statistics, plots, ["a note"])
        return (tmp_path / "accuracy.html").read_text()

    return written


def test_methods_side_by_side(page):
    read = Page(page())
    nearest, joint = (["75.0", bias, "0.00", bias, bias] for bias in ("10.00", "3.00"))
    assert ["1 m", *nearest, *joint] in read.rows
    assert [row for row in read.rows if row[:1] == ["joint"]][0][1:3] == ["3 of 8 (37.5 %)", "3.00"]
    assert ["1 m", "truth", "0.000", "0.000", "1.000", "180.00", "0.00", "0.00"] in read.rows
    assert ["1 m", "joint", "0.000", "0.030", "1.000", "180.00", "0.00", "0.00"] in read.rows
    assert ["joint 1 m", "y", "cm", "3.00", "0.00", "3.00", "3.00"] in read.rows
    assert ["2 m", "joint", "–", "–", "–", "–", "–", "–"] in read.rows
    assert "nearest: 10.0 cm mean error, 95 % below 10.0 cm, worst 10.0 cm" in read.text
    assert "a note" in read.text


def test_one_method_without_a_true_position(page):
    unknown = GroundTruth(others=dict.fromkeys(("x", "y", "roll", "pitch", "yaw")))
    read = Page(page(methods=("",), truth=unknown))
    assert "the true position is unknown" in read.text
    assert [row[1] for row in read.rows if row[:1] == ["1 m"] and len(row) == 7] == ["z"]


def test_the_page_needs_nothing_else_and_names_do_nothing(page):
    text = page()
    assert not re.search(r"https?:|<script|<link|@import|url\(", text)
    assert HOSTILE in Page(text).text
    sources = [value for name, value in Page(text).attributes if name in ("src", "href")]
    assert len(sources) == 1 and sources[0].startswith("data:image/png;base64,")
