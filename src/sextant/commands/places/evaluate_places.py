# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Evaluates a place map with images whose places are known, and compares methods of recognition.

evaluate_places park.txt --queries autumn.txt                  photos of another map on the same overview
evaluate_places park.txt --truth truth.csv --folder walk/      images of a table: query,right_refs
evaluate_places park.txt --leave-one-out                       every photo of the map against the others
evaluate_places park.txt --queries autumn.txt --compare surf,sift,orb,akaze,default --page report.html
"""

import argparse
import functools
import math
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any, Optional, Sequence

from sextant.base.strict_params import parse_params
from sextant.base.table_file import text_table
from sextant.commands.command_line import Answer, CommandParser, run
from sextant.commands.params_options import add_params_options, given_params
from sextant.commands.places.place_evaluation_outputs import (
    Findings,
    add_output_options,
    check_outputs,
    write_outputs,
)
from sextant.place_maps.place_clusters import clustered
from sextant.place_maps.place_map import PlaceMap
from sextant.place_maps.place_map_file import read_place_map
from sextant.place_reports.place_comparison import METHODS, Evaluate, compare, compared_methods, method_params
from sextant.place_reports.place_evaluation_report import report_lines
from sextant.places.index_params import IndexParams
from sextant.places.place_estimate import scale_of
from sextant.places.place_evaluation import INDEPENDENT_MODES, evaluate, evaluate_leave_one_out
from sextant.places.place_index_update import PlaceIndexer
from sextant.places.place_method_params import PlaceMethodParams
from sextant.places.place_queries import (
    default_distances,
    default_tolerance,
    queries_of_map,
    queries_of_table,
)


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """:returns: exit code: 0, or 2 if the map cannot be evaluated."""
    return run(_parser(), arguments, _evaluate)


def _parser() -> CommandParser:
    parser = CommandParser(prog="evaluate_places", description=__doc__)
    add = parser.add_argument
    add("map", type=Path, metavar="MAP")
    truth = parser.add_mutually_exclusive_group(required=True)
    truth.add_argument("--queries", type=Path, metavar="OTHER_MAP", help="map on the same overview")
    text = "table with right_refs: correct photos, separated by blanks; none: not in the map"
    truth.add_argument("--truth", type=Path, metavar="CSV", help=text)
    text = f"modes {' and '.join(INDEPENDENT_MODES)}"
    truth.add_argument("--leave-one-out", action="store_true", help=text)
    add("--folder", type=Path, help="folder of the images of --truth (default: that of the CSV)")
    text = "distance of correct places; pixels if the map has no scale (default: two spacings of places)"
    add("--tolerance", type=_length, metavar="METRES", help=text)
    add("--jobs", type=int, default=1, metavar="N", help="processes for the description of the photos")
    add("--scheduler", default="", metavar="tcp://HOST:PORT", help="of a Dask cluster for it")
    _add_comparison_options(parser.add_argument_group("comparison"))
    add_output_options(parser.add_argument_group("outputs"))
    text = "Those of the node place_localizer; with --leave-one-out the default mode is single."
    add_params_options(parser.add_argument_group("parameters", text), PlaceMethodParams)
    return parser


def _add_comparison_options(group: Any) -> None:
    text = f"methods, separated by commas: {', '.join(METHODS)}"
    group.add_argument("--compare", metavar="METHODS", help=text)
    text = "also localize in the map with its places merged into N clusters; without --compare: default"
    group.add_argument("--clusters", type=int, metavar="N", help=text)
    group.add_argument(
        "--distances", type=_length, nargs="+", metavar="METRES",
        help="distances within which a hypothesis is counted; pixels if the map has no scale (default: 1, 2 "
        "and 4 spacings of places; with --truth 0, 1 and 2)",
    )  # fmt: skip


def _length(text: str) -> float:
    value = float(text)
    if not 0 <= value < math.inf:
        raise argparse.ArgumentTypeError(f"is {text}, it must be at least 0")
    return value


def _evaluate(options: argparse.Namespace) -> Answer:
    methods = compared_methods(options.compare, options.clusters)
    _check(options, methods)
    place_map = read_place_map(options.map)
    queries = _queries(options, place_map)
    indexer = PlaceIndexer(
        options.map, place_map, IndexParams(),
        options.jobs, options.scheduler, functools.partial(print, file=sys.stderr),
    )  # fmt: skip
    if methods:
        findings = _compared(options, methods, indexer, queries)
        lines = [f"{options.map}:", *text_table(findings.table()).splitlines()]
    else:
        findings = _evaluated(options, indexer, queries)
        ((mode, evaluation),) = findings.evaluations.items()
        first, *others = report_lines(evaluation, findings.unit)
        lines = [f"{options.map}, mode {mode}: {first}", *others]
    return Answer([*lines, *map(str, write_outputs(options, findings))])


def _check(options: argparse.Namespace, methods: Sequence[str]) -> None:
    if options.folder and not options.truth:
        raise ValueError("--folder needs --truth")
    if options.tolerance is not None and options.truth:
        raise ValueError("--tolerance cannot be used with --truth, which names the correct photos")
    if options.distances and not methods:
        raise ValueError("--distances needs --compare or --clusters")
    check_outputs(options, methods)


def _queries(options: argparse.Namespace, place_map: PlaceMap) -> Evaluate:
    """A function that evaluates the queries with an indexer and parameters."""
    tolerance = options.tolerance
    if tolerance is None:
        tolerance = default_tolerance(place_map)
    if options.leave_one_out:
        return functools.partial(evaluate_leave_one_out, tolerance=tolerance)
    if options.truth:
        queries = queries_of_table(place_map, options.truth, options.folder or options.truth.parent)
    else:
        queries = queries_of_map(place_map, read_place_map(options.queries), tolerance)
    if not queries:
        raise ValueError(f"{options.truth or options.queries}: there is no query")
    return functools.partial(evaluate, queries=queries)


def _unit(place_map: PlaceMap) -> str:
    return "m" if scale_of(place_map) else "px"


def _evaluated(options: argparse.Namespace, indexer: PlaceIndexer, queries: Evaluate) -> Findings:
    given = given_params(options, PlaceMethodParams)
    if options.leave_one_out:
        given = {"mode": "single", **given}
    params = parse_params(PlaceMethodParams, given, "", "")
    own = replace(indexer, params=params.index_params())
    evaluation = queries(own, params.localization)
    return Findings({params.localization.mode: evaluation}, _unit(indexer.place_map))


def _compared(
    options: argparse.Namespace, names: Sequence[str], indexer: PlaceIndexer, queries: Evaluate
) -> Findings:
    given, place_map = given_params(options, PlaceMethodParams), indexer.place_map
    methods = {name: method_params(name, given) for name in names}
    clusters = None
    if options.clusters is not None:
        clusters = clustered(place_map, options.clusters, scale_of(place_map) or (1.0, 1.0))
    compared = compare(indexer, methods, queries, clusters)
    distances = sorted(options.distances or default_distances(place_map, bool(options.truth)))
    evaluations = {each.name: each.new_photos for each in compared}
    return Findings(evaluations, _unit(place_map), compared, distances)
