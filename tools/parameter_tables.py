# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The parameters of the nodes as tables of doc/reference/nodes.md and as plain text.

They come from the structs of the core and from the dataclasses that the rospy nodes read.
"""

import functools
import importlib
import re
from pathlib import Path
from typing import Any, Dict, List

import sextant
from sextant.base.strict_params import REQUIRED, Described, described

ROOT = Path(__file__).resolve().parents[1]
STRUCTS = {
    "marker_detector": sextant.MarkerDetectorNodeParams,
    "marker_locator": sextant.MarkerLocatorNodeParams,
    "landmark_slam": sextant.LandmarkSlamNodeParams,
    "camera_driver": sextant.CameraDriverNodeParams,
}
HEAD = "| parameter | type | range | default | description |\n| --- | --- | --- | --- | --- |\n"
WORDS = re.compile(r"[\w()-]+(?:, [\w()-]+)+")  # an allowed value is one of these
ASCII = {"…": "...", "→": "->", '"': "'"}


@functools.lru_cache(maxsize=None)
def records() -> Dict[str, type]:
    """Returns the dataclass of each rospy node that has parameters."""
    result = {}
    for path in sorted((ROOT / "src/sextant/nodes").rglob("*.py")):
        read = re.search(r"\bread_params\(([A-Z]\w+)\)", path.read_text(encoding="utf-8"))
        if read and (ROOT / "scripts/nodes" / path.stem).exists():
            module = importlib.import_module(f"sextant.nodes.{path.parent.name}.{path.stem}")
            result[path.stem] = getattr(module, read[1])
    return result


def snake_case(name: str) -> str:
    """MarkerDetector: marker_detector."""
    return re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()


def rows_of(node: str) -> List[Described]:
    """Returns the parameters of a node."""
    if node not in STRUCTS:
        return described(records()[node])
    defaults = STRUCTS[node]()
    return [Described(*field, getattr(defaults, field[0])) for field in defaults.fields()]


def literal(value: Any) -> str:
    """Formats a value as YAML; strings that would be read as another type are quoted."""
    if isinstance(value, str) and (not value or value.isdigit()):
        return f'"{value}"'
    value = list(value) if isinstance(value, tuple) else value
    return re.sub("'", "", str(value).lower() if isinstance(value, bool) else str(value))


def row_of(row: Described) -> str:
    """Returns the row of a parameter, Markdown."""
    kind = f"{row.kind}, {row.unit}" if row.unit else row.kind
    allowed = re.sub(r"\b(\d)(0{6,})\b", lambda number: f"{number[1]}e{len(number[2])}", row.allowed)
    default = "required" if row.default is REQUIRED else f"`{literal(row.default)}`"
    cells = [f"`{row.name}`", kind, allowed, default, row.what]
    return " ".join(["|", *(f"{cell} |" if cell else "|" for cell in cells)]) + "\n"


def with_tables(page: str) -> str:
    """Returns the page with the table of each node; the rows keep their order, new ones are the last."""
    for node in [*STRUCTS, *records()]:
        below = page.index(f"\n## {node}\n")
        begin = page.index(HEAD, below)
        end = page.index("\n\n", begin) + 1
        order = re.findall(r"^\| `(\w+)`", page[begin:end], re.M)
        rows = sorted(
            rows_of(node), key=lambda row: order.index(row.name) if row.name in order else len(order)
        )
        page = page[:begin] + HEAD + "".join(map(row_of, rows)) + page[end:]
    return page


def plain(row: Described, node: str) -> str:
    """Returns the description of a parameter with unit and words to choose from, without Markdown.

    :param node: name of the node, in place of ~
    """
    text = row._replace(what=re.sub(r"`~(\w+)`", rf"{node}/\1", row.what)).plain()
    text = "".join(ASCII.get(letter, letter) for letter in text)
    first, semicolon, others = text.partition("; ")
    if row.unit and not re.search(rf"[a-z] {re.escape(row.unit)}$", first):  # "number of bits"
        first += f", {row.unit}"
    words = row.allowed.split(", ") if WORDS.fullmatch(row.allowed) else []
    if not all(re.search(rf"\b{re.escape(word)}(?!\w)", text) for word in words):
        first += f"{'; values' if ': ' in first else ''}: {', '.join(words[:-1])} or {words[-1]}"
    first += ", as a YAML list" if row.kind.startswith("list") else ""
    return first + semicolon + others
