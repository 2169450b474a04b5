# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Figures with the bars that they are held to, as text for people and as JSON."""

import math
from dataclasses import dataclass, field
from typing import Dict, List, Optional, Sequence, Tuple, Union

import numpy as np


@dataclass(frozen=True)
class Value:
    """A figure and its bar, if it has one."""

    value: float
    digits: int = 2
    at_most: Optional[float] = None
    at_least: Optional[float] = None

    @property
    def holds(self) -> bool:
        """Whether the bar holds. NaN (nothing was measured) holds no bar."""
        above = self.at_least is None or self.value >= self.at_least
        below = self.at_most is None or self.value <= self.at_most
        return bool(above and below)

    def __str__(self) -> str:
        text = f"{self.value:.{self.digits}f}"
        if self.at_most is not None:
            text += f" (<= {self.at_most:g})"
        if self.at_least is not None:
            text += f" (>= {self.at_least:g})"
        return text if self.holds else text + " FAILS"

    def as_json(self) -> dict:
        """Value, bars and whether they hold; null for what is not finite or not there."""
        value = float(self.value) if math.isfinite(self.value) else None
        bars = {"at_most": self.at_most, "at_least": self.at_least, "holds": self.holds}
        return {"value": value, **bars}


Row = Tuple[str, Sequence[Union[Value, str]]]


@dataclass(frozen=True)
class Table:
    """Rows of figures under one title; the samples by row are what a plot is drawn from."""

    title: str
    columns: Sequence[str]
    rows: List[Row]
    samples: Dict[str, np.ndarray] = field(default_factory=dict)  # which ones: what makes the table says

    @property
    def holds(self) -> bool:
        return all(cell.holds for _, cells in self.rows for cell in cells if isinstance(cell, Value))

    def __str__(self) -> str:
        lines = [["", *self.columns], *([name, *map(str, cells)] for name, cells in self.rows)]
        widths = [max(map(len, column)) for column in zip(*lines)]
        text = ["  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines]
        return "\n".join([self.title, *text])

    def as_json(self) -> dict:
        """Title and rows; a row has its name and its cells by column."""
        rows = [{"name": name, **self._cells_as_json(cells)} for name, cells in self.rows]
        return {"title": self.title, "holds": self.holds, "rows": rows}

    def _cells_as_json(self, cells: Sequence[Union[Value, str]]) -> dict:
        return {
            column: cell.as_json() if isinstance(cell, Value) else cell
            for column, cell in zip(self.columns, cells)
        }
