# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import base64
import html
import re

import pytest
from html_page import Page
from made_maps import WEAK, WRONG, faulty_quality, key, made_of, map_of, marker_quality, simulated_drive

from sextant.mapping.map_findings import findings, list_findings, verdict
from sextant.mapping.map_links import Cut
from sextant.mapping.map_quality import map_quality
from sextant.mapping.map_report import MapOrigin, write_map_report

ORIGIN = MapOrigin(["drive.bag"], ["front"], 0.3, {"size": "0.2 m"})
HOSTILE = "<script>alert(1)</script>\" onload='x' &amp; {{ 7 * 7 }}\n\udcff.bag"


@pytest.fixture
def report(tmp_path):
    def written(quality, origin=ORIGIN):
        write_map_report(tmp_path / "map.html", made_of(quality), quality, origin)
        return (tmp_path / "map.html").read_text(encoding="utf-8")

    return written


@pytest.mark.slow
def test_every_finding_is_in_the_report(report):
    text = Page(report(faulty_quality())).text
    assert verdict(faulty_quality()) in text
    for finding in list_findings(faulty_quality()):
        assert str(finding) in text
    assert text.index(verdict(faulty_quality())) < text.index("Top view")


def test_a_faultless_map_has_no_list(report):
    text = report(map_of([marker_quality(1)]))
    assert "Findings" not in text and "Entries that were wrong" not in text
    assert "no problem found" in text


def test_the_note_on_links_speaks_of_weak_ones_only_if_there_are_any(report):
    links = {(key(1), key(2)): 40}
    markers = [marker_quality(1), marker_quality(2)]
    assert "weak link" not in Page(report(map_of(markers, links=links))).text
    weak = [Cut(frozenset([key(2)]), 3, ((key(2), key(1)),))]
    text = Page(report(map_of(markers, links=links, weak=weak))).text
    assert "only by a weak link" in text


def test_rows_state_the_problem_in_words(report):
    page = Page(report(faulty_quality()))
    assert page.row("0")[1] == "defines the frame"
    assert page.row("9")[1:5] == ["weak link: 3 images", "50", "50", "0"]
    assert page.row("20")[1] == "not in the map; moved, or printed twice"
    assert page.row("12")[5:7] == ["", ""]  # no residual is no zero
    assert page.row("1 and 9") == ["1 and 9", "3", "weak"]
    wrong = [row for row in page.rows if row[0] == "3"]
    assert wrong[1] == ["3", "+10.0", "+0.0", "-2.0", "10.2", "1.1", "swapped with 4"]


def test_noise_and_origin(report):
    page = Page(report(faulty_quality()))
    assert page.row("front") == ["front", "0.45", "1.50", "2.25"]
    assert "calibrate the camera again" in page.text
    assert page.row("recording") == ["recording", "drive.bag"]
    assert page.row("size") == ["size", "0.2 m"]
    assert "2.0 consecutive images" in page.text
    assert "positions of the markers from --known scatter 3.0 times" in page.text
    assert "rotations of the markers from --known" not in page.text


def test_the_file_needs_nothing_else(report):
    text = report(faulty_quality())
    assert not re.search(r"https?:|<script|<link|@import|url\(", text)
    sources = [value for name, value in Page(text).attributes if name in ("src", "href")]
    assert len(sources) == 2
    for source in sources:
        start, picture = source.split(",")
        assert start == "data:image/png;base64"
        assert base64.b64decode(picture, validate=True).startswith(b"\x89PNG")


def test_names_are_shown_as_they_are_and_do_nothing(report):
    hostile = MapOrigin([HOSTILE], [HOSTILE], 0.3, {HOSTILE: HOSTILE})
    text = report(map_of([marker_quality(1)]), hostile)
    shown = HOSTILE.replace("\udcff", "\\udcff")
    page = Page(text)
    assert "<script" not in text and "onload" not in [name for name, _ in page.attributes]
    assert page.row("recording")[1] == shown
    assert html.unescape(text).count(shown) == 4


def test_an_old_report_stays_when_the_new_one_cannot_be_written(tmp_path):
    (tmp_path / "map.html").write_text("old")
    with pytest.raises(ValueError):
        write_map_report(tmp_path / "map.html", made_of(map_of([])), map_of([]), ORIGIN)
    assert (tmp_path / "map.html").read_text() == "old"
    quality = map_of([marker_quality(1)])
    with pytest.raises(OSError):
        write_map_report(tmp_path / "absent" / "map.html", made_of(quality), quality, ORIGIN)


def test_the_report_of_a_drive(tmp_path):
    drive = simulated_drive()
    quality = map_quality(*drive)
    write_map_report(tmp_path / "map.html", drive.made, quality, ORIGIN)
    page = Page((tmp_path / "map.html").read_text(encoding="utf-8"))
    assert all(line in page.text for line in findings(quality))
    assert any(line.startswith(f"{WRONG} had a wrong entry") for line in findings(quality))
    assert any(
        line.startswith(f"{WEAK} is connected to the rest only by 3 images") for line in findings(quality)
    )
