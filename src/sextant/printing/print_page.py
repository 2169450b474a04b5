# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Vector PDFs that print true to size. Metres, x right and y up from the lower left corner of the page."""

import functools
import io
from pathlib import Path
from typing import Iterable, Tuple, Union

import matplotlib
from reportlab.pdfbase.pdfmetrics import registerFont, stringWidth
from reportlab.pdfbase.ttfonts import TTFont
from reportlab.pdfgen.canvas import Canvas

from sextant.base.atomic_file import atomic_file

CONTROL_LINE = 0.1  # length, metres
FOOTER = 0.016  # height of the control line and its text, metres
_POINT = 0.0254 / 72.0  # typographic point, metres
_CAPITAL = 0.729  # height of a capital letter as a fraction of the font size
_CONTROL_TEXT = "This line is 100 mm long. If it is not, print again at 100 %, without fitting to the page."

Box = Tuple[float, float, float, float]  # left, bottom, right, top


class PrintPages:
    """A PDF document with pages of one size, in memory until it is saved."""

    def __init__(self, title: str, width: float, height: float):
        self.width, self.height = width, height
        self._data = io.BytesIO()
        size = (width / _POINT, height / _POINT)
        # invariant: reproducible bytes; the initial font is embedded whether used or not
        self._canvas = Canvas(self._data, pagesize=size, invariant=1, initialFontName=_font(False))
        self._canvas.setTitle(title)
        self._canvas.setCreator("Sextant")
        self._canvas.setViewerPreference("PrintScaling", "None")  # else viewers fit the page to the paper
        self._canvas.setViewerPreference("Duplex", "Simplex")

    def fill(self, boxes: Iterable[Box]) -> None:
        """Fills black boxes as one path, so that there are no hairlines between adjacent boxes."""
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
        """Draws a line of a width in metres; grey: 0 black to 1 white."""
        self._canvas.setStrokeGray(grey)
        self._canvas.setLineWidth(width / _POINT)
        self._canvas.line(x0 / _POINT, y0 / _POINT, x1 / _POINT, y1 / _POINT)

    def text(self, x: float, y: float, height: float, text: str, bold: bool = False) -> None:
        """Draws a text; x: left end, y: baseline, height: of capital letters."""
        self._canvas.setFillGray(0.0)
        self._canvas.setFont(_font(bold), height / _CAPITAL / _POINT)
        self._canvas.drawString(x / _POINT, y / _POINT, text)

    def centred_text(self, x: float, y: float, height: float, text: str) -> None:
        """Draws a text centred at x; y: baseline, height: of capital letters."""
        self.text(x - 0.5 * text_width(text, height), y, height, text)

    def end_page(self, margin: float, text: str) -> None:
        """Draws the control line and, below it, its text and the given text; ends the page."""
        middle, y = 0.5 * self.width, margin + 0.0085
        left = middle - 0.5 * CONTROL_LINE
        self.line(left, y, left + CONTROL_LINE, y)
        for i in range(11):
            tick, x = 0.0025 if i % 5 == 0 else 0.0015, left + 0.1 * i * CONTROL_LINE
            self.line(x, y - tick, x, y + tick)
        room = self.width - 2.0 * margin
        for line, below in ((_CONTROL_TEXT, 0.005), (text, 0.0085)):
            self.centred_text(middle, y - below, fitting_height(line, 0.0018, room), line)
        self._canvas.showPage()

    def save(self, path: Union[str, Path]) -> None:
        """Writes the file atomically; the document cannot be changed any more.

        :raises OSError: the file cannot be written
        """
        self._canvas.save()
        with atomic_file(path, "wb") as file:
            file.write(self._data.getvalue())


def text_width(text: str, height: float, bold: bool = False) -> float:
    """Returns the width of a text in metres; height: of capital letters, metres."""
    return stringWidth(text, _font(bold), height / _CAPITAL)


def fitting_height(text: str, height: float, room: float, bold: bool = False) -> float:
    """Returns height, or the largest height of capitals with which the text is at most room wide; metres."""
    return min(height, height * room / text_width(text, height, bold))


def millimetres(metres: float) -> str:
    """Formats a length in millimetres."""
    return f"{1000.0 * metres:.6g} mm"


@functools.lru_cache(maxsize=None)
def _font(bold: bool) -> str:
    """Registers a font to embed: print shops refuse files without it, and all viewers show the same."""
    name = "DejaVuSans-Bold" if bold else "DejaVuSans"
    registerFont(TTFont(name, f"{matplotlib.get_data_path()}/fonts/ttf/{name}.ttf"))
    return name
