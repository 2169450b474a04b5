# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Figures with their bars (limits that they must keep), as text, Markdown and JSON."""

import math
from dataclasses import dataclass, field
from typing import Dict, List, Optional, Sequence, Tuple, Union

import numpy as np


@dataclass(frozen=True)
class Value:
    """A figure and its bar, if it has one."""

    value: float
    digits: int = 2  # decimals in texts
    at_most: Optional[float] = None
    at_least: Optional[float] = None

    @property
    def holds(self) -> bool:
        """Whether the value keeps its bars. NaN (nothing was measured) keeps none."""
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
        """Value, bars and whether they hold; None if the value is not finite or there is no bar."""
        value = float(self.value) if math.isfinite(self.value) else None
        bars = {"at_most": self.at_most, "at_least": self.at_least, "holds": self.holds}
        return {"value": value, **bars}


Row = Tuple[str, Sequence[Union[Value, str]]]


@dataclass(frozen=True)
class Table:
    """Rows of figures under one title, with samples for plots."""

    title: str
    columns: Sequence[str]
    rows: List[Row]
    samples: Dict[str, np.ndarray] = field(default_factory=dict)  # by name; each table defines their shape

    @property
    def holds(self) -> bool:
        """Whether all bars hold."""
        return all(cell.holds for _, cells in self.rows for cell in cells if isinstance(cell, Value))

    def __str__(self) -> str:
        lines = [["", *self.columns], *([name, *map(str, cells)] for name, cells in self.rows)]
        widths = [max(map(len, column)) for column in zip(*lines)]
        text = ["  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines]
        return "\n".join([self.title, *text])

    def as_markdown(self) -> str:
        """A Markdown heading and table."""
        lines = [["", *self.columns], ["---"] * (len(self.columns) + 1)]
        lines += [[name, *map(str, cells)] for name, cells in self.rows]
        return "\n".join([f"### {self.title}\n", *(f"| {' | '.join(line)} |" for line in lines)])

    def as_json(self) -> dict:
        """Title and rows; each row has a name and its cells by column."""
        rows = [{"name": name, **self._cells_as_json(cells)} for name, cells in self.rows]
        return {"title": self.title, "holds": self.holds, "rows": rows}

    def _cells_as_json(self, cells: Sequence[Union[Value, str]]) -> dict:
        return {
            column: cell.as_json() if isinstance(cell, Value) else cell
            for column, cell in zip(self.columns, cells)
        }
