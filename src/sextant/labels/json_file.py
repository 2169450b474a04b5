# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads JSON files strictly."""

import json
import re
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Iterator, Optional


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


class ItemError(ValueError):
    """What is wrong with an element of a list in a JSON file."""

    def __init__(self, reason: str, name: str, index: int):
        """:param name: of the field with the list in the file's object; empty: the whole file is the list"""
        super().__init__(reason)
        self.name, self.index = name, index


@contextmanager
def item(title: str, name: str, index: int) -> Iterator[None]:
    """Errors within are ItemErrors, with the title of the element.

    :raises ItemError: name and index are as in it
    """
    try:
        yield
    except ValueError as error:
        raise ItemError(f"{title}: {error}", name, index) from None


def located(path: Path, error: ValueError) -> ValueError:
    """An error with the path of its file, which read_json() has read, and the line of an ItemError."""
    line = line_of(path, error.index, error.name) if isinstance(error, ItemError) else None
    return ValueError(f"{path}{f':{line}' if line else ''}: {error}")


def line_of(path: Path, index: int, name: str) -> Optional[int]:
    """Line at which an element of a list begins; name and index are as in ItemError.

    :returns: None: there is no such list
    """
    text, blank = path.read_text(encoding="utf-8"), re.compile(r"[\s,]*")
    begin = re.search(rf'"{re.escape(name)}"\s*:\s*\[' if name else r"\[", text)
    if not begin:
        return None
    at = begin.end()
    for _ in range(index):
        _, at = json.JSONDecoder().raw_decode(text, blank.match(text, at).end())
    return text.count("\n", 0, blank.match(text, at).end()) + 1
