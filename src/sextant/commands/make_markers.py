# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes sheets of markers to print, and their marker map."""

import argparse
import shlex
from pathlib import Path
from typing import List, Optional

import sextant
from sextant.commands.command_line import Answer, CommandParser, check_output, run
from sextant.commands.sheet_options import add_sheet_options, columns_and_rows
from sextant.printing.board_sheet import BoardParams, rounded_min_gap, write_board
from sextant.printing.map_template import write_map_template
from sextant.printing.marker_shape import check_size
from sextant.printing.marker_sheet import SheetParams, write_sheets

_EXAMPLES = """\
examples:
  make_markers tag36h11 0-7,12 --size 0.16 --map map.yaml
  make_markers DICT_4X4_50 0-49 --size 0.05 --page A3
  make_markers tag36h11 0-11 --size 0.04 --board 4x3 --map board.yaml
"""
_NEXT = "Print at 100 %, measure the 100 mm line, mount. Then (robot.launch takes the same arguments):"
_MAX_IDS = 10000  # more are considered a typing error


def main(arguments: Optional[List[str]] = None) -> int:
    """Runs the command.

    :returns: exit code: 0, or 2 for invalid arguments
    """
    return run(_parser(), arguments, _make)


def _parser() -> CommandParser:
    parser = CommandParser(prog="make_markers", description=__doc__, epilog=_EXAMPLES)
    add_sheet_options(parser, "markers.pdf")
    parser.add_argument("family", help="dictionary or family: tag36h11, DICT_4X4_50, ...")
    parser.add_argument("ids", type=_ids, help="e.g. 0-7,12; for a board row by row from the top left")
    parser.add_argument(
        "--size", type=float, required=True, metavar="METRES", help="edge length, printed on the sheet"
    )
    parser.add_argument("--map", type=Path, metavar="FILE", help="also write a marker map, .yaml")
    parser.add_argument(
        "--max-per-page", type=int, metavar="N", help="maximum number of markers (default: as many as fit)"
    )
    parser.add_argument(
        "--quiet-zone",
        type=float,
        default=SheetParams.quiet_zone,
        metavar="MODULES",
        help="width of the white rim around markers (default: %(default)s)",
    )
    parser.add_argument(
        "--board", type=columns_and_rows, metavar="COLUMNSxROWS", help="print a grid of markers on one sheet"
    )
    parser.add_argument(
        "--gap",
        type=float,
        metavar="METRES",
        help="between adjacent markers of a board (default: the white rim)",
    )
    return parser


def _ids(text: str) -> List[int]:
    """Parses numbers and inclusive ranges, e.g. "0-7,12"."""
    ids: List[int] = []
    for part in text.split(","):
        first, dash, last = part.partition("-")
        last = last if dash else first
        if not (first.isdecimal() and last.isdecimal() and int(first) <= int(last)):
            raise argparse.ArgumentTypeError(f"'{part}' is neither an id nor a range of ids such as 0-7")
        if len(ids) + int(last) - int(first) >= _MAX_IDS:
            raise argparse.ArgumentTypeError(f"more than {_MAX_IDS} ids")
        ids += range(int(first), int(last) + 1)
    return ids


def _make(options: argparse.Namespace) -> Answer:
    _check(options)
    options.family = sextant.canonical_family(options.family)  # as in detections and maps
    lines = _make_sheets(options) if options.board is None else _make_board(options)
    arguments = [f"families:=[{options.family}]", f"marker_size:={options.size}"]
    if options.map is not None:
        arguments.append(f"map:={options.map.resolve()}")
    command = " ".join(["roslaunch sextant webcam.launch", *map(shlex.quote, arguments)])
    return Answer([*lines, _NEXT, command])


def _check(options: argparse.Namespace) -> None:
    check_output(options.output, options.force)
    if options.map is not None:
        check_output(options.map, options.force)
        if options.map.suffix not in (".yaml", ".yml"):
            raise ValueError(f"--map {options.map}: the file name must end in .yaml")
        if options.map.resolve() == options.output.resolve():
            raise ValueError(f"{options.map} cannot be both the PDF and the map")
    if options.board is None and options.gap is not None:
        raise ValueError("--gap is for --board")
    if options.board is not None and options.max_per_page is not None:
        raise ValueError("--max-per-page is not for --board, which is one sheet")


def _make_sheets(options: argparse.Namespace) -> List[str]:
    family, ids, size = options.family, options.ids, options.size
    params = SheetParams(options.page, options.margin, options.quiet_zone, options.max_per_page or 0)
    sheets = write_sheets(options.output, family, ids, size, params)
    written = f"{options.output}: {_count(len(ids), 'marker')} of {family} on {_count(sheets, 'sheet')}"
    lines = [f"{written}, {options.page}"]
    if options.map is not None:
        write_map_template(options.map, family, ids, size)
        lines.append(f"{options.map}: fill in position and rpy of every marker before you use it")
        lines.append("or record a drive past the markers and run map_markers: doc/how_to/mapping.md")
    return lines


def _make_board(options: argparse.Namespace) -> List[str]:
    family, ids, size = options.family, options.ids, options.size
    params = SheetParams(options.page, options.margin, options.quiet_zone)
    check_size(size)
    gap = rounded_min_gap(family, size, options.quiet_zone) if options.gap is None else options.gap
    columns, rows = options.board
    marker_map = write_board(options.output, family, ids, size, BoardParams(columns, rows, gap), params)
    written = f"{options.output}: board of {columns} x {rows} markers of {family}"
    lines = [f"{written}, gap {gap} m, on 1 sheet, {options.page}"]
    if options.map is not None:
        sextant.write_marker_map(marker_map, str(options.map))
        lines.append(f"{options.map}: map of the board; origin at its centre, x right, y up")
    return lines


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" + "s" * (number != 1)
