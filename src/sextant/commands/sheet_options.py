# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Options of the commands that make sheets to print."""

import argparse
from pathlib import Path
from typing import Tuple

from sextant.printing.print_layout import PAGES, Paper


def add_sheet_options(parser: argparse.ArgumentParser, output: str) -> None:
    """:param output: default of the file's name"""
    parser.add_argument("--page", choices=PAGES, default=Paper.page, help="paper (default: %(default)s)")
    parser.add_argument(
        "--margin",
        type=float,
        default=Paper.margin,
        metavar="METRES",
        help="along the paper's edge, where the printer cannot print (default: %(default)s)",
    )
    parser.add_argument(
        "-o", "--output", type=Path, default=Path(output), help="PDF file (default: %(default)s)"
    )
    parser.add_argument("--force", action="store_true", help="overwrite files that are there")


def columns_and_rows(text: str) -> Tuple[int, int]:
    """:raises argparse.ArgumentTypeError: it is not written as 4x3."""
    columns, cross, rows = text.partition("x")
    if not (cross and columns.isdecimal() and rows.isdecimal()):
        raise argparse.ArgumentTypeError(f"'{text}' is not written as COLUMNSxROWS, e.g. 4x3")
    return int(columns), int(rows)
