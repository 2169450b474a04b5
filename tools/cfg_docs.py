# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The texts of the parameters in cfg/: their descriptions in the structs of the core."""

import re
from pathlib import Path
from typing import Dict

from parameter_tables import ROOT, plain, rows_of, snake_case


def files() -> Dict[Path, str]:
    """Returns the text of each file in cfg/."""
    return {path: with_texts(path) for path in sorted((ROOT / "cfg").glob("*.cfg"))}


def with_texts(path: Path) -> str:
    """Returns a file of cfg/ with the texts of its parameters."""
    node = snake_case(path.stem)
    texts = {row.name: plain(row, node) for row in rows_of(node)}
    added = re.compile(r'(\bgen\.add\(\s*"(\w+)", \w+, \w+, )"[^"]*"')
    return added.sub(lambda found: f'{found[1]}"{texts[found[2]]}"', path.read_text(encoding="utf-8"))
