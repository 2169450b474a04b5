# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Figures that are written to files."""

import io
from pathlib import Path
from typing import Union

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from sextant.base.atomic_file import atomic_file

DPI = 110


def new_figure(
    path: Union[str, Path], width: float, height: float, constrained_layout: bool = False
) -> Figure:
    """Creates a figure for a file; without pyplot, which has global state and may need a window system.

    :param path: the ending selects the format (.png, .pdf, .svg)
    :param width, height: inches
    :param constrained_layout: arranges the panels without overlaps
    :raises ValueError: the ending is not an image format
    """
    figure = Figure(figsize=(width, height), constrained_layout=constrained_layout)
    if _format(path) not in FigureCanvasAgg(figure).get_supported_filetypes():
        raise ValueError(f"{path}: '{_format(path)}' is not an image format")
    return figure


def save_figure(path: Union[str, Path], figure: Figure) -> None:
    """Writes a figure atomically.

    :raises OSError: the file cannot be written; an existing one is unchanged
    """
    with atomic_file(path, "wb") as file:
        figure.savefig(file, format=_format(path), dpi=DPI)


def figure_png(figure: Figure) -> bytes:
    """Returns a figure as PNG, for a page."""
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=DPI)
    return file.getvalue()


def _format(path: Union[str, Path]) -> str:
    return Path(path).suffix.lstrip(".").lower()
