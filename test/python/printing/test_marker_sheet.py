# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sheets as another program shows them: what the detector reads there, lengths measured in the pictures."""

import re
from pathlib import Path

import numpy as np
import pytest
from printed_pages import detector, paper, pictures, poppler, texts

import sextant
from sextant.printing.marker_shape import black_boxes, marker_shape
from sextant.printing.marker_sheet import SheetParams, id_ranges, write_sheets
from sextant.printing.print_layout import PAGES

DPI = 150
MM = 25.4 / DPI  # edge of a pixel

# Modules along the edge that `size` measures and along the whole print, as the families' own pages draw them.
MODULES = {
    "tag36h11": (8, 8),
    "tag25h9": (7, 7),
    "tagStandard41h12": (5, 9),
    "tagStandard52h13": (6, 10),
    "tagCircle21h7": (5, 9),
    "tagCircle49h12": (5, 11),
    "tagCustom48h12": (6, 10),
    "DICT_4X4_50": (6, 6),
    "DICT_7X7_1000": (9, 9),
    "DICT_ARUCO_ORIGINAL": (7, 7),
}
CASES = [
    # family, ids, size, page, most, sheets
    ("tag36h11", [7, 8], 0.16, "A4", 0, 2),
    ("tag36h11", list(range(5)), 0.06, "Letter", 0, 1),
    ("tag25h9", [34, 0, 1], 0.2, "A3", 0, 3),
    ("tagStandard41h12", list(range(30)), 0.012, "Letter", 0, 1),
    ("tagStandard52h13", [1, 2, 3, 4, 5], 0.03, "A4", 2, 3),
    ("tagCircle21h7", [0, 37], 0.04, "A4", 0, 1),
    ("tagCircle49h12", [65534], 0.09, "A3", 0, 1),
    ("tagCustom48h12", [42210, 3], 0.05, "Letter", 1, 2),
    ("DICT_4X4_50", list(range(50)), 0.05, "A3", 0, 3),
    ("DICT_7X7_1000", [999, 500], 0.09, "A4", 0, 1),
    ("DICT_ARUCO_ORIGINAL", [1023, 1, 512, 77], 0.07, "Letter", 0, 1),
]


@pytest.fixture(scope="module", params=CASES, ids=lambda case: f"{case[0]}-{case[3]}-{case[4]}")
def printed(request, tmp_path_factory):
    """(case, its PDF, [(picture, markers found in it)])"""
    family, ids, size, page, most, _ = request.param
    pdf = tmp_path_factory.mktemp("printed") / "sheets.pdf"
    write_sheets(pdf, family, ids, size, SheetParams(page=page, max_per_page=most))
    search = detector(family)
    return request.param, pdf, [(picture, search.detect(picture)) for picture in pictures(pdf, DPI)]


def write(folder, family="tag36h11", ids=(0,), size=0.1, **params):
    pdf = folder / "sheets.pdf"
    write_sheets(pdf, family, ids, size, SheetParams(**params))
    return pdf


# ---- what the detector sees -----------------------------------------------------------------------------


@pytest.mark.slow
def test_every_printed_id_is_read_and_no_other(printed):
    (family, ids, _, _, _, sheets), _, pages = printed
    found = [(marker.family, marker.id) for _, markers in pages for marker in markers]
    assert sorted(found) == [(family, id) for id in sorted(ids)]
    assert len(pages) == sheets
    on_pages = [len(markers) for _, markers in pages]
    assert on_pages == sorted(on_pages, reverse=True)


def test_markers_are_as_large_as_stated_and_upright(printed):
    (_, _, size, _, _, _), _, pages = printed
    for marker in (marker for _, markers in pages for marker in markers):
        edges = MM * (np.roll(marker.corners, -1, axis=0) - marker.corners)
        # corners begin top left; rows of the picture count downward
        expected = 1000.0 * size * np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])
        np.testing.assert_allclose(edges, expected, atol=0.1)


def around(marker, edge, reach):
    """Rows and columns of the picture between two squares around a marker, these in parts of its size."""
    middle, size = marker.corners.mean(axis=0), np.ptp(marker.corners[:, 0])
    inner, outer = (
        [(middle - 0.5 * part * size).round().astype(int), (middle + 0.5 * part * size).round().astype(int)]
        for part in (edge, reach)
    )
    return inner, outer


def test_quiet_zone_is_free_of_ink(printed):
    (family, _, _, _, _, _), _, pages = printed
    border, whole = MODULES[family]
    for picture, marker in ((picture, marker) for picture, markers in pages for marker in markers):
        inner, outer = around(marker, whole / border, (whole + 2.0) / border)
        zone = picture.copy()
        zone[inner[0][1] - 1 : inner[1][1] + 3, inner[0][0] - 1 : inner[1][0] + 3] = 255  # the print itself
        zone = zone[outer[0][1] + 1 : outer[1][1] - 1, outer[0][0] + 1 : outer[1][0] - 1]
        assert zone.size > 1000 and zone.min() == 255
        dark = picture[inner[0][1] + 2 : inner[1][1] - 2, inner[0][0] + 2 : inner[1][0] - 2]
        assert (
            min(dark[[0, -1]].min(), dark[:, [0, -1]].min()) == 0
        )  # so the zone begins where the print ends


