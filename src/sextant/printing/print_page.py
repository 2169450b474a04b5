# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A vector PDF that prints true to size: drawn in metres, x right and y up from the lower left corner."""

import functools
import io
from pathlib import Path
from typing import Iterable, Tuple, Union

import matplotlib
from reportlab.pdfbase.pdfmetrics import registerFont, stringWidth
from reportlab.pdfbase.ttfonts import TTFont
from reportlab.pdfgen.canvas import Canvas

from sextant.base.atomic_file import atomic_file

CONTROL_LINE = 0.1  # metres
FOOTER = 0.016  # metres above the margin that the control line and its text take
_POINT = 0.0254 / 72.0  # metres
_CAPITAL = 0.729  # height of a capital over the font's size
_CONTROL_TEXT = "This line is 100 mm long. If it is not, print again at 100 %, without fitting to the page."

Box = Tuple[float, float, float, float]  # left, bottom, right, top


class PrintPages:
    """Pages of one size, in memory until they are saved."""

    def __init__(self, title: str, width: float, height: float):
        self.width, self.height = width, height
        self._data = io.BytesIO()
        size = (width / _POINT, height / _POINT)
        # invariant: the same sheets are the same bytes; the first font goes into the file whether used or not
        self._canvas = Canvas(self._data, pagesize=size, invariant=1, initialFontName=_font(False))
        self._canvas.setTitle(title)
        self._canvas.setCreator("Sextant")
        self._canvas.setViewerPreference("PrintScaling", "None")  # else viewers fit the page to the paper
        self._canvas.setViewerPreference("Duplex", "Simplex")

    def fill(self, boxes: Iterable[Box]) -> None:
        """Black boxes as one path, so that viewers and printers leave no hairlines where they touch."""
        path = self._canvas.beginPath()
        for box in boxes:
            left, bottom, right, top = (value / _POINT for value in box)
            path.moveTo(left, bottom)
            path.lineTo(right, bottom)
            path.lineTo(right, top)
            path.lineTo(left, top)
            path.close()
        self._canvas.setFillGray(0.0)
        self._canvas.drawPath(path, stroke=0, fill=1)

    def line(
        self, x0: float, y0: float, x1: float, y1: float, grey: float = 0.0, width: float = 0.0002
    ) -> None:
        self._canvas.setStrokeGray(grey)
        self._canvas.setLineWidth(width / _POINT)
        self._canvas.line(x0 / _POINT, y0 / _POINT, x1 / _POINT, y1 / _POINT)

    def text(self, x: float, y: float, height: float, text: str, bold: bool = False) -> None:
        """:param x: left end, y: base line, height: of a capital."""
        self._canvas.setFillGray(0.0)
        self._canvas.setFont(_font(bold), height / _CAPITAL / _POINT)
        self._canvas.drawString(x / _POINT, y / _POINT, text)

    def centred_text(self, x: float, y: float, height: float, text: str) -> None:
        self.text(x - 0.5 * text_width(text, height), y, height, text)

    def footer(self, margin: float, text: str) -> None:
        """The control line with its text, and below it what the page says of itself."""
        middle, y = 0.5 * self.width, margin + 0.0085
        left = middle - 0.5 * CONTROL_LINE
        self.line(left, y, left + CONTROL_LINE, y)
        for i in range(11):
            tick, x = 0.0025 if i % 5 == 0 else 0.0015, left + 0.1 * i * CONTROL_LINE
            self.line(x, y - tick, x, y + tick)
        room = self.width - 2.0 * margin
        for line, below in ((_CONTROL_TEXT, 0.005), (text, 0.0085)):
            self.centred_text(middle, y - below, fitting_height(line, 0.0018, room), line)

    def end_page(self) -> None:
        self._canvas.showPage()

    def save(self, path: Union[str, Path]) -> None:
        """Writes the file whole or not at all; its pages cannot be drawn on any more.

        :raises OSError: it cannot be written
        """
        self._canvas.save()
        with atomic_file(path, "wb") as file:
            file.write(self._data.getvalue())


def text_width(text: str, height: float, bold: bool = False) -> float:
    """Metres that a text takes whose capitals are so high."""
    return stringWidth(text, _font(bold), height / _CAPITAL)


def fitting_height(text: str, height: float, room: float, bold: bool = False) -> float:
    """The height of capitals, or a smaller one with which the text fits the room; metres."""
    return min(height, height * room / text_width(text, height, bold))


def millimetres(metres: float) -> str:
    """A length as people measure it."""
    return f"{1000.0 * metres:.6g} mm"


@functools.lru_cache(maxsize=None)
def _font(bold: bool) -> str:
    """A font that goes into the file: print shops refuse files without, and every viewer shows the same."""
    name = "DejaVuSans-Bold" if bold else "DejaVuSans"
    registerFont(TTFont(name, f"{matplotlib.get_data_path()}/fonts/ttf/{name}.ttf"))
    return name
