# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""YAML (1.1, as roslaunch reads it) whose tables know their lines, and refuse what is there twice."""

import math
import textwrap
from typing import Any, Dict, Iterable, List, Optional, Tuple, Type

import yaml

from sextant.markers.formats.map_file import MapFileError, finite, read_text

LARGEST_WHOLE = 2**31 - 1  # of the core's ids


class Table(dict):
    """Names and values of a YAML file. Its readers raise MapFileError with file, line and reason."""

    def __init__(self, path: str, line: int):
        super().__init__()
        self.path, self.line = path, line
        self.lines: Dict[Any, int] = {}

    def mistake(self, reason: str, name: Optional[str] = None) -> MapFileError:
        """The error of this table, or of a name in it."""
        if name is None:
            return MapFileError(f"{self.path}:{self.line}: {reason}")
        return MapFileError(f"{self.path}:{self.lines.get(name, self.line)}: '{name}' {reason}")

    def require(self, what: str, needed: Iterable[str], optional: Iterable[str] = ()) -> None:
        """Refuses names that are missing, and names that nobody would look at."""
        for name in self:
            if name not in {*needed, *optional}:
                raise self.mistake(f"is no name that {what} has: is it misspelt?", name)
        for name in needed:
            if name not in self:
                raise self.mistake(f"{what} lacks '{name}'")

    def number(self, name: str, default: Optional[float] = None) -> float:
        if default is not None and name not in self:
            return default
        return self._finite(name, self[name])

    def numbers(self, name: str, count: int) -> List[float]:
        values = self[name]
        if not isinstance(values, list) or len(values) != count:
            raise self.mistake(f"must be a list of {count} numbers", name)
        return [self._finite(name, value) for value in values]

    def whole(self, name: str) -> int:
        if isinstance(self[name], bool) or not isinstance(self[name], int):
            raise self.mistake(f"must be a whole number, not {_shown(self[name])}", name)
        if abs(self[name]) > LARGEST_WHOLE:
            raise self.mistake("is too large for an id", name)
        return self[name]

    def word(self, name: str) -> str:
        return self._of_type(name, str, "a word")

    def flag(self, name: str) -> bool:
        return self._of_type(name, bool, "true or false")

    def table(self, name: str) -> "Table":
        return self._of_type(name, Table, "a table of names and values")

    def tables(self, name: str) -> List["Table"]:
        """A list of tables; without the name, or with nothing behind it, there are none."""
        rows = self.get(name)
        rows = [] if rows is None else rows
        if not isinstance(rows, list) or not all(isinstance(row, Table) for row in rows):
            raise self.mistake("must be a list of tables of names and values", name)
        return rows

    def _finite(self, name: str, value: Any) -> float:
        # 1e-5 is a number to YAML 1.2 (ROS 2), but a word to YAML 1.1
        if isinstance(value, str):
            try:
                return finite(value)
            except ValueError as error:
                raise self.mistake(f"needs a number: {error}", name) from None
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) < math.inf:
            raise self.mistake(f"must be a finite number, not {_shown(value)}", name)
        return float(value)

    def _of_type(self, name: str, kind: Type, wanted: str) -> Any:
        if not isinstance(self[name], kind):
            raise self.mistake(f"must be {wanted}, not {_shown(self[name])}", name)
        return self[name]


def _shown(value: Any) -> str:
    return textwrap.shorten(repr(value), 60, placeholder=" ...")


class _Loader(yaml.SafeLoader):
    """Plain values only, as yaml.safe_load; tables as Table."""


def _construct_table(loader: _Loader, node: yaml.MappingNode):
    table = Table(loader.name, node.start_mark.line + 1)
    yield table  # before its values: an alias may name it
    for name, line in _names(loader, node):
        if name in table.lines:
            raise MapFileError(f"{loader.name}:{line}: '{name}' is there twice")
        table.lines[name] = line
    table.update(loader.construct_mapping(node))


def _names(loader: _Loader, node: yaml.MappingNode) -> List[Tuple[Any, int]]:
    """Names and their lines, without those that << takes from another table: a name may overrule them."""
    names = [name for name, _ in node.value if name.tag != "tag:yaml.org,2002:merge"]
    for name in names:
        if not isinstance(name, yaml.ScalarNode):
            raise MapFileError(f"{loader.name}:{name.start_mark.line + 1}: a list or table cannot be a name")
    return [(loader.construct_object(name), name.start_mark.line + 1) for name in names]


_Loader.add_constructor("tag:yaml.org,2002:map", _construct_table)


def read_yaml(path: str) -> Table:
    """The table that a YAML file is.

    :raises MapFileError: no file, no YAML, no table, or a name that is there twice: "file:line: reason"
    """
    try:
        loader = _Loader(read_text(path))
        loader.name = path
        root = loader.get_single_data()
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise MapFileError(f"{path}:{line}: {error.problem or error.context}") from None
    except (yaml.YAMLError, ValueError) as error:  # e.g. a control character, a 32nd of March
        raise MapFileError(f"{path}: is no YAML: {str(error).splitlines()[0]}") from None
    except RecursionError:
        raise MapFileError(f"{path}: is nested too deeply") from None
    if not isinstance(root, Table):
        raise MapFileError(f"{path}: must be a table of names and values")
    return root
