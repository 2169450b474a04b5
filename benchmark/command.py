# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Command line of all benchmarks: measures topics and writes tables, JSON and pictures."""

import argparse
import importlib
import json
import re
import sys
from pathlib import Path
from typing import Callable, Dict, Iterable, List, Optional, Tuple

from real_data import EXTERNAL
from tables import Table

from sextant.base.atomic_file import atomic_file

Topics = Dict[str, Callable[[argparse.Namespace], List[Table]]]
Results = Dict[str, List[Table]]


def run(topics: Topics, what: Optional[str], pictures: Optional[str] = None) -> int:
    """Measures the chosen topics. Returns the exit status: 0 when every bar holds, 1, or 2.

    A bar is a limit that a figure must keep. 1: a bar fails; 2: a topic could not be measured.

    :param topics: name: function of the options that returns tables, or raises OSError if its data is missing
    :param what: the script's docstring
    :param pictures: module whose plot() writes pictures of the results into a folder, for the option --plots
    """
    options = _parse(topics, what, pictures)
    stream = sys.stderr if options.json == "-" else sys.stdout
    results: Results = {}
    for name in options.only:
        try:
            results[name] = topics[name](options)
        except OSError as error:
            print(f"{name} could not be measured: {error}", file=sys.stderr)
            return 2
        print("\n\n".join(map(str, results[name])), end="\n\n", file=stream, flush=True)
        if options.markdown:
            write_section(options.markdown, Path(sys.argv[0]).stem, what or "", topics, {name: results[name]})
    holds = all(table.holds for tables in results.values() for table in tables)
    print("every bar holds" if holds else "a bar FAILS", file=stream)
    _write(options, pictures, results, holds)
    return 0 if holds else 1


def _parse(topics: Topics, what: Optional[str], pictures: Optional[str]) -> argparse.Namespace:
    """Parses the command line; exits with an error message if an option is invalid."""
    parser = argparse.ArgumentParser(description=what, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="smoke run: few frames, without bars")
    parser.add_argument("--only", default=",".join(topics), help="topics, with commas (default: %(default)s)")
    parser.add_argument(
        "--data", type=Path, default=EXTERNAL, help="external test data (default: %(default)s)"
    )
    parser.add_argument("--json", metavar="FILE", help="figures for machines; -: on standard output")
    parser.add_argument(
        "--markdown", type=Path, metavar="PAGE", help="page that the figures of the topics are written into"
    )
    parser.set_defaults(plots=None)
    if pictures:
        parser.add_argument("--plots", type=Path, metavar="DIR", help="pictures of the topics, one a file")
    options = parser.parse_args()
    options.only = options.only.split(",")
    unknown = sorted(set(options.only) - set(topics))
    if unknown:
        parser.error(f"--only: no topic {', '.join(unknown)}; there are {', '.join(topics)}")
    _check_writable(parser, options)
    return options


def _check_writable(parser: argparse.ArgumentParser, options: argparse.Namespace) -> None:
    """Checks the output paths before measuring, which may take an hour."""
    if options.json and not Path(options.json).parent.is_dir():
        parser.error(f"--json: there is no folder {Path(options.json).parent}")
    if options.markdown and options.quick:
        parser.error("--markdown: not with --quick, which has no bars")
    if options.markdown:
        try:
            divided(options.markdown, Path(sys.argv[0]).stem)
        except (OSError, ValueError) as error:
            parser.error(f"--markdown: {error}")
    if options.plots:
        try:
            options.plots.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            parser.error(f"--plots: {options.plots}: {error.strerror}")


def _write(options: argparse.Namespace, pictures: Optional[str], results: Results, holds: bool) -> None:
    """Writes the output files that the options request."""
    if options.json:
        _write_json(options, results, holds)
    if options.plots and pictures:
        importlib.import_module(pictures).plot(options.plots, results)  # matplotlib takes a second to load


def _write_json(options: argparse.Namespace, results: Results, holds: bool) -> None:
    topics = {name: [table.as_json() for table in tables] for name, tables in results.items()}
    text = json.dumps({"holds": holds, "quick": options.quick, "topics": topics}, indent=1) + "\n"
    if options.json == "-":
        sys.stdout.write(text)
    else:
        Path(options.json).write_text(text)


def write_section(page: Path, script: str, what: str, topics: Iterable[str], results: Results) -> None:
    """Writes the topics of results into the section of a script in a page; other topics are kept.

    :param topics: all of the script, in their order
    :raises ValueError: see divided()
    """
    before, section, after = divided(page, script)
    split = re.split(r"<!-- topic (\w+) -->", section)
    parts = dict(zip(split[1::2], map(str.strip, split[2::2])))
    for name, tables in results.items():
        parts[name] = "\n\n".join(table.as_markdown() for table in tables)
    summary = " ".join(what.strip().partition("\n\n")[0].split())
    body = "\n\n".join(f"<!-- topic {name} -->\n\n{parts[name]}" for name in topics if name in parts)
    with atomic_file(page, "w") as file:
        file.write(f"{before}<!-- begin {script} -->\n## {script}\n\n{summary}\n\n{body}\n")
        file.write(f"<!-- end {script} -->\n{after}")


def divided(page: Path, script: str) -> Tuple[str, str, str]:
    """Returns what a page has before, in and after the section of a script.

    :raises ValueError: the comments around the section or its topics are damaged: something would be lost
    """
    begin, end, text = f"<!-- begin {script} -->\n", f"<!-- end {script} -->\n", page.read_text()
    if begin.strip() not in text and end.strip() not in text:
        return f"{text.rstrip()}\n\n", "", ""
    before, _, rest = text.partition(begin)
    section, _, after = rest.partition(end)
    names = re.findall(r"<!-- topic (\w+) -->", section)
    is_damaged = (
        (text.count(begin), text.count(end)) != (1, 1)
        or end in before
        or "<!-- begin " in section
        or "### " in section.partition("<!-- topic ")[0]
        or len(set(names)) != len(re.findall("<!-- *topic", section))
    )
    if is_damaged:
        raise ValueError(f"{page}: the comments of the section of {script} are damaged; restore them")
    return before, section, after
