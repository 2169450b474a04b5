# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Options of commands that make sheets to print."""

import argparse
from pathlib import Path
from typing import Tuple

from sextant.commands.command_line import whole_pair
from sextant.printing.print_layout import PAGES, Paper


def add_sheet_options(parser: argparse.ArgumentParser, output: str) -> None:
    """Adds the options of paper and output file.

    :param output: default file name
    """
    parser.add_argument("--page", choices=PAGES, default=Paper.page, help="page size (default: %(default)s)")
    parser.add_argument(
        "--margin",
        type=float,
        default=Paper.margin,
        metavar="METRES",
        help="unprintable margin of the page (default: %(default)s)",
    )
    parser.add_argument(
        "-o", "--output", type=Path, default=Path(output), help="PDF file (default: %(default)s)"
    )
    parser.add_argument("--force", action="store_true", help="overwrite existing files")


def columns_and_rows(text: str) -> Tuple[int, int]:
    """Parses COLUMNSxROWS.

    :raises argparse.ArgumentTypeError: another form
    """
    return whole_pair(text, "COLUMNSxROWS, e.g. 4x3")
