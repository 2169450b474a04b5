# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Prints sheets of single markers."""

from dataclasses import dataclass
from pathlib import Path
from typing import Optional, Sequence, Union

import sextant
from sextant.base.strict_params import param, within
from sextant.printing.marker_shape import black_boxes, check_size, marker_shape
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
class SheetParams(Paper):
    """Layout of the sheets."""

    quiet_zone: float = param(1.0, "width of the white rim around markers", within(0.5, 10.0), "modules")
    max_per_page: int = param(0, "maximum number of markers per page; 0: as many as fit", within(0, 1000))


def write_sheets(
    path: Union[str, Path], family: str, ids: Sequence[int], size: float, params: SheetParams
) -> int:
    """Writes a PDF with sheets of markers, each with a label.

    :param size: edge length in metres, between the detected corners
    :returns: number of pages
    :raises ValueError: unknown family, unknown or duplicate id, or a marker too large for the page
    :raises OSError: the file cannot be written
    """
    check_size(size)
    check_ids(family, ids)
    grid = _grid(family, len(ids), size, params)
    places = grid.places()[: params.max_per_page or None]
    sheets = [ids[i : i + len(places)] for i in range(0, len(ids), len(places))]
    pages = PrintPages(Path(path).stem, *grid.page)
    for number, on_sheet in enumerate(sheets):
        for id, (x, y) in zip(on_sheet, places):
            _draw_marker(pages, family, id, size, grid.piece, x, y)
        of_all = f", sheet {number + 1} of {len(sheets)}" if len(sheets) > 1 else ""
        pages.end_page(params.margin, f"{family}, size {size} m: {marker_shape(family).measured}{of_all}")
    pages.save(path)
    return len(sheets)


def check_ids(family: str, ids: Sequence[int]) -> None:
    """Checks the ids of markers.

    :raises ValueError: there is no id, or an unknown or duplicate one
    """
    if not ids:
        raise ValueError("no id is given")
    count = sextant.family_size(family)
    for id in ids:
        if not 0 <= id < count:
            raise ValueError(f"id {id} is not in {family}, which has 0 to {count - 1}")
    if len(set(ids)) < len(ids):
        duplicate = next(id for index, id in enumerate(ids) if id in ids[:index])
        raise ValueError(f"id {duplicate} is given twice: every marker must be unique")


def id_ranges(ids: Sequence[int]) -> str:
    """Formats ids in their order, with ranges, such as "0-7,12"."""
    parts = []
    for id in ids:
        if parts and id == parts[-1][1] + 1:
            parts[-1][1] = id
        else:
            parts.append([id, id])
    return ",".join(str(first) if first == last else f"{first}-{last}" for first, last in parts)


def _grid(family: str, count: int, size: float, params: SheetParams) -> Grid:
    """Returns the grid of a page, for up to count markers."""

    def on_paper(size: float, paper: Paper) -> Optional[Grid]:
        wanted = min(count, params.max_per_page or count)
        return arrange(_piece(family, size, params.quiet_zone), paper, wanted)

    return require_room(on_paper, size, params, f"a marker of {size} m")


def _piece(family: str, size: float, quiet: float) -> Piece:
    """Returns the dimensions of a marker with rim and label."""
    shape = marker_shape(family)
    module = size / shape.width_at_border
    edge = module * shape.total_width
    return Piece(edge, edge, quiet * module, label_height(edge))


def _draw_marker(
    pages: PrintPages, family: str, id: int, size: float, piece: Piece, x: float, y: float
) -> None:
    pages.fill(black_boxes(family, id, size, x, y))
    label = Label(f"{UP} id {id}", family, [(-0.5 * size, 0.5 * size)])
    draw_label(pages, label, x, y - 0.5 * piece.height - piece.rim, piece.width, piece.label)
    draw_cut_marks(pages, piece, x, y)