def test_white_rim_can_be_wider(tmp_path):
    pdf = write(tmp_path, ids=[0, 1], size=0.05, quiet_zone=3.0)
    [picture] = pictures(pdf, DPI)
    markers = detector("tag36h11").detect(picture)
    assert len(markers) == 2
    for marker in markers:
        inner, outer = around(marker, 1.0, 14.0 / 8.0)
        zone = picture.copy()
        zone[inner[0][1] - 1 : inner[1][1] + 3, inner[0][0] - 1 : inner[1][0] + 3] = 255
        assert zone[outer[0][1] + 1 : outer[1][1] - 1, outer[0][0] + 1 : outer[1][0] - 1].min() == 255


def test_no_seams_between_modules(tmp_path):
    """Where the modules' edges fall into the middle of pixels there are no grey ones inside."""
    pdf = write(tmp_path, size=0.05)
    for dpi in (71, 97):
        [picture] = pictures(pdf, dpi)
        [marker] = detector("tag36h11").detect(picture)
        left, top = np.ceil(marker.corners[0]).astype(int) + 2
        right = int(marker.corners[1][0]) - 2
        module = 0.05 / 8.0 * 1000.0 / 25.4 * dpi
        assert picture[top : top + int(module) - 4, left:right].max() == 0  # the upper border
        assert (
            picture[top : top + int(8 * module) - 6, left : left + int(module) - 4].max() == 0
        )  # the left one


@pytest.mark.parametrize("family", sextant.marker_families())
def test_nothing_is_black_beyond_the_total_width(family):
    half = 0.5 * marker_shape(family).total_width / marker_shape(family).width_at_border
    for id in {0, 1, sextant.family_size(family) - 1}:
        boxes = np.array(black_boxes(family, id, 1.0, 0.0, 0.0))
        assert np.abs(boxes).max() == pytest.approx(half)
        modules, _, _ = sextant.marker_image(family, id)
        area = np.sum((boxes[:, 2] - boxes[:, 0]) * (boxes[:, 3] - boxes[:, 1]))
        assert area * marker_shape(family).width_at_border ** 2 == pytest.approx(np.sum(modules < 128))


# ---- what people see ------------------------------------------------------------------------------------


def test_pages_have_the_paper_size(printed):
    (_, _, _, page, _, _), pdf, _ = printed
    assert sorted(paper(pdf)) == pytest.approx([1000.0 * edge for edge in PAGES[page]], abs=0.01)


def test_sheets_describe_what_is_on_them(printed):
    (family, _, size, _, _, sheets), pdf, pages = printed
    for number, (words, (_, markers)) in enumerate(zip(texts(pdf), pages)):
        ids = [int(word) for before, word in zip(words, words[1:]) if before == "id"]
        assert sorted(ids) == sorted(marker.id for marker in markers)
        assert words.count(family) == len(markers)
        line = " ".join(words)
        assert len(re.findall(rf"\b{1000.0 * size:g} mm", line)) == len(markers)  # the length below each
        assert f"{family}, size {size} m: " in line and "100 mm long" in line
        assert (f"sheet {number + 1} of {sheets}" in line) == (sheets > 1)


def word_places(pdf):
    """{word: left, top, right and bottom in pixels} where it first is on the first page."""
    pattern = r'xMin="([\d.]+)" yMin="([\d.]+)" xMax="([\d.]+)" yMax="([\d.]+)">(.*)</word>'
    found = re.findall(pattern, poppler("pdftotext", "-l", 1, "-bbox", pdf, "-"))
    return {word: np.array(box, float) * DPI / 72.0 for *box, word in reversed(found)}


def test_ids_stand_below_their_markers(tmp_path):
    pdf = write(tmp_path, ids=list(range(20, 29)), size=0.051)
    [picture] = pictures(pdf, DPI)
    places = word_places(pdf)
    markers = detector("tag36h11").detect(picture)
    markers.sort(key=lambda marker: tuple(marker.corners[0].round()[::-1]))
    assert [marker.id for marker in markers] == list(range(20, 29))  # as one reads
    for marker in markers:
        below = (places[str(marker.id)][:2] - marker.corners[3]) * MM
        assert 0.0 < below[0] < 25.0 and 5.0 < below[1] < 20.0


@pytest.mark.parametrize("family", ["tag36h11", "tagCircle49h12"])
def test_line_below_shows_what_the_size_measures(tmp_path, family):
    pdf = write(tmp_path, family, ids=[8], size=0.071)
    [picture] = pictures(pdf, DPI)
    [marker] = detector(family).detect(picture)
    left, bottom = marker.corners[3]
    right = marker.corners[2][0]
    border, whole = MODULES[family]
    begin = int(bottom + 71.0 / MM * (0.5 * (whole / border - 1.0) + 1.0 / border))  # of the label
    dark = picture[begin : begin + int(10.0 / MM)] < 128
    longest = np.flatnonzero(dark[np.argmax(dark.sum(axis=1) - 1e3 * (dark[:, int(left) - 9]))])
    assert [longest[0], longest[-1]] == pytest.approx([left, right], abs=1.5)
    places = word_places(pdf)
    assert 0.5 * (places["71"][0] + places["mm"][2]) == pytest.approx(0.5 * (left + right), abs=1.0 / MM)


