# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Arranges pieces on a page. Metres, x right and y up from the lower left corner of the page."""

import dataclasses
import math
from dataclasses import dataclass
from typing import Callable, List, Optional, Tuple

from sextant.base.strict_params import StrictParams, one_of, param, within
from sextant.printing.print_page import FOOTER, PrintPages

PAGES = {"A4": (0.210, 0.297), "A3": (0.297, 0.420), "Letter": (0.2159, 0.2794)}  # upright: width, height
CUT_GREY = 0.5  # of cut marks, 0 black to 1 white
GUTTER = 0.004  # distance between pieces, for the cut marks, metres
MIN_SIZE = 0.001  # edge length of a marker or square, metres
_STEPS = 10000  # number of candidate sizes per metre: steps of 0.1 mm
_SLACK = 1e-9  # tolerance for pieces that fit exactly, metres


@dataclass(frozen=True)
class Paper(StrictParams):
    """Page size and margin."""

    page: str = param("A4", "page size; portrait or landscape, whichever fits more pieces", one_of(*PAGES))
    margin: float = param(0.008, "unprintable margin of the printer", within(0.0, 0.05), "m")


@dataclass(frozen=True)
class Piece:
    """A piece to cut out of a page: a dark part with a white rim, and a label below the rim; metres."""

    width: float  # of the dark part
    height: float  # of the dark part
    rim: float  # width of the white rim
    label: float  # height of the label


@dataclass(frozen=True)
class Grid:
    """Equal pieces in a grid, centred on a page.

    The white rim may extend into the unprintable margin.
    """

    piece: Piece  # marker or chessboard with its margin
    page: Tuple[float, float]  # width, height; metres
    margin: float  # unprintable, metres
    columns: int = 0  # 0: as many as fit
    rows: int = 0  # 0: as many as fit

    @property
    def step(self) -> Tuple[float, float]:
        """Distances between the centres of adjacent pieces, horizontally and vertically, metres."""
        piece = self.piece
        return piece.width + 2.0 * piece.rim + GUTTER, piece.height + 2.0 * piece.rim + piece.label + GUTTER

    def _edges(self) -> Tuple[float, float, float, float]:
        """Returns left, bottom, right and top of the area for pieces, including rims."""
        free = max(self.piece.rim, self.margin) - self.piece.rim
        return free, self.margin + FOOTER, self.page[0] - free, self.page[1] - free

    def capacity(self) -> Tuple[int, int]:
        """Returns the maximum numbers of columns and rows."""
        left, bottom, right, top = self._edges()
        room = (right - left, top - bottom)
        columns, rows = (int((have + GUTTER + _SLACK) // step) for have, step in zip(room, self.step))
        return columns, rows

    def filled(self, count: int) -> "Grid":
        """Returns a nearly square grid on this page for count pieces, or for as many as fit."""
        columns, rows = self.capacity()
        count = min(count, columns * rows)
        if count == 0:
            return dataclasses.replace(self, columns=0, rows=0)
        columns = min(columns, max(-(-count // rows), math.ceil(math.sqrt(count))))
        return dataclasses.replace(self, columns=columns, rows=-(-count // columns))

    def places(self) -> List[Tuple[float, float]]:
        """Returns the centres of the dark parts, row by row from the top left."""
        left, bottom, right, top = self._edges()
        across, down = self.step
        x = 0.5 * (left + right - (self.columns - 1) * across)
        y = 0.5 * (bottom + top + (self.rows - 1) * down + self.piece.label)
        return [(x + i * across, y - j * down) for j in range(self.rows) for i in range(self.columns)]


def arrange(piece: Piece, paper: Paper, count: int = 1) -> Optional[Grid]:
    """Returns the grid, portrait or landscape, that holds more of count pieces; None if not one fits."""
    width, height = PAGES[paper.page]
    grids = [Grid(piece, page, paper.margin).filled(count) for page in ((width, height), (height, width))]
    best = max(grids, key=lambda grid: min(count, grid.columns * grid.rows))
    return best if best.columns * best.rows else None


def largest_size(fits: Callable[[float], bool]) -> float:
    """Returns the largest multiple of 0.1 mm that fits, in metres; 0 if not even MIN_SIZE fits.

    The result is a quotient of integers, so its decimal form has no rounding errors.
    """
    too_small = round(MIN_SIZE * _STEPS) - 1
    low, high = too_small, _STEPS
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if fits(middle / _STEPS) else (low, middle)
    return 0.0 if low == too_small else low / _STEPS


def require_room(
    on_paper: Callable[[float, Paper], Optional[Grid]], size: float, paper: Paper, what: str, sizes: str = ""
) -> Grid:
    """Returns on_paper(size, paper), unless that is None.

    :param on_paper: grid of pieces of a size in metres on a paper; None if not even one fits
    :param what: what does not fit, for the error
    :param sizes: what the size refers to, for the error
    :raises ValueError: it does not fit; names the largest size for each page format
    """
    grid = on_paper(size, paper)
    if grid is not None:
        return grid
    texts = []
    for page in PAGES:
        other = Paper(page, paper.margin)
        largest = largest_size(lambda size, other=other: on_paper(size, other) is not None)
        texts.append(f"{largest} m on {page}" if largest else f"nothing on {page}")
    raise ValueError(f"{what} does not fit on {paper.page}; {sizes}at most {', '.join(texts)}")


def draw_cut_marks(pages: PrintPages, piece: Piece, x: float, y: float) -> None:
    """Draws cut marks at the corners of a piece whose dark part is centred at (x, y)."""
    left, right = x - 0.5 * piece.width - piece.rim, x + 0.5 * piece.width + piece.rim
    bottom, top = y - 0.5 * piece.height - piece.rim - piece.label, y + 0.5 * piece.height + piece.rim
    near, far = 0.125 * GUTTER, 0.875 * GUTTER
    for edge, outward in ((left, -1.0), (right, 1.0)):
        for level, up in ((bottom, -1.0), (top, 1.0)):
            pages.line(edge + near * outward, level, edge + far * outward, level, CUT_GREY)
            pages.line(edge, level + near * up, edge, level + far * up, CUT_GREY)
