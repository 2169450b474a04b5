# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The chessboard that camera_calibration looks for, to print."""

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Optional, Union

from sextant.base.strict_params import StrictParams, required, within
from sextant.printing.print_label import Label, draw_label, label_height
from sextant.printing.print_layout import (
    SMALLEST,
    Grid,
    Paper,
    Piece,
    arrange,
    largest_size,
    largest_sizes,
)
from sextant.printing.print_page import Box, PrintPages

QUIET = 0.5  # squares of white around the board, which the search for it wants


@dataclass(frozen=True)
class Chessboard(StrictParams):
    """A board as camera_calibration counts it."""

    columns: int = required(within(2, 100))  # inner corners, one less than squares
    rows: int = required(within(2, 100))
    square: float = required(within(SMALLEST, 1.0))  # metres, edge of a square

    @property
    def arguments(self) -> str:
        """What camera_calibration is to be told."""
        return f"--size {self.columns}x{self.rows} --square {self.square}"


def largest_square(columns: int, rows: int, paper: Paper) -> float:
    """Metres, whole millimetres: the largest square with which a board fits the page; 0 where none does."""
    size = largest_size(lambda square: _grid(Chessboard(columns, rows, square), paper) is not None)
    return math.floor(1000.0 * size + 1e-6) / 1000.0


def write_chessboard(path: Union[str, Path], board: Chessboard, paper: Paper) -> None:
    """Writes a PDF with one board, its columns along or across the page.

    :raises ValueError: a board out of range, or too large for the page
    :raises OSError: the file cannot be written
    """
    grid = _grid(board, paper)
    if grid is None:
        at_most = largest_sizes(
            lambda square, paper: _grid(replace(board, square=square), paper), paper.margin
        )
        raise ValueError(f"the board does not fit on {paper.page}; its squares: at most {at_most}")
    pages = PrintPages(Path(path).stem, *grid.page)
    _draw_board(pages, board, grid)
    corners = f"{board.columns} x {board.rows} inner corners, {board.columns + 1} x {board.rows + 1} squares"
    pages.footer(paper.margin, f"chessboard, {corners} of {board.square} m")
    pages.end_page()
    pages.save(path)


def _grid(board: Chessboard, paper: Paper) -> Optional[Grid]:
    """The board's place on a page, turned by a quarter where it fits only so; None where it does not."""
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
    dark = [(i, j) for i in range(columns) for j in range(rows) if (i + j) % 2 == 0]
    pages.fill(_square(left, bottom, i, j, square) for i, j in dark)
    ends = (-0.5 * piece.width, square - 0.5 * piece.width, 0.5 * piece.width)
    label = Label(board.arguments, "inner corners, metres", list(zip(ends, ends[1:])))
    draw_label(pages, label, x, bottom - piece.rim, piece.width, piece.label)


def _square(left: float, bottom: float, i: int, j: int, edge: float) -> Box:
    return left + i * edge, bottom + j * edge, left + (i + 1) * edge, bottom + (j + 1) * edge
