# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tables of reports as text, CSV and Markdown."""

import csv
import io
from pathlib import Path
from typing import Callable, Dict

from sextant.base.atomic_file import atomic_file
from sextant.base.html_report import Table


def text_table(table: Table) -> str:
    """Formats a table with columns of equal width; each line of a head is a line."""
    heads = [head.split("\n") for head in table.heads]
    height = max(map(len, heads))
    lines = [[([""] * (height - len(head)) + head)[i] for head in heads] for i in range(height)]
    lines += [list(row.cells) for row in table.rows]
    widths = [max(map(len, column)) for column in zip(*lines)]
    texts = []
    for line in lines:
        cells = [
            cell.ljust(width) if column in table.text_columns else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(line, widths))
        ]
        texts.append("  ".join(cells).rstrip())
    return "".join(f"{text}\n" for text in texts)


def markdown_table(table: Table) -> str:
    """Formats a table as Markdown."""
    rules = ["---" if i in table.text_columns else "---:" for i in range(len(table.heads))]
    rows = [table.heads, rules, *(row.cells for row in table.rows)]
    lines = [" | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in row) for row in rows]
    return "".join(f"| {line} |\n" for line in lines)


def csv_table(table: Table) -> str:
    """Formats a table as CSV."""
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(head.replace("\n", " ") for head in table.heads)
    writer.writerows(row.cells for row in table.rows)
    return file.getvalue()


FORMATS: Dict[str, Callable[[Table], str]] = {
    ".csv": csv_table,
    ".md": markdown_table,
    ".txt": text_table,
}


def check_table_path(path: Path) -> None:
    """:raises ValueError: the ending is not one of FORMATS"""
    if path.suffix not in FORMATS:
        raise ValueError(f"{path}: the ending must be one of {', '.join(FORMATS)}")


def write_table(path: Path, table: Table) -> None:
    """Writes a table atomically, in the format of the file's ending.

    :raises OSError: the file cannot be written
    :raises ValueError: see check_table_path()
    """
    check_table_path(path)
    with atomic_file(path) as file:
        file.write(FORMATS[path.suffix](table))
