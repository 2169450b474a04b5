# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a chessboard for camera calibration, and prints the calibration command."""

import argparse
from typing import List, Optional

from sextant.commands.command_line import Answer, CommandParser, check_output, run
from sextant.commands.sheet_options import add_sheet_options, columns_and_rows
from sextant.printing.chessboard_sheet import Chessboard, largest_square, write_chessboard
from sextant.printing.print_layout import Paper


def main(arguments: Optional[List[str]] = None) -> int:
    """Runs the command.

    :returns: exit code: 0, or 2 for invalid arguments
    """
    return run(_parser(), arguments, _make)


def _parser() -> CommandParser:
    parser = CommandParser(prog="make_chessboard", description=__doc__)
    add_sheet_options(parser, "chessboard.pdf")
    parser.add_argument(
        "corners",
        type=columns_and_rows,
        metavar="COLUMNSxROWS",
        nargs="?",
        default=(8, 6),
        help="inner corners, as in camera_calibration: 8x6, the default, has 9 x 7 squares",
    )
    parser.add_argument(
        "--square",
        type=float,
        metavar="METRES",
        help="edge length of a square (default: the largest that fits)",
    )
    return parser


def _make(options: argparse.Namespace) -> Answer:
    check_output(options.output, options.force)
    paper, (columns, rows) = Paper(options.page, options.margin), options.corners
    square = largest_square(columns, rows, paper) if options.square is None else options.square
    board = Chessboard(columns, rows, square)
    write_chessboard(options.output, board, paper)
    return Answer(
        [
            f"{options.output}: {columns} x {rows} inner corners, squares of {square} m, {options.page}",
            "Print at 100 %, measure the 100 mm line, glue it onto a flat board. Then:",
            f"roslaunch sextant calibrate.launch size:={columns}x{rows} square:={square}",
        ]
    )
