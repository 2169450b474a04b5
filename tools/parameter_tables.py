# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The parameter tables of the nodelets in doc/reference/nodes.md from the structs of the core."""

import re
from typing import Any

import sextant

STRUCTS = {
    "marker_detector": sextant.MarkerDetectorNodeParams,
    "marker_locator": sextant.MarkerLocatorNodeParams,
    "landmark_slam": sextant.LandmarkSlamNodeParams,
    "camera_driver": sextant.CameraDriverNodeParams,
}
HEAD = "| parameter | type | range | default | description |\n| --- | --- | --- | --- | --- |\n"


def literal(value: Any) -> str:
    """Formats a value as YAML; strings that would be read as another type are quoted."""
    if isinstance(value, str) and (not value or value.isdigit()):
        return f'"{value}"'
    return re.sub("'", "", str(value).lower() if isinstance(value, bool) else str(value))


def table_of(struct: type) -> str:
    """Returns the table of the parameters of a struct, Markdown."""
    defaults, rows = struct(), []
    for name, kind, allowed, unit, what in struct.fields():
        kind = f"{kind}, {unit}" if unit else kind
        allowed = re.sub(r"\b(\d)(0{6,})\b", lambda number: f"{number[1]}e{len(number[2])}", allowed)
        cells = [f"`{name}`", kind, allowed, f"`{literal(getattr(defaults, name))}`", what]
        rows.append(" ".join(["|", *(f"{cell} |" if cell else "|" for cell in cells)]))
    return HEAD + "\n".join(rows) + "\n"


def with_tables(page: str) -> str:
    """Returns the page with the table of each nodelet generated from its struct."""
    for node, struct in STRUCTS.items():
        below = page.index(f"\n## {node}\n")
        begin = page.index(HEAD, below)
        end = page.index("\n\n", begin) + 1
        page = page[:begin] + table_of(struct) + page[end:]
    return page
