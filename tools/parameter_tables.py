#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the parameter tables of the nodelets in doc/nodes.md from the structs of the core."""

import re
import sys
from pathlib import Path
from typing import Any

import sextant

PAGE = Path(__file__).resolve().parents[1] / "doc/nodes.md"
STRUCTS = {
    "marker_detector": sextant.MarkerDetectorNodeParams,
    "marker_locator": sextant.MarkerLocatorNodeParams,
    "landmark_slam": sextant.LandmarkSlamNodeParams,
    "camera_driver": sextant.CameraDriverNodeParams,
}
HEAD = "| parameter | type | range | default | what |\n| --- | --- | --- | --- | --- |\n"


def literal(value: Any) -> str:
    """As YAML has it; a text that would be something else there, in quotes."""
    if isinstance(value, str) and (not value or value.isdigit()):
        return f'"{value}"'
    return re.sub("'", "", str(value).lower() if isinstance(value, bool) else str(value))


def table_of(struct: type) -> str:
    """The table of a struct's parameters, Markdown."""
    defaults, rows = struct(), []
    for name, kind, allowed, unit, what in struct.fields():
        kind = f"{kind}, {unit}" if unit else kind
        allowed = re.sub(r"\b(\d)(0{6,})\b", lambda number: f"{number[1]}e{len(number[2])}", allowed)
        cells = [f"`{name}`", kind, allowed, f"`{literal(getattr(defaults, name))}`", what]
        rows.append(" ".join(["|", *(f"{cell} |" if cell else "|" for cell in cells)]))
    return HEAD + "\n".join(rows) + "\n"


def with_tables(page: str) -> str:
    """The page with the table below each nodelet's heading as the struct has it."""
    for node, struct in STRUCTS.items():
        below = page.index(f"\n## {node}\n")
        begin = page.index(HEAD, below)
        end = page.index("\n\n", begin) + 1
        page = page[:begin] + table_of(struct) + page[end:]
    return page


if __name__ == "__main__":
    text = PAGE.read_text(encoding="utf-8")
    new = with_tables(text)
    PAGE.write_text(new, encoding="utf-8")
    print("up to date" if new == text else "changed", file=sys.stderr)
