# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""LibreOffice computes the workbook's formulas: its numbers have to be numpy's."""

import shutil
import subprocess

import numpy as np
import openpyxl
import pytest

from sextant.evaluation.accuracy_workbook import write_workbook
from sextant.evaluation.pose_series import AXES, GroundTruth, by_distance, pose_series, series_statistics

TRUTHS = GroundTruth(others={"roll": np.pi, "x": None})
START = 1700000000 * 10**9
SIGMA = np.array([0.01, 0.02, 0.03, 0.04, 0.05, 0.06])


def bag(distance, name, count, seed, published=True):
    random = np.random.default_rng(seed)
    root = 0.02 * random.normal(size=(6, 6))
    poses = random.normal(size=(count, 6)) @ root + [0.3, 0.01, distance + 0.05, np.pi, 0.0, 0.02]
    poses[:, 3:] = (poses[:, 3:] + np.pi) % (2 * np.pi) - np.pi
    covariances = np.tile(np.diag(SIGMA**2), (count, 1, 1)) if published else None
    stamps = START + np.arange(count) * 33333333
    return pose_series(distance, name, stamps, poses, covariances, start=START + 1)


def recorded():
    return by_distance(
        [
            bag(0.757, "a.bag", 21, 1),
            bag(0.757, "=1+1\x07\udcff.bag", 11, 2),
            bag(2.5, "b.bag", 31, 3),
            bag(4.0, "one pose.bag", 2, 4, published=False),
            bag(7.0, "nothing.bag", 0, 5),
        ]
    )


def write(path, series=None):
    series = recorded() if series is None else series
    statistics = [series_statistics(each, TRUTHS) for each in series]
    write_workbook(path, series, statistics)
    return statistics


@pytest.fixture(scope="module")
def book(tmp_path_factory):
    path = tmp_path_factory.mktemp("book") / "accuracy.xlsx"
    write(path)
    return openpyxl.load_workbook(path)


def rows(sheet, first=2):
    return [[cell.value for cell in row] for row in sheet.iter_rows(min_row=first)]


def test_sheets(book):
    assert book.sheetnames == ["errors", "summary", "covariance", "bags", "0.757 m", "2.5 m", "4 m", "7 m"]
    for sheet in book:
        assert sheet.freeze_panes is not None
        assert sheet.print_title_rows == "$1:$1"
        assert sheet.page_setup.fitToHeight == 0 and sheet.sheet_properties.pageSetUpPr.fitToPage


def test_raw_poses(book):
    series = recorded()[0]
    sheet = book["0.757 m"]
    headings = [cell.value for cell in sheet[1]]
    assert headings[:6] == ["time since the first pose, s", "stamp, s", "bag", "x, m", "y, m", "z, m"]
    assert headings[6:9] == ["roll, rad, unwrapped", "pitch, rad", "yaw, rad"]
    assert headings[9:] == [f"sigma {axis}, {unit}" for axis, unit in zip(AXES, 3 * ["m"] + 3 * ["rad"])]
    table = rows(sheet)
    assert len(table) == len(series.poses) == 30
    assert table[1][:3] == [pytest.approx(0.033333333), "1700000000.066666666", "a.bag"]
    assert np.array([row[3:6] for row in table]) == pytest.approx(series.poses[:, :3])
    assert np.cos([row[6] for row in table]) == pytest.approx(np.cos(series.poses[:, 3]))
    assert np.ptp([row[6] for row in table]) < 1.0
    assert np.array(table[0][9:]) == pytest.approx(SIGMA, rel=0.01)
    assert [cell.value for cell in book["4 m"][1]][-1] == "yaw, rad"


def test_a_name_is_a_text_whatever_it_looks_like(book):
    cell = book["0.757 m"].cell(25, 3)
    assert (cell.value, cell.data_type) == ("=1+1??.bag", "s")


