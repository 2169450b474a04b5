# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the commands that make sheets to print have in common on the command line."""

import argparse
import sys
from pathlib import Path
from typing import Callable, List, Optional, Tuple

from sextant.markers.print_layout import PAGES, Paper


class PrintParser(argparse.ArgumentParser):
    """Has the options of every sheet; what is wrong is told in one line."""

    def __init__(self, output: str, **settings):
        super().__init__(formatter_class=argparse.RawDescriptionHelpFormatter, **settings)
        self.add_argument("--page", choices=PAGES, default=Paper.page, help="paper (default: %(default)s)")
        self.add_argument(
            "--margin",
            type=float,
            default=Paper.margin,
            metavar="METRES",
            help="along the paper's edge, where the printer cannot print (default: %(default)s)",
        )
        self.add_argument(
            "-o", "--output", type=Path, default=Path(output), help="PDF file (default: %(default)s)"
        )
        self.add_argument("--force", action="store_true", help="overwrite files that are there")

    def error(self, message: str) -> None:
        raise ValueError(message)


def run(
    parser: PrintParser, arguments: Optional[List[str]], work: Callable[[argparse.Namespace], List[str]]
) -> int:
    """Prints the lines that the work returns, or in one line why there are none.

    :returns: exit code, 0 or 2
    """
    try:
        print("\n".join(work(parser.parse_args(arguments))))
        return 0
    except OSError as error:
        # its file is a temporary one beside that which was asked for
        folder = f"into {Path(error.filename).parent}" if error.filename else "the file"
        print(f"{parser.prog}: cannot write {folder}: {error.strerror}", file=sys.stderr)
    except (ValueError, RuntimeError) as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
    return 2


def check_output(path: Path, force: bool) -> None:
    """Before anything is computed or written.

    :raises ValueError: the file is there and is not to be overwritten, or has no folder
    """
    if not path.parent.is_dir():
        raise ValueError(f"{path}: there is no folder {path.parent}")
    if path.is_dir():
        raise ValueError(f"{path} is a folder")
    if path.exists() and not force:
        raise ValueError(f"{path} is there already; --force overwrites it")


def columns_and_rows(text: str) -> Tuple[int, int]:
    """:raises argparse.ArgumentTypeError: it is not written as 4x3."""
    columns, cross, rows = text.partition("x")
    if not (cross and columns.isdecimal() and rows.isdecimal()):
        raise argparse.ArgumentTypeError(f"'{text}' is not written as COLUMNSxROWS, e.g. 4x3")
    return int(columns), int(rows)
