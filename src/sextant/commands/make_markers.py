# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes sheets of markers to print, and the marker map that goes with them."""

import argparse
import shlex
from pathlib import Path
from typing import List, Optional

import sextant
from sextant.commands.command_line import Answer, CommandParser, check_output, run
from sextant.commands.sheet_options import add_sheet_options, columns_and_rows
from sextant.printing.board_sheet import BoardParams, round_gap, write_board
from sextant.printing.map_template import write_map_template
from sextant.printing.marker_print import check_size
from sextant.printing.sheets import SheetParams, write_sheets

_EXAMPLES = """\
examples:
  make_markers tag36h11 0-7,12 --size 0.16 --map map.yaml
  make_markers DICT_4X4_50 0-49 --size 0.05 --page A3
  make_markers tag36h11 0-11 --size 0.04 --board 4x3 --map board.yaml
"""
_NEXT = "Print at 100 %, measure the 100 mm line, hang. Then (robot.launch takes the same arguments):"
_MOST_IDS = 10000  # more are a slip of the finger


def main(arguments: Optional[List[str]] = None) -> int:
    """:returns: exit code: 0, or 2 where nothing could be made of the arguments."""
    return run(_parser(), arguments, _make)


def _parser() -> CommandParser:
    parser = CommandParser(prog="make_markers", description=__doc__, epilog=_EXAMPLES)
    add_sheet_options(parser, "markers.pdf")
    parser.add_argument("family", help="dictionary or family: tag36h11, DICT_4X4_50, ...")
    parser.add_argument("ids", type=_ids, help="e.g. 0-7,12; of a board row by row from the top left")
    parser.add_argument(
        "--size", type=float, required=True, metavar="METRES", help="edge length, which the sheet shows"
    )
    parser.add_argument("--map", type=Path, metavar="FILE", help="write a marker map as well, .yaml")
    parser.add_argument("--most", type=int, help="single markers a page at most (default: as many as fit)")
    parser.add_argument(
        "--quiet",
        type=float,
        default=SheetParams.quiet,
        metavar="MODULES",
        help="white rim that stays free of ink (default: %(default)s)",
    )
    parser.add_argument(
        "--board", type=columns_and_rows, metavar="COLUMNSxROWS", help="one sheet with all markers in a grid"
    )
    parser.add_argument(
        "--gap", type=float, metavar="METRES", help="between the markers of a board (default: the white rim)"
    )
    return parser


def _ids(text: str) -> List[int]:
    """Numbers and ranges with both ends, e.g. "0-7,12"."""
    ids: List[int] = []
    for part in text.split(","):
        first, dash, last = part.partition("-")
        last = last if dash else first
        if not (first.isdecimal() and last.isdecimal() and int(first) <= int(last)):
            raise argparse.ArgumentTypeError(f"'{part}' is no id and no range of ids such as 0-7")
        if len(ids) + int(last) - int(first) >= _MOST_IDS:
            raise argparse.ArgumentTypeError(f"more than {_MOST_IDS} ids")
        ids += range(int(first), int(last) + 1)
    return ids


def _make(options: argparse.Namespace) -> Answer:
    _check(options)
    options.family = sextant.canonical_family(options.family)  # the name that detections and maps have
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
            raise ValueError(f"--map {options.map}: a marker map of this command ends in .yaml")
        if options.map.resolve() == options.output.resolve():
            raise ValueError(f"{options.map} cannot be both the PDF and the map")
    if options.board is None and options.gap is not None:
        raise ValueError("--gap is for --board")
    if options.board is not None and options.most is not None:
        raise ValueError("--most is not for --board, which is one sheet")


def _make_sheets(options: argparse.Namespace) -> List[str]:
    family, ids, size = options.family, options.ids, options.size
    params = SheetParams(options.page, options.margin, options.quiet, options.most or 0)
    sheets = write_sheets(options.output, family, ids, size, params)
    written = f"{options.output}: {_count(len(ids), 'marker')} of {family} on {_count(sheets, 'sheet')}"
    lines = [f"{written}, {options.page}"]
    if options.map is not None:
        write_map_template(options.map, family, ids, size)
        lines.append(f"{options.map}: fill in position and rpy of every marker; until then it is refused")
        lines.append("or drive past them with a rosbag and let map_markers find out: doc/mapping.md")
    return lines


def _make_board(options: argparse.Namespace) -> List[str]:
    family, ids, size = options.family, options.ids, options.size
    params = SheetParams(options.page, options.margin, options.quiet)
    check_size(size)
    gap = round_gap(family, size, options.quiet) if options.gap is None else options.gap
    columns, rows = options.board
    marker_map = write_board(options.output, family, ids, size, BoardParams(columns, rows, gap), params)
    written = f"{options.output}: board of {columns} x {rows} markers of {family}"
    lines = [f"{written}, gap {gap} m, on 1 sheet, {options.page}"]
    if options.map is not None:
        sextant.write_marker_map(marker_map, str(options.map))
        lines.append(f"{options.map}: where they are on it; origin in its middle, x right, y up")
    return lines


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" + "s" * (number != 1)
