# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Argument parsing, output and errors of all commands."""

import argparse
import os
import sys
from pathlib import Path
from typing import Callable, List, NamedTuple, Optional, Sequence, Tuple

INTERRUPTED = 130  # exit code after Ctrl-C, by convention of the shell


class CommandParser(argparse.ArgumentParser):
    """Argument parser that keeps line breaks in its texts and raises ValueError for a wrong argument."""

    def __init__(self, **settings):
        super().__init__(formatter_class=argparse.RawDescriptionHelpFormatter, **settings)

    def error(self, message: str) -> None:
        """:raises ValueError: always"""
        raise ValueError(f"{message} (see --help)")


class Answer(NamedTuple):
    """Output lines and exit code of a command."""

    lines: List[str]  # for standard output
    exit_code: int = 0  # 0: success


def run(
    parser: CommandParser, arguments: Optional[Sequence[str]], work: Callable[[argparse.Namespace], Answer]
) -> int:
    """Runs a command and prints its answer, or an error in one line.

    Positional arguments may follow options.

    :param arguments: None: those of the process
    :param work: computes the answer from the parsed arguments
    :returns: exit code; 2 for invalid input, 130 after Ctrl-C
    """
    try:
        lines, exit_code = work(parser.parse_intermixed_args(arguments))
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        reason = f"{where}{error.strerror or error}"
    except (ValueError, RuntimeError) as error:
        reason = str(error)
    except KeyboardInterrupt:
        print(f"{parser.prog}: interrupted", file=sys.stderr)
        return INTERRUPTED
    else:
        print("\n".join(lines))
        return exit_code
    print(f"{parser.prog}: {reason}", file=sys.stderr)
    return 2


def whole_pair(text: str, form: str) -> Tuple[int, int]:
    """Parses two whole numbers with an x between them.

    :param form: the expected form, for the error
    :raises argparse.ArgumentTypeError: another form
    """
    first, cross, second = text.partition("x")
    if not (cross and first.isdecimal() and second.isdecimal()):
        raise argparse.ArgumentTypeError(f"'{text}' is not of the form {form}")
    return int(first), int(second)


def check_output(path: Path, force: bool) -> None:
    """Checks a path of an output file before anything is computed.

    :param force: overwrite an existing file
    :raises ValueError: the file exists and force is False, it is a folder, or its folder does not exist or is
        write-protected
    """
    if not path.parent.is_dir():
        raise ValueError(f"{path}: there is no folder {path.parent}")
    if path.is_dir():
        raise ValueError(f"{path}: is a folder")
    if not os.access(path.parent, os.W_OK):
        raise ValueError(f"{path}: the folder {path.parent} is write-protected")
    if (path.exists() or path.is_symlink()) and not force:
        raise ValueError(f"{path}: already exists; --force overwrites it")
