#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures whether poses from markers can be trusted: covariance, ambiguity, moved markers, real recordings;
and what they cost.

Exit status: 0 when every bar holds, 1 when one fails, 2 when something could not be measured.
"""

import argparse
import json
import sys
from pathlib import Path
from typing import Dict, List

from chain import chain_tables
from consistency import consistency_tables
from detector_speed import speed_tables
from head_on import head_on_tables
from moved_marker import moved_marker_tables
from real_data import EXTERNAL
from recorded_trust import trust_tables
from tables import Table

TOPICS = {
    "consistency": lambda options: consistency_tables(options.quick),
    "head_on": lambda options: head_on_tables(options.quick),
    "moved_marker": lambda options: moved_marker_tables(options.quick),
    "real": lambda options: trust_tables(options.data / "markers", options.quick),
    "speed": lambda options: speed_tables(options.quick),
    "chain": lambda options: chain_tables(options.quick),
}


def main(arguments: List[str]) -> int:
    options = _parse(arguments)
    say = sys.stderr if options.json == "-" else sys.stdout
    results: Dict[str, List[Table]] = {}
    for name in options.only:
        try:
            results[name] = TOPICS[name](options)
        except OSError as error:
            print(f"{name} could not be measured: {error}", file=sys.stderr)
            return 2
        print("\n\n".join(map(str, results[name])), end="\n\n", file=say, flush=True)
    holds = all(table.holds for tables in results.values() for table in tables)
    print("every bar holds" if holds else "a bar FAILS", file=say)
    _write(options, results, holds)
    if options.plots:
        from trust_plots import plot_topics  # only now: matplotlib takes a second to load

        plot_topics(options.plots, results)
    return 0 if holds else 1


def _parse(arguments: List[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="smoke run: few frames, without bars")
    parser.add_argument("--only", default=",".join(TOPICS), help="topics, with commas (default: %(default)s)")
    parser.add_argument(
        "--data", type=Path, default=EXTERNAL, help="external test data (default: %(default)s)"
    )
    parser.add_argument("--json", metavar="FILE", help="figures for machines; -: on standard output")
    parser.add_argument("--plots", metavar="DIR", help="a picture a topic: DIR/TOPIC.png")
    options = parser.parse_args(arguments)
    options.only = options.only.split(",")
    unknown = sorted(set(options.only) - set(TOPICS))
    if unknown:
        parser.error(f"--only: no topic {', '.join(unknown)}; there are {', '.join(TOPICS)}")
    return options


def _write(options: argparse.Namespace, results: Dict[str, List[Table]], holds: bool) -> None:
    if not options.json:
        return
    topics = {name: [table.as_json() for table in tables] for name, tables in results.items()}
    text = json.dumps({"holds": holds, "quick": options.quick, "topics": topics}, indent=1) + "\n"
    if options.json == "-":
        sys.stdout.write(text)
    else:
        Path(options.json).write_text(text)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
