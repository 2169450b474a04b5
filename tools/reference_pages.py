#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes what follows from the sources: pages of doc/reference, texts of arguments in launch/ and cfg/."""

import ast
import sys
from pathlib import Path
from typing import Dict

import cfg_docs
import launch_docs
import launch_pages
import parameter_tables

ROOT = Path(__file__).resolve().parents[1]
REFERENCE = ROOT / "doc/reference"
COMMANDS = """# Commands

Written by `tools/reference_pages.py`. Run them as `rosrun sextant COMMAND`; `--help` lists the options.

| command | description | page |
| --- | --- | --- |
"""
MESSAGES = """# Messages and services

Written by `tools/reference_pages.py` from `msg/` and `srv/`; `rosmsg show sextant/NAME` prints
the fields, too.
"""


def commands() -> str:
    """Returns the page of the commands: the first sentence of each program, and the page that explains it."""
    rows = []
    for path in sorted((ROOT / "src/sextant/commands").rglob("*.py"), key=lambda path: path.name):
        if (ROOT / "scripts" / path.stem).exists():
            text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
            page = page_of(path.stem)
            rows.append(
                f"| `{path.stem}` | {text.splitlines()[0]} | [{page.stem}](../how_to/{page.name}) |\n"
            )
    return COMMANDS + "".join(rows)


def page_of(command: str) -> Path:
    """Returns the how-to page that runs a command most often."""
    return max(
        sorted((ROOT / "doc/how_to").glob("*.md")),
        key=lambda page: page.read_text().count(f"sextant {command}"),
    )


def messages() -> str:
    """Returns the page of the messages and services: their files."""
    parts = [MESSAGES.rstrip()]
    for path in [*sorted((ROOT / "msg").iterdir()), *sorted((ROOT / "srv").iterdir())]:
        lines = [line for line in path.read_text(encoding="utf-8").splitlines() if "SPDX" not in line]
        parts.append(f"## {path.stem}\n\n```text\n" + "\n".join(lines).strip() + "\n```")
    return "\n\n".join(parts) + "\n"


def pages() -> Dict[Path, str]:
    """Returns the text of each page."""
    nodes = REFERENCE / "nodes.md"
    return {
        nodes: parameter_tables.with_tables(nodes.read_text(encoding="utf-8")),
        REFERENCE / "launch_files.md": launch_pages.page(),
        REFERENCE / "commands.md": commands(),
        REFERENCE / "messages.md": messages(),
    }


STEPS = (launch_docs.files, cfg_docs.files, pages)  # launch_files.md has the texts of launch/


if __name__ == "__main__":
    for step in STEPS:
        for path, text in step().items():
            if not path.exists() or path.read_text(encoding="utf-8") != text:
                path.write_text(text, encoding="utf-8")
                print(f"{path}: changed", file=sys.stderr)
