# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What all commands have in common: how they read their arguments, answer, and refuse."""

import argparse
import sys
from pathlib import Path
from typing import Callable, List, NamedTuple, Optional, Sequence

INTERRUPTED = 130  # exit code of a program that Ctrl-C ended, as shells have it


class CommandParser(argparse.ArgumentParser):
    """Leaves the lines of its texts as they are; a wrong argument is a ValueError."""

    def __init__(self, **settings):
        super().__init__(formatter_class=argparse.RawDescriptionHelpFormatter, **settings)

    def error(self, message: str) -> None:
        raise ValueError(f"{message} (--help tells more)")


class Answer(NamedTuple):
    """What a command prints, and its exit code."""

    lines: List[str]
    exit_code: int = 0


def run(
    parser: CommandParser, arguments: Optional[Sequence[str]], work: Callable[[argparse.Namespace], Answer]
) -> int:
    """Prints the answer, or in one line why there is none. Positional arguments may stand anywhere.

    :returns: exit code; 2 for bad input, 130 when it was interrupted
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


def check_output(path: Path, force: bool) -> None:
    """Before anything is computed or written.

    :raises ValueError: the file is there and is not to be overwritten, or has no folder
    """
    if not path.parent.is_dir():
        raise ValueError(f"{path}: there is no folder {path.parent}")
    if path.is_dir():
        raise ValueError(f"{path}: is a folder")
    if (path.exists() or path.is_symlink()) and not force:
        raise ValueError(f"{path}: is there already; --force overwrites it")
