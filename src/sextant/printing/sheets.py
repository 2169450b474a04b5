# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sheets of single markers to print, hang and measure."""

from dataclasses import dataclass
from pathlib import Path
from typing import Optional, Sequence, Union

import sextant
from sextant.base.strict_params import param, within
from sextant.printing.marker_print import black_boxes, check_size, marker_shape
from sextant.printing.print_label import UP, Label, draw_label, label_height
from sextant.printing.print_layout import (
    Grid,
    Paper,
    Piece,
    arrange,
    draw_cut_marks,
    largest_sizes,
)
from sextant.printing.print_page import PrintPages


@dataclass(frozen=True)
class SheetParams(Paper):
    """How markers are put on pages."""

    quiet: float = param(1.0, within(0.5, 10.0))  # white rim around every marker without ink, in modules
    most: int = param(0, within(0, 1000))  # markers a page at most; 0: as many as fit


def write_sheets(
    path: Union[str, Path], family: str, ids: Sequence[int], size: float, params: SheetParams
) -> int:
    """Writes a PDF with one marker after another, each with its label.

    :param size: edge length in metres, between the corners that a detector reports
    :returns: number of pages
    :raises ValueError: an unknown family, an id that it does not have or that is there twice, or a marker too
        large for the page
    :raises OSError: the file cannot be written
    """
    check_size(size)
    check_ids(family, ids)
    grid = _grid(family, len(ids), size, params)
    places = grid.places()[: params.most or None]
    sheets = [ids[i : i + len(places)] for i in range(0, len(ids), len(places))]
    pages = PrintPages(Path(path).stem, *grid.page)
    for number, on_sheet in enumerate(sheets):
        for id, (x, y) in zip(on_sheet, places):
            _draw_marker(pages, family, id, size, grid.piece, x, y)
        of_all = f", sheet {number + 1} of {len(sheets)}" if len(sheets) > 1 else ""
        pages.footer(params.margin, f"{family}, size {size} m: {marker_shape(family).measured}{of_all}")
        pages.end_page()
    pages.save(path)
    return len(sheets)


def check_ids(family: str, ids: Sequence[int]) -> None:
    """:raises ValueError: none, one that the family does not have, or one that is there twice."""
    if not ids:
        raise ValueError("no id is given")
    have = sextant.family_size(family)
    for id in ids:
        if not 0 <= id < have:
            raise ValueError(f"id {id} is not in {family}, which has 0 to {have - 1}")
    if len(set(ids)) < len(ids):
        twice = next(id for index, id in enumerate(ids) if id in ids[:index])
        raise ValueError(f"id {twice} is there twice: every marker must be the only one of its kind")


def id_ranges(ids: Sequence[int]) -> str:
    """Ids in their order, neighbours joined: "0-7,12"."""
    parts = []
    for id in ids:
        if parts and id == parts[-1][1] + 1:
            parts[-1][1] = id
        else:
            parts.append([id, id])
    return ",".join(str(first) if first == last else f"{first}-{last}" for first, last in parts)


def _grid(family: str, count: int, size: float, params: SheetParams) -> Grid:
    """The places of a page, for so many markers or fewer."""

    def on_paper(size: float, paper: Paper) -> Optional[Grid]:
        return arrange(_piece(family, size, params.quiet), paper, min(count, params.most or count))

    grid = on_paper(size, params)
    if grid is None:
        at_most = largest_sizes(on_paper, params.margin)
        raise ValueError(f"a marker of {size} m does not fit on {params.page}; at most {at_most}")
    return grid


def _piece(family: str, size: float, quiet: float) -> Piece:
    """The room that a marker takes on a page."""
    shape = marker_shape(family)
    module = size / shape.border
    reach = module * shape.reach
    return Piece(reach, reach, quiet * module, label_height(reach))


def _draw_marker(
    pages: PrintPages, family: str, id: int, size: float, piece: Piece, x: float, y: float
) -> None:
    pages.fill(black_boxes(family, id, size, x, y))
    label = Label(f"{UP} id {id}", family, [(-0.5 * size, 0.5 * size)])
    draw_label(pages, label, x, y - 0.5 * piece.height - piece.rim, piece.width, piece.label)
    draw_cut_marks(pages, piece, x, y)
