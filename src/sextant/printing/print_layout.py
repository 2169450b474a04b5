# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How many pieces go on a page, and where: metres, x right and y up from the page's lower left corner."""

import dataclasses
import math
from dataclasses import dataclass
from typing import Callable, List, Optional, Tuple

from sextant.base.strict_params import StrictParams, one_of, param, within
from sextant.printing.print_page import FOOTER, PrintPages

PAGES = {"A4": (0.210, 0.297), "A3": (0.297, 0.420), "Letter": (0.2159, 0.2794)}  # upright: width, height
CUT_GREY = 0.5
GUTTER = 0.004  # metres between pieces, for the cut marks
SMALLEST = 0.001  # metres, of a marker's edge or a square
_STEPS = 10000  # sizes that are tried up to a metre: a tenth of a millimetre apart
_SLACK = 1e-9  # metres, so that what fits exactly fits


@dataclass(frozen=True)
class Paper(StrictParams):
    """What is printed on."""

    page: str = param("A4", one_of(*PAGES))  # upright or across, whichever holds more
    margin: float = param(0.008, within(0.0, 0.05))  # metres along the edge that the printer cannot reach


@dataclass(frozen=True)
class Piece:
    """What is cut out of a page: a dark part with a white rim, and below the rim a label; metres."""

    width: float  # of the dark part
    height: float
    rim: float
    label: float  # height


@dataclass(frozen=True)
class Grid:
    """Equal pieces side by side on a page, the whole in its middle.

    The rim may lie on paper that the printer cannot reach: that is white as well.
    """

    piece: Piece
    page: Tuple[float, float]  # width, height
    margin: float
    columns: int = 0
    rows: int = 0

    @property
    def step(self) -> Tuple[float, float]:
        """From a piece to the next one to the right, to the next one below."""
        piece = self.piece
        return piece.width + 2.0 * piece.rim + GUTTER, piece.height + 2.0 * piece.rim + piece.label + GUTTER

    def _edges(self) -> Tuple[float, float, float, float]:
        """Left, bottom, right and top of what the pieces may fill, rims included."""
        free = max(self.piece.rim, self.margin) - self.piece.rim
        return free, self.margin + FOOTER, self.page[0] - free, self.page[1] - free

    def most(self) -> Tuple[int, int]:
        """Columns and rows that fit."""
        left, bottom, right, top = self._edges()
        room = (right - left, top - bottom)
        columns, rows = (int((have + GUTTER + _SLACK) // step) for have, step in zip(room, self.step))
        return columns, rows

    def filled(self, count: int) -> "Grid":
        """This page with places for so many pieces, or as many as fit, about as many a row as a column."""
        columns, rows = self.most()
        count = min(count, columns * rows)
        if count == 0:
            return dataclasses.replace(self, columns=0, rows=0)
        columns = min(columns, max(-(-count // rows), math.ceil(math.sqrt(count))))
        return dataclasses.replace(self, columns=columns, rows=-(-count // columns))

    def places(self) -> List[Tuple[float, float]]:
        """Middles of the dark parts, row by row from the top left."""
        left, bottom, right, top = self._edges()
        across, down = self.step
        x = 0.5 * (left + right - (self.columns - 1) * across)
        y = 0.5 * (bottom + top + (self.rows - 1) * down + self.piece.label)
        return [(x + i * across, y - j * down) for j in range(self.rows) for i in range(self.columns)]


def arrange(piece: Piece, paper: Paper, count: int = 1) -> Optional[Grid]:
    """The page, upright or across, that holds more of so many pieces; None where not even one fits."""
    width, height = PAGES[paper.page]
    grids = [Grid(piece, page, paper.margin).filled(count) for page in ((width, height), (height, width))]
    best = max(grids, key=lambda grid: min(count, grid.columns * grid.rows))
    return best if best.columns * best.rows else None


def largest_size(fits: Callable[[float], bool]) -> float:
    """The largest multiple of a tenth of a millimetre, in metres, that fits; 0 where not even SMALLEST does.

    A quotient and not a product: it is the very number that one reads from its decimals.
    """
    too_small = round(SMALLEST * _STEPS) - 1
    low, high = too_small, _STEPS
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if fits(middle / _STEPS) else (low, middle)
    return 0.0 if low == too_small else low / _STEPS


def largest_sizes(on_paper: Callable[[float, Paper], Optional[Grid]], margin: float) -> str:
    """The end of a sentence: the largest size on each kind of page, "0.168 m on A4, 0.2376 m on A3, ..."."""
    texts = []
    for page in PAGES:
        paper = Paper(page, margin)
        size = largest_size(lambda size, paper=paper: on_paper(size, paper) is not None)
        texts.append(f"{size} m on {page}" if size else f"nothing on {page}")
    return ", ".join(texts)


def draw_cut_marks(pages: PrintPages, piece: Piece, x: float, y: float) -> None:
    """Outside of the piece, at its corners."""
    left, right = x - 0.5 * piece.width - piece.rim, x + 0.5 * piece.width + piece.rim
    bottom, top = y - 0.5 * piece.height - piece.rim - piece.label, y + 0.5 * piece.height + piece.rim
    near, far = 0.125 * GUTTER, 0.875 * GUTTER
    for edge, outward in ((left, -1.0), (right, 1.0)):
        for level, up in ((bottom, -1.0), (top, 1.0)):
            pages.line(edge + near * outward, level, edge + far * outward, level, CUT_GREY)
            pages.line(edge, level + near * up, edge, level + far * up, CUT_GREY)
