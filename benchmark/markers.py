#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the marker chain on real and simulated input, and whether it is as good as README.md says.

Exit status: 0 when every bar holds, 1 when one fails, 2 when something could not be measured.
"""

import argparse
import json
import sys
from pathlib import Path
from typing import Dict, List

from chain import chain_tables
from real_data import EXTERNAL, Photos
from real_photos import photo_tables
from recorded_drives import recording_tables
from simulated_drives import drive_tables
from tables import Table

PARTS = {
    "photos": lambda options: photo_tables(Photos(options.data / "markers/photos")),
    "tagslam": lambda options: recording_tables(options.data / "markers"),
    "simulated": lambda options: drive_tables(options.quick),
    "chain": lambda options: chain_tables(options.quick),
}


def main(arguments: List[str]) -> int:
    options = _parse(arguments)
    say = sys.stderr if options.json == "-" else sys.stdout
    results: Dict[str, List[Table]] = {}
    for name in options.only:
        try:
            results[name] = PARTS[name](options)
        except OSError as error:
            print(f"{name} could not be measured: {error}", file=sys.stderr)
            return 2
        print("\n\n".join(map(str, results[name])), end="\n\n", file=say, flush=True)
    tables = [table for part in results.values() for table in part]
    holds = all(table.holds for table in tables)
    print("every bar holds" if holds else "a bar FAILS", file=say)
    _write(options, results, holds)
    return 0 if holds else 1


def _parse(arguments: List[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="smoke run: short drives, without their bars")
    parser.add_argument("--only", default=",".join(PARTS), help="parts, with commas (default: %(default)s)")
    parser.add_argument(
        "--data", type=Path, default=EXTERNAL, help="external test data (default: %(default)s)"
    )
    parser.add_argument("--json", metavar="FILE", help="figures for machines; -: on standard output")
    parser.add_argument("--plot", metavar="FILE", help="picture of the errors by mode (.png, .pdf, .svg)")
    options = parser.parse_args(arguments)
    options.only = options.only.split(",")
    unknown = sorted(set(options.only) - set(PARTS))
    if unknown:
        parser.error(f"--only: no part {', '.join(unknown)}; there are {', '.join(PARTS)}")
    return options


def _write(options: argparse.Namespace, results: Dict[str, List[Table]], holds: bool) -> None:
    if options.json:
        parts = {name: [table.as_json() for table in tables] for name, tables in results.items()}
        text = json.dumps({"holds": holds, "quick": options.quick, "parts": parts}, indent=1) + "\n"
        if options.json == "-":
            sys.stdout.write(text)
        else:
            Path(options.json).write_text(text)
    if options.plot:
        from error_plot import plot_errors  # only now: matplotlib takes a second to load

        plot_errors(options.plot, [table for tables in results.values() for table in tables if table.samples])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
