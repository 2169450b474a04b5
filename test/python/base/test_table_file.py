# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The same table as text, CSV and Markdown."""

import csv

import pytest

from sextant.base.html_report import Row, Table
from sextant.base.table_file import text_table, write_table

TABLE = Table(("method", "index,\nMB"), [Row(("a|b, c", "1.5")), Row(("d", "12.25"))])


def test_text_has_columns_below_heads_of_several_lines():
    assert text_table(TABLE).splitlines() == [
        "        index,",
        "method      MB",
        "a|b, c     1.5",
        "d        12.25",
    ]


def test_csv_is_read_back(tmp_path):
    write_table(tmp_path / "a.csv", TABLE)
    with open(tmp_path / "a.csv", newline="") as file:
        assert list(csv.reader(file)) == [["method", "index, MB"], ["a|b, c", "1.5"], ["d", "12.25"]]


def test_markdown_escapes_its_bars(tmp_path):
    write_table(tmp_path / "a.md", TABLE)
    assert (tmp_path / "a.md").read_text().splitlines() == [
        "| method | index, MB |",
        "| --- | ---: |",
        "| a\\|b, c | 1.5 |",
        "| d | 12.25 |",
    ]


def test_another_ending_is_refused(tmp_path):
    with pytest.raises(ValueError, match="a.xlsx: the ending must be one of .csv, .md, .txt"):
        write_table(tmp_path / "a.xlsx", TABLE)
    assert not list(tmp_path.iterdir())