def test_bags(book):
    assert rows(book["bags"])[:5] == [
        [0.757, "a.bag", 20, 1, 0, "unknown"],
        [0.757, "=1+1??.bag", 10, 1, 0, "unknown"],
        [2.5, "b.bag", 30, 1, 0, "unknown"],
        [4, "one pose.bag", 1, 1, 0, "unknown"],
        [7, "nothing.bag", 0, 0, 0, "unknown"],
    ]


def computed(path, folder):
    """The workbook as LibreOffice computes it; without a display, and without the user's settings."""
    office = shutil.which("soffice")
    if office is None:
        pytest.skip("LibreOffice is not installed (soffice), formulas cannot be computed")
    command = [office, f"-env:UserInstallation=file://{folder}/settings", "--headless"]
    command += ["--convert-to", "xlsx", "--outdir", str(folder / "computed"), str(path)]
    subprocess.run(command, check=True, timeout=120, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return openpyxl.load_workbook(folder / "computed" / path.name, data_only=True)


@pytest.fixture(scope="module")
def formulas(tmp_path_factory):
    folder = tmp_path_factory.mktemp("formulas")
    statistics = write(folder / "accuracy.xlsx")
    return computed(folder / "accuracy.xlsx", folder), statistics


def numbers(values):
    return [np.nan if isinstance(value, str) else value for value in values]


def test_formulas_compute_the_statistics(formulas):
    book, statistics = formulas
    table = rows(book["summary"])
    for each, first in zip(statistics, range(0, 24, 6)):
        for axis, row in enumerate(table[first : first + 6]):
            assert row[:4] == [each.distance, AXES[axis], "m" if axis < 3 else "rad", each.count]
            columns = (each.truth, each.mean, each.std, each.bias, each.rmse, each.published)
            assert numbers(row[4:10]) == pytest.approx([column[axis] for column in columns], nan_ok=True)
            assert not any(str(value).startswith(("#", "Err")) for value in row)


def test_what_is_not_defined_is_marked(formulas):
    table = rows(formulas[0]["summary"])
    assert table[0][4] == table[0][7] == table[0][8] == "unknown"
    assert table[12 + 2][6] == "undefined" and table[12 + 2][8] == pytest.approx(table[12 + 2][7])
    assert table[18 + 2][3:] == [0, 7.0, "undefined", "undefined", "undefined", "undefined", "none"]


def test_formulas_compute_the_covariances(formulas):
    book, statistics = formulas
    table = [row[2:8] for row in rows(book["covariance"])]
    for i, each in enumerate(statistics):
        block = [numbers(row) for row in table[6 * i : 6 * i + 6]]
        assert np.array(block) == pytest.approx(each.covariance, nan_ok=True)


@pytest.mark.parametrize("name", ["accuracy.ods", "accuracy", "accuracy.xls"])
def test_a_name_of_another_kind_of_file(tmp_path, name):
    with pytest.raises(ValueError, match="must end in .xlsx"):
        write(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_what_makes_no_workbook(tmp_path):
    series = recorded()
    statistics = [series_statistics(each, TRUTHS) for each in series]
    with pytest.raises(ValueError, match="a workbook needs series"):
        write_workbook(tmp_path / "a.xlsx", [], [])
    with pytest.raises(ValueError, match="in the same order"):
        write_workbook(tmp_path / "a.xlsx", series, statistics[::-1])
    with pytest.raises(ValueError, match="two series have the same distance"):
        write_workbook(tmp_path / "a.xlsx", series[:1] * 2, statistics[:1] * 2)
    with pytest.raises(OSError):
        write(tmp_path / "absent" / "a.xlsx")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_thousands_of_poses(tmp_path):
    write(tmp_path / "a.xlsx", [bag(1.0, "a.bag", 3000, 1)])
    sheet = openpyxl.load_workbook(tmp_path / "a.xlsx")["summary"]
    assert sheet["D2"].value == "=COUNT('1 m'!$D$2:$D$3000)"
