# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The command line that all benchmarks share: topics in; tables, JSON, pictures and an exit status out."""

import argparse
import json
import sys
from pathlib import Path
from typing import Callable, Dict, List, Optional

from real_data import EXTERNAL
from tables import Table

Topics = Dict[str, Callable[[argparse.Namespace], List[Table]]]
Results = Dict[str, List[Table]]
Drawing = Callable[[str, Results], None]


def run(topics: Topics, what: Optional[str], draw: Drawing, arguments: List[str]) -> int:
    """Exit status: 0 when every bar holds, 1 when one fails, 2 when something could not be measured.

    :param topics: what measures each, from the options quick and data; OSError where its data is not there
    :param what: the script's doc string
    :param draw: writes pictures of the results into a folder
    """
    options = _parse(topics, what, arguments)
    say = sys.stderr if options.json == "-" else sys.stdout
    results: Results = {}
    for name in options.only:
        try:
            results[name] = topics[name](options)
        except OSError as error:
            print(f"{name} could not be measured: {error}", file=sys.stderr)
            return 2
        print("\n\n".join(map(str, results[name])), end="\n\n", file=say, flush=True)
    holds = all(table.holds for tables in results.values() for table in tables)
    print("every bar holds" if holds else "a bar FAILS", file=say)
    if options.json:
        _write(options, results, holds)
    if options.plots:
        draw(options.plots, results)
    return 0 if holds else 1


def _parse(topics: Topics, what: Optional[str], arguments: List[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=what, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="smoke run: few frames, without bars")
    parser.add_argument("--only", default=",".join(topics), help="topics, with commas (default: %(default)s)")
    parser.add_argument(
        "--data", type=Path, default=EXTERNAL, help="external test data (default: %(default)s)"
    )
    parser.add_argument("--json", metavar="FILE", help="figures for machines; -: on standard output")
    parser.add_argument("--plots", metavar="DIR", help="pictures of the topics, one a file")
    options = parser.parse_args(arguments)
    options.only = options.only.split(",")
    unknown = sorted(set(options.only) - set(topics))
    if unknown:
        parser.error(f"--only: no topic {', '.join(unknown)}; there are {', '.join(topics)}")
    _check_writable(parser, options)
    return options


def _check_writable(parser: argparse.ArgumentParser, options: argparse.Namespace) -> None:
    """Before anything is measured: it may take an hour."""
    if options.json and not Path(options.json).parent.is_dir():
        parser.error(f"--json: there is no folder {Path(options.json).parent}")
    if options.plots:
        try:
            Path(options.plots).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            parser.error(f"--plots: {options.plots}: {error.strerror}")


def _write(options: argparse.Namespace, results: Results, holds: bool) -> None:
    topics = {name: [table.as_json() for table in tables] for name, tables in results.items()}
    text = json.dumps({"holds": holds, "quick": options.quick, "topics": topics}, indent=1) + "\n"
    if options.json == "-":
        sys.stdout.write(text)
    else:
        Path(options.json).write_text(text)