def test_id_is_read_from_two_metres(tmp_path):
    """Letters of a 200th of the distance are read with ease: 10 mm."""
    pdf = write(tmp_path, ids=[7], size=0.16)
    left, top, right, bottom = word_places(pdf)["7"].astype(int)
    [picture] = pictures(pdf, DPI)
    rows = np.flatnonzero(picture[top:bottom, left:right].min(axis=1) < 128)
    assert (np.ptp(rows) + 1) * MM >= 10.0


@pytest.mark.parametrize("page", PAGES)
def test_control_line_is_100_mm_long(tmp_path, page):
    dpi = 300
    [picture] = pictures(write(tmp_path, size=0.02, page=page), dpi)
    black = picture < 128
    longest = max(range(len(picture) * 3 // 4, len(picture)), key=lambda row: black[row].sum())
    columns = np.flatnonzero(black[longest])
    assert np.all(np.diff(columns) == 1)
    # between the middles of the first and the last tick, which stand out above the line
    ticks = np.flatnonzero(black[longest - round(2.0 / 25.4 * dpi)])
    groups = [group.mean() for group in np.split(ticks, np.flatnonzero(np.diff(ticks) > 1) + 1)]
    np.testing.assert_allclose(25.4 / dpi * np.diff(groups), [50.0, 50.0], atol=0.1)
    assert groups[0] == pytest.approx(columns[0], abs=2) and groups[-1] == pytest.approx(columns[-1], abs=2)


def test_file_is_a_vector_file_that_prints_as_it_is(tmp_path):
    pdf = write(tmp_path)
    assert len(poppler("pdfimages", "-list", pdf).splitlines()) == 2  # its heading
    fonts = poppler("pdffonts", pdf).splitlines()[2:]
    assert fonts and all(line.split()[-5] == "yes" for line in fonts)  # in the file
    assert b"/PrintScaling /None" in pdf.read_bytes()


def test_same_sheets_are_the_same_bytes(tmp_path):
    assert write(tmp_path).read_bytes() == write(tmp_path).read_bytes()


def test_id_ranges_keep_the_order():
    assert id_ranges([0, 1, 2, 12]) == "0-2,12"
    assert id_ranges([5, 4, 7, 8]) == "5,4,7-8"


# ---- what is refused ------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("margin", [0.008, 0.03])
@pytest.mark.parametrize("family", ["tag36h11", "tagCircle49h12", "DICT_4X4_50"])
def test_largest_size_that_is_reported_fits_and_no_larger_one(tmp_path, family, margin):
    with pytest.raises(ValueError, match=r"1\.5 m does not fit on A4; at most ") as refused:
        write(tmp_path, family, size=1.5, margin=margin)
    found = re.findall(r"([\d.]+) m on (\w+)(?:,|$)", str(refused.value))
    reported = {page: float(size) for size, page in found}
    assert list(reported) == list(PAGES)
    for page, size in reported.items():
        pdf = write(tmp_path, family, size=size, page=page, margin=margin)
        width, height = paper(pdf)
        [picture] = pictures(pdf, 72)
        places = word_places(pdf)
        assert (places["This"][1] - places["0"][3]) * MM > 6.0  # the label ends above the control line
        ink = np.argwhere(picture < 100) * 25.4 / 72.0  # cut marks are lighter
        assert ink.min() > 1000.0 * margin - 0.5
        assert np.all(ink.max(axis=0) < [height - 1000.0 * margin + 0.5, width - 1000.0 * margin + 0.5])
        with pytest.raises(ValueError, match="does not fit"):
            write(tmp_path, family, size=size + 0.0001, page=page, margin=margin)


@pytest.mark.parametrize(
    "wrong, reason",
    [
        (dict(family="tag99h9"), "tag36h11"),
        (dict(ids=[]), "no id"),
        (dict(ids=[0, 587]), "id 587 is not in tag36h11, which has 0 to 586"),
        (dict(ids=[-1]), "id -1"),
        (dict(ids=[3, 1, 3]), "id 3 is given twice"),
        (dict(size=0.0), "size is 0.0 m"),
        (dict(size=float("nan")), "size is nan m"),
        (dict(page="A5"), "page: must be one of A4, A3, Letter, is"),
        (dict(margin=-0.01), "margin: must be"),
        (dict(quiet_zone=0.0), "quiet_zone: must be"),
        (dict(max_per_page=-1), "max_per_page: must be"),
    ],
)
def test_what_is_refused(tmp_path, wrong, reason):
    with pytest.raises(ValueError, match=re.escape(reason)):
        write(tmp_path, **wrong)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_not_there(tmp_path):
    with pytest.raises(OSError):
        write(Path(tmp_path / "absent"))
