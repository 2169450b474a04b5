# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Prints the chessboard for camera_calibration."""

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Optional, Union

from sextant.base.strict_params import StrictParams, required, within
from sextant.printing.print_label import Label, draw_label, label_height
from sextant.printing.print_layout import (
    MIN_SIZE,
    Grid,
    Paper,
    Piece,
    arrange,
    largest_size,
    require_room,
)
from sextant.printing.print_page import PrintPages

QUIET = 0.5  # width of the white rim that the chessboard detector needs, in squares


@dataclass(frozen=True)
class Chessboard(StrictParams):
    """Size of a chessboard, as in camera_calibration."""

    columns: int = required("number of inner corners, one less than that of squares", within(2, 100))
    rows: int = required("number of inner corners", within(2, 100))
    square: float = required("edge length of a square", within(MIN_SIZE, 1.0), "m")

    @property
    def arguments(self) -> str:
        """Arguments of cameracalibrator.py."""
        return f"--size {self.columns}x{self.rows} --square {self.square}"


def largest_square(columns: int, rows: int, paper: Paper) -> float:
    """Returns the edge length of the largest squares that fit the page, whole mm, in metres; 0: none fit."""
    size = largest_size(lambda square: _grid(Chessboard(columns, rows, square), paper) is not None)
    return math.floor(1000.0 * size + 1e-6) / 1000.0


def write_chessboard(path: Union[str, Path], board: Chessboard, paper: Paper) -> None:
    """Writes a PDF with one board, upright or rotated by 90 degrees.

    :raises ValueError: the board is too large for the page
    :raises OSError: the file cannot be written
    """

    def on_paper(square: float, paper: Paper) -> Optional[Grid]:
        return _grid(replace(board, square=square), paper)

    grid = require_room(on_paper, board.square, paper, "the board", "its squares: ")
    pages = PrintPages(Path(path).stem, *grid.page)
    _draw_board(pages, board, grid)
    corners = f"{board.columns} x {board.rows} inner corners, {board.columns + 1} x {board.rows + 1} squares"
    pages.end_page(paper.margin, f"chessboard, {corners} of {board.square} m")
    pages.save(path)


def _grid(board: Chessboard, paper: Paper) -> Optional[Grid]:
    """Returns the position of the board on a page, rotated by 90 degrees if necessary; None: no room."""
    edges = [board.square * (corners + 1) for corners in (board.columns, board.rows)]
    for width, height in (edges, edges[::-1]):
        grid = arrange(Piece(width, height, QUIET * board.square, label_height(0.5 * width)), paper)
        if grid is not None:
            return grid
    return None


def _draw_board(pages: PrintPages, board: Chessboard, grid: Grid) -> None:
    piece, square = grid.piece, board.square
    x, y = grid.places()[0]
    left, bottom = x - 0.5 * piece.width, y - 0.5 * piece.height
    columns, rows = round(piece.width / square), round(piece.height / square)
    black = [(i, j) for i in range(columns) for j in range(rows) if (i + j) % 2 == 0]
    pages.fill(
        (left + i * square, bottom + j * square, left + (i + 1) * square, bottom + (j + 1) * square)
        for i, j in black
    )
    ends = (-0.5 * piece.width, square - 0.5 * piece.width, 0.5 * piece.width)
    label = Label(board.arguments, "inner corners, metres", list(zip(ends, ends[1:])))
    draw_label(pages, label, x, bottom - piece.rim, piece.width, piece.label)
