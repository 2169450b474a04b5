# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""YAML 1.1 (as roslaunch reads it) with line numbers; duplicate names are refused."""

import math
import textwrap
from typing import Any, Dict, Iterable, List, Optional, Tuple, Type

import yaml

from sextant.markers.formats.format_types import MapFileError, finite, read_text

MAX_INT = 2**31 - 1  # ids are 32-bit integers in the core


class Table(dict):
    """A mapping in a YAML file. Its methods raise MapFileError with file, line and reason."""

    def __init__(self, path: str, line: int):
        super().__init__()
        self.path, self.place = path, f"{path}:{line}"
        self.lines: Dict[Any, int] = {}

    def mistake(self, reason: str, name: Optional[str] = None) -> MapFileError:
        """Returns an error with the location of this table, or of a name in it."""
        if name is None:
            return MapFileError(f"{self.place}: {reason}")
        place = f"{self.path}:{self.lines[name]}" if name in self.lines else self.place
        return MapFileError(f"{place}: '{name}' {reason}")

    def require(self, what: str, needed: Iterable[str], optional: Iterable[str] = ()) -> None:
        """Refuses missing and unknown names.

        :param what: what the table describes, for the error
        """
        for name in self:
            if name not in {*needed, *optional}:
                raise self.mistake(f"is not a name in {what}: is it misspelt?", name)
        for name in needed:
            if name not in self:
                raise self.mistake(f"{what} lacks '{name}'")

    def number(self, name: str, default: Optional[float] = None) -> float:
        """Returns a finite number."""
        if default is not None and name not in self:
            return default
        return self._finite(name, self[name])

    def numbers(self, name: str, count: int) -> List[float]:
        """Returns a list of count finite numbers."""
        values = self[name]
        if not isinstance(values, list) or len(values) != count:
            raise self.mistake(f"must be a list of {count} numbers", name)
        return [self._finite(name, value) for value in values]

    def whole(self, name: str) -> int:
        """Returns a 32-bit integer."""
        if isinstance(self[name], bool) or not isinstance(self[name], int):
            raise self.mistake(f"must be a whole number, not {_shown(self[name])}", name)
        if abs(self[name]) > MAX_INT:
            raise self.mistake("is too large for an id", name)
        return self[name]

    def word(self, name: str) -> str:
        """Returns a string."""
        return self._of_type(name, str, "a word")

    def flag(self, name: str) -> bool:
        """Returns a boolean."""
        return self._of_type(name, bool, "true or false")

    def table(self, name: str) -> "Table":
        """Returns a nested table."""
        return self._of_type(name, Table, "a table of names and values")

    def tables(self, name: str) -> List["Table"]:
        """Returns a list of tables; empty if the name is missing or has no value."""
        rows = self.get(name)
        rows = [] if rows is None else rows
        if not isinstance(rows, list) or not all(isinstance(row, Table) for row in rows):
            raise self.mistake("must be a list of tables of names and values", name)
        return rows

    def _finite(self, name: str, value: Any) -> float:
        # 1e-5 is a number in YAML 1.2 (ROS 2), but a string in YAML 1.1
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
    """As yaml.SafeLoader, with mappings as Table."""


def _construct_table(loader: _Loader, node: yaml.MappingNode):
    table = Table(loader.name, node.start_mark.line + 1)
    yield table  # before its values: an alias may refer to it
    for name, line in _names(loader, node):
        if name in table.lines:
            raise MapFileError(f"{loader.name}:{line}: '{name}' is defined twice")
        table.lines[name] = line
    table.update(loader.construct_mapping(node))


def _names(loader: _Loader, node: yaml.MappingNode) -> List[Tuple[Any, int]]:
    """Returns names and lines, without those merged by <<, which a name may override."""
    names = [name for name, _ in node.value if name.tag != "tag:yaml.org,2002:merge"]
    for name in names:
        if not isinstance(name, yaml.ScalarNode):
            raise MapFileError(f"{loader.name}:{name.start_mark.line + 1}: a list or table cannot be a name")
    return [(loader.construct_object(name), name.start_mark.line + 1) for name in names]


_Loader.add_constructor("tag:yaml.org,2002:map", _construct_table)


def read_yaml(path: str) -> Table:
    """Reads a YAML file.

    :raises MapFileError: the file cannot be read, is not YAML or not a mapping, or a name is defined twice:
        "file:line: reason"
    """
    try:
        loader = _Loader(read_text(path))
        loader.name = path
        root = loader.get_single_data()
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise MapFileError(f"{path}:{line}: {error.problem or error.context}") from None
    except (yaml.YAMLError, ValueError) as error:  # e.g. a control character, the date 2020-03-32
        raise MapFileError(f"{path}: is no YAML: {str(error).splitlines()[0]}") from None
    except RecursionError:
        raise MapFileError(f"{path}: is nested too deeply") from None
    if not isinstance(root, Table):
        raise MapFileError(f"{path}: must be a table of names and values")
    return root
