# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The strip below a printed piece: what it is, which side is up, and the lengths that its numbers mean."""

from dataclasses import dataclass
from typing import Sequence, Tuple

from sextant.printing.print_page import PrintPages, fitting_height, millimetres, text_width

UP = "\u25b2"  # a triangle that points up
_SHARE, _LOWEST, _HIGHEST = 0.15, 0.004, 0.022  # of a label's height in its width; metres
_LINES = 0.4  # share of the height that the dimension lines take
_SHORT = 0.008  # metres; the text of a shorter length stands behind it, unless it is the first
_SMALL = 0.55  # height of the text on the right over that on the left


@dataclass(frozen=True)
class Label:
    """Texts and dimension lines of a strip."""

    left: str  # large
    right: str
    lengths: Sequence[Tuple[float, float]]  # ends along x of what is measured, metres from the middle


def label_height(width: float) -> float:
    """Metres below a piece so wide; 10 mm letters, which are read from 2 m, where there is room."""
    return min(max(_SHARE * width, _LOWEST), _HIGHEST)


def draw_label(pages: PrintPages, label: Label, x: float, top: float, width: float, height: float) -> None:
    """Draws below `top`, around x."""
    for index, (begin, end) in enumerate(label.lengths):
        behind = index > 0 and end - begin < _SHORT
        _draw_length(pages, x + begin, x + end, top - 0.5 * _LINES * height, 0.5 * _LINES * height, behind)
    _draw_texts(pages, label, x - 0.5 * width, top - 0.94 * height, (0.86 - _LINES) * height, width)


def _draw_texts(pages: PrintPages, label: Label, x: float, y: float, height: float, width: float) -> None:
    small, space = _SMALL * height, 0.5 * height
    needed = text_width(label.left, height, True) + space + text_width(label.right, small)
    shrink = min(1.0, width / needed)
    pages.text(x, y, shrink * height, label.left, bold=True)
    right = x + width - text_width(label.right, shrink * small)
    pages.text(right, y, shrink * small, label.right)


def _draw_length(pages: PrintPages, begin: float, end: float, y: float, height: float, behind: bool) -> None:
    """A line between two ticks with its length in its middle, or behind it."""
    text = millimetres(end - begin)
    height = fitting_height(text, height, _SHORT if behind else 0.6 * (end - begin))
    line = min(0.0002, 0.1 * height)
    for tick in (begin, end):
        pages.line(tick, y - 0.6 * height, tick, y + 0.6 * height, width=line)
    if behind:
        pages.line(begin, y, end, y, width=line)
        pages.text(end + 0.6 * height, y - 0.5 * height, height, text)
        return
    middle, gap = 0.5 * (begin + end), 0.5 * text_width(text, height) + 0.4 * height
    pages.line(begin, y, middle - gap, y, width=line)
    pages.line(middle + gap, y, end, y, width=line)
    pages.centred_text(middle, y - 0.5 * height, height, text)
