# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the label strip below a printed piece: texts and dimension lines."""

from dataclasses import dataclass
from typing import Sequence, Tuple

from sextant.printing.print_page import PrintPages, fitting_height, millimetres, text_width

UP = "\u25b2"  # a triangle that points up, before the ids of upright markers
_SHARE, _MIN_HEIGHT, _MAX_HEIGHT = 0.15, 0.004, 0.022  # label height: fraction of its width; limits, metres
_LINES = 0.4  # fraction of the label's height for the dimension lines
_SHORT = 0.008  # metres; the text of a shorter dimension line is after it, unless it is the first line
_SMALL = 0.55  # height of the right text as a fraction of that of the left text


@dataclass(frozen=True)
class Label:
    """Texts and dimension lines of a label."""

    left: str  # large text
    right: str  # small text
    lengths: Sequence[Tuple[float, float]]  # x of both ends of each dimension line, metres from the centre


def label_height(width: float) -> float:
    """Returns the height of a label in metres; its letters are at most 10 mm high, readable from 2 m.

    :param width: of the piece, metres
    """
    return min(max(_SHARE * width, _MIN_HEIGHT), _MAX_HEIGHT)


def draw_label(pages: PrintPages, label: Label, x: float, top: float, width: float, height: float) -> None:
    """Draws a label whose upper edge is at top, centred at x; metres."""
    for index, (begin, end) in enumerate(label.lengths):
        behind = index > 0 and end - begin < _SHORT
        _draw_length(pages, x + begin, x + end, top - 0.5 * _LINES * height, 0.5 * _LINES * height, behind)
    _draw_texts(pages, label, x - 0.5 * width, top - 0.94 * height, (0.86 - _LINES) * height, width)


def _draw_texts(pages: PrintPages, label: Label, x: float, y: float, height: float, width: float) -> None:
    """Draws the texts at the ends of a line from x on, at baseline y, shrunk if they are wider than width."""
    small, space = _SMALL * height, 0.5 * height
    needed = text_width(label.left, height, True) + space + text_width(label.right, small)
    shrink = min(1.0, width / needed)
    pages.text(x, y, shrink * height, label.left, bold=True)
    right = x + width - text_width(label.right, shrink * small)
    pages.text(right, y, shrink * small, label.right)


def _draw_length(pages: PrintPages, begin: float, end: float, y: float, height: float, behind: bool) -> None:
    """Draws a dimension line with its length in the middle or, if behind, after it; height: of the text."""
    text = millimetres(end - begin)
    height = fitting_height(text, height, _SHORT if behind else 0.6 * (end - begin))
    thickness = min(0.0002, 0.1 * height)
    for tick in (begin, end):
        pages.line(tick, y - 0.6 * height, tick, y + 0.6 * height, width=thickness)
    if behind:
        pages.line(begin, y, end, y, width=thickness)
        pages.text(end + 0.6 * height, y - 0.5 * height, height, text)
        return
    middle, gap = 0.5 * (begin + end), 0.5 * text_width(text, height) + 0.4 * height
    pages.line(begin, y, middle - gap, y, width=thickness)
    pages.line(middle + gap, y, end, y, width=thickness)
    pages.centred_text(middle, y - 0.5 * height, height, text)
