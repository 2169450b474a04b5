# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Prints boards (grids of markers on one sheet) and returns their marker maps."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import List, Optional, Sequence, Tuple, Union

import numpy as np

import sextant
from sextant.base.strict_params import StrictParams, required, within
from sextant.printing.marker_shape import black_boxes, check_size, marker_shape
from sextant.printing.marker_sheet import SheetParams, check_ids, id_ranges
from sextant.printing.print_label import UP, Label, draw_label, label_height
from sextant.printing.print_layout import (
    Grid,
    Paper,
    Piece,
    arrange,
    draw_cut_marks,
    require_room,
)
from sextant.printing.print_page import PrintPages


@dataclass(frozen=True)
class BoardParams(StrictParams):
    """Grid of a board."""

    columns: int = required("number of markers side by side", within(1, 100))
    rows: int = required("number of markers one above the other", within(1, 100))
    gap: float = required("between adjacent markers, from edge to edge", within(0.0, 1.0), "m")


def min_gap(family: str, size: float, quiet: float) -> float:
    """Returns the minimum gap between markers, metres.

    :param size: edge length of a marker in metres, between the detected corners
    :param quiet: minimum white rim between adjacent markers, modules
    """
    shape = marker_shape(family)
    return size * (2 * shape.outside + quiet) / shape.width_at_border


def rounded_min_gap(family: str, size: float, quiet: float) -> float:
    """Returns min_gap() rounded up to whole millimetres, in metres."""
    return math.ceil(1000.0 * min_gap(family, size, quiet) - 1e-6) / 1000.0


def board_map(family: str, ids: Sequence[int], size: float, board: BoardParams) -> "sextant.MarkerMap":
    """Returns the map of a board, in frame `board`: origin at the centre, x right, y up, z out of the board.

    :param ids: row by row from the top left
    :param size: edge length of a marker in metres, between the detected corners
    :raises ValueError: unknown family, unknown or duplicate id, or the number of ids is not columns x rows
    """
    check_ids(family, ids)
    if len(ids) != board.columns * board.rows:
        wanted = f"a board of {board.columns} x {board.rows} needs {board.columns * board.rows} ids"
        raise ValueError(f"{wanted}, {len(ids)} are given")
    marker_map = sextant.MarkerMap("board")
    for id, (x, y) in zip(ids, _places(size, board)):
        T_board_marker = np.eye(4)
        T_board_marker[:2, 3] = x, y
        marker_map.add(sextant.MappedMarker(family, id, size, T_board_marker))
    return marker_map


def write_board(
    path: Union[str, Path],
    family: str,
    ids: Sequence[int],
    size: float,
    board: BoardParams,
    params: SheetParams,
) -> "sextant.MarkerMap":
    """Writes a PDF with one board.

    :param ids: row by row from the top left
    :param size: edge length of a marker in metres, between the detected corners
    :returns: the board's map, see board_map()
    :raises ValueError: as board_map(), or the gap is too small for the white rim, or the board is too large
    :raises OSError: the file cannot be written
    """
    check_size(size)
    marker_map = board_map(family, ids, size, board)
    if not _leaves_white(board, family, size, params.quiet_zone):
        least = rounded_min_gap(family, size, params.quiet_zone)
        raise ValueError(f"gap is {board.gap} m, the white rim between adjacent markers needs {least} m")
    grid = _grid(family, size, board, params)
    pages = PrintPages(Path(path).stem, *grid.page)
    _draw_board(pages, family, ids, size, board, grid)
    what = f"{family}, size {size} m: {marker_shape(family).measured}; gap {board.gap} m"
    pages.end_page(params.margin, f"{what}; ids row by row from the top left")
    pages.save(path)
    return marker_map


def _leaves_white(board: BoardParams, family: str, size: float, quiet: float) -> bool:
    """Whether the gap is wide enough for the white rim; always for a single marker."""
    single = board.columns * board.rows == 1
    return single or board.gap > min_gap(family, size, quiet) - 1e-9


def _grid(family: str, size: float, board: BoardParams, params: SheetParams) -> Grid:
    """Returns the board as the only piece of a page; raises ValueError if it does not fit."""

    def on_paper(size: float, paper: Paper) -> Optional[Grid]:
        if not _leaves_white(board, family, size, params.quiet_zone):
            return None
        return arrange(_piece(family, size, board, params.quiet_zone), paper)

    return require_room(on_paper, size, params, "the board", "markers with this gap: ")


def _places(size: float, board: BoardParams) -> List[Tuple[float, float]]:
    """Returns the centres of the markers relative to that of the board, row by row from the top left."""
    step, left, top = size + board.gap, -0.5 * (board.columns - 1), 0.5 * (board.rows - 1)
    return [
        (step * (left + column), step * (top - row))
        for row in range(board.rows)
        for column in range(board.columns)
    ]


def _piece(family: str, size: float, board: BoardParams, quiet: float) -> Piece:
    """Returns the dimensions of the board with rim and label."""
    shape = marker_shape(family)
    module = size / shape.width_at_border
    width, height = (
        count * size + (count - 1) * board.gap + 2 * shape.outside * module
        for count in (board.columns, board.rows)
    )
    return Piece(width, height, quiet * module, label_height(width))


def _draw_board(
    pages: PrintPages, family: str, ids: Sequence[int], size: float, board: BoardParams, grid: Grid
) -> None:
    """Draws the markers as one path and, below them, the lengths of a marker's edge and of a gap."""
    piece, (x, y) = grid.piece, grid.places()[0]
    boxes = []
    for id, (right, up) in zip(ids, _places(size, board)):
        boxes += black_boxes(family, id, size, x + right, y + up)
    pages.fill(boxes)
    begin = -0.5 * (board.columns * size + (board.columns - 1) * board.gap)
    lengths = [(begin, begin + size), (begin + size, begin + size + board.gap)]
    label = Label(f"{UP} id {id_ranges(ids)}", family, lengths[: board.columns])
    draw_label(pages, label, x, y - 0.5 * piece.height - piece.rim, piece.width, piece.label)
    draw_cut_marks(pages, piece, x, y)
