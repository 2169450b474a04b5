# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Options of a command from a dataclass of parameters: --max-side sets the parameter max_side."""

import argparse
from typing import Any, Dict

from sextant.base.strict_params import Described, described

_TYPES = {"int": (int, "N"), "double": (float, "NUMBER"), "string": (str, "NAME")}  # with the metavar


def add_params_options(parser: Any, cls: type) -> None:
    """Adds an option for every parameter.

    :param parser: argparse.ArgumentParser, or an argument group
    :param cls: dataclass of numbers, strings and lists of them, see sextant.base.strict_params
    """
    for row in described(cls):
        element = row.kind.replace("list of ", "").rstrip("s")
        is_list, (kind, word) = element != row.kind, _TYPES[element]
        parser.add_argument(
            option(row.name), dest=row.name, type=kind, default=argparse.SUPPRESS,
            nargs="+" if is_list else None, metavar=row.unit.upper() or word, help=_help(row, is_list),
        )  # fmt: skip


def _help(row: Described, is_list: bool) -> str:
    default = " ".join(f"{each:g}" for each in row.default) if is_list else row.default
    shown = f" (default: {default})" if default != "" else ""
    return "; ".join(filter(None, [row.plain(), row.allowed])).replace("%", "%%") + shown


def option(name: str) -> str:
    """The option that sets a parameter."""
    return "--" + name.replace("_", "-")


def given_params(options: argparse.Namespace, cls: type) -> Dict[str, Any]:
    """The parameters that the options set, by name, for sextant.base.strict_params.parse_params()."""
    return {row.name: getattr(options, row.name) for row in described(cls) if hasattr(options, row.name)}
