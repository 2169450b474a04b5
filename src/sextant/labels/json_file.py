# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads JSON files strictly."""

import json
from pathlib import Path
from typing import Any


def read_json(path: Path) -> Any:
    """:raises OSError: the file cannot be read

    :raises ValueError: "file:line: reason"
    """
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except UnicodeDecodeError:
        raise ValueError(f"{path}: is not UTF-8 text") from None
    except json.JSONDecodeError as error:
        raise ValueError(f"{path}:{error.lineno}: is not JSON: {error.msg}") from None
    except RecursionError:
        raise ValueError(f"{path}: is nested too deeply") from None


def field(table: Any, name: str, *kinds: type) -> Any:
    """A field of a JSON object.

    :raises ValueError: it is missing or of another type
    """
    if not isinstance(table, dict) or name not in table:
        raise ValueError(f"has no field '{name}'")
    if not isinstance(table[name], kinds) or isinstance(table[name], bool):
        allowed = " or ".join(kind.__name__ for kind in kinds)
        raise ValueError(f"its field '{name}' is {str(table[name])[:40]!r}, it must be of type {allowed}")
    return table[name]
