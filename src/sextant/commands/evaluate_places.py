# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Evaluates a place map with images whose places are known.

evaluate_places park.txt --queries autumn.txt                  photos of another map on the same overview
evaluate_places park.txt --truth truth.csv --folder walk/      images of a table: query,right_refs
evaluate_places park.txt --leave-one-out                       every photo of the map against the others
"""

import argparse
import functools
import json
import math
import sys
from pathlib import Path
from typing import Any, Dict, List, Optional, Sequence

import numpy as np

import sextant
from sextant.base.atomic_file import atomic_file
from sextant.commands.command_line import Answer, CommandParser, check_output, run
from sextant.place_maps.place_map_file import read_place_map
from sextant.places.global_descriptor import BACKEND_NAMES, CHANNELS, GlobalDescriptorParams
from sextant.places.index_params import PROFILES, VOTE_MATCHER, IndexParams
from sextant.places.place_estimate import scale_of
from sextant.places.place_evaluation import (
    INDEPENDENT_MODES,
    RANKS,
    PlaceEvaluation,
    QueryResult,
    evaluate,
    evaluate_leave_one_out,
)
from sextant.places.place_index_update import PlaceIndexer
from sextant.places.place_localizer import VOTES, PlaceLocalizationParams
from sextant.places.place_modes import MODES
from sextant.places.place_plots import plot_precision_recall, plot_reliability
from sextant.places.place_queries import default_tolerance, queries_of_map, queries_of_table
from sextant.places.place_recognition import RecognitionParams

PLOTS = ("precision_recall.png", "reliability.png")


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
    add(
        "--tolerance", type=float, metavar="METRES",
        help="distance of correct places; pixels if the map has no scale (default: two spacings of places)",
    )  # fmt: skip
    _add_method_options(parser)
    _add_network_options(parser)
    add("--plots", type=Path, metavar="FOLDER", help="writes " + " and ".join(PLOTS))
    add("--json", type=Path, metavar="FILE", help="writes all figures and the result of each query")
    add("--force", action="store_true", help="overwrite existing files")
    return parser


def _add_method_options(parser: argparse.ArgumentParser) -> None:
    add, default = parser.add_argument, "default: %(default)s"
    known, names = sextant.FeatureParams(), sextant.feature_names()
    add("--mode", choices=(*MODES, VOTES), help="default: filter; with --leave-one-out: single")
    add("--profile", choices=PROFILES, default="tuned", help="plain: OpenCV's defaults")
    add("--detector", choices=names, default=known.detector, help=default)
    add("--extractor", choices=names, default=known.extractor, help=default)
    add("--matcher", choices=sextant.matcher_names(), default=VOTE_MATCHER, help=f"of mode votes ({default})")
    text = f"ORB: points compared per descriptor element ({default})"
    add("--orb-wta-k", type=int, default=known.orb_wta_k, metavar="N", help=text)
    add("--jobs", type=int, default=1, metavar="N", help="processes for the description of the photos")
    add("--scheduler", default="", metavar="tcp://HOST:PORT", help="of a Dask cluster for it")


def _add_network_options(parser: argparse.ArgumentParser) -> None:
    add, known = parser.add_argument, GlobalDescriptorParams()
    add("--network", default="", metavar="ONNX", help="file of a global descriptor")
    add("--network-backend", choices=BACKEND_NAMES, default=known.backend)
    text = "input size of the network (default: that of the model)"
    for side in ("width", "height"):
        add(f"--network-{side}", type=int, default=getattr(known, side), metavar="PIXELS", help=text)
    add("--network-channels", choices=CHANNELS, default=known.channels, help="default: %(default)s")
    for name, what in (("mean", "subtracted from pixels of 0 to 1"), ("std", "divides them")):
        text = f"{what}; one per channel (default: ImageNet's)"
        add(f"--network-{name}", type=float, nargs="+", default=getattr(known, name), metavar="X", help=text)
    text = "of the network relative to the keypoints (default: %(default)s)"
    weight = RecognitionParams.network_weight
    add("--network-weight", type=float, default=weight, metavar="WEIGHT", help=text)


def _evaluate(options: argparse.Namespace) -> Answer:
    _check(options)
    plots = [options.plots / name for name in PLOTS] if options.plots else []
    files = [*([options.json] if options.json else []), *plots]
    for path in files:
        check_output(path, options.force)
    mode = options.mode or ("single" if options.leave_one_out else PlaceLocalizationParams.mode)
    indexer = _indexer(options, mode)
    recognition = RecognitionParams(network_weight=options.network_weight)
    evaluation = _evaluated(options, indexer, PlaceLocalizationParams(mode=mode, recognition=recognition))
    unit = "m" if scale_of(indexer.place_map) else "px"
    if options.json:
        _write_json(options.json, mode, unit, evaluation)
    if plots:
        plot_precision_recall(plots[0], {mode: evaluation.curve})
        plot_reliability(plots[1], *evaluation.predictions)
    lines = report_lines(evaluation, unit)
    return Answer([f"{options.map}, mode {mode}: {lines[0]}", *lines[1:], *map(str, files)])


def _check(options: argparse.Namespace) -> None:
    if options.folder and not options.truth:
        raise ValueError("--folder needs --truth")
    if options.tolerance is not None:
        if options.truth:
            raise ValueError("--tolerance cannot be used with --truth, which names the correct photos")
        if not 0 <= options.tolerance < math.inf:
            raise ValueError(f"--tolerance is {options.tolerance:g}, it must be at least 0")
    if options.plots:
        options.plots.mkdir(parents=True, exist_ok=True)


def _indexer(options: argparse.Namespace, mode: str) -> PlaceIndexer:
    network = GlobalDescriptorParams(
        options.network, options.network_backend, options.network_width, options.network_height,
        options.network_channels, options.network_mean, options.network_std,
    )  # fmt: skip
    params = IndexParams.of_profile(
        options.profile,
        options.detector,
        options.extractor,
        options.matcher if mode == VOTES else None,
        network,
        options.orb_wta_k,
    )
    return PlaceIndexer(
        options.map, read_place_map(options.map), params,
        options.jobs, options.scheduler, functools.partial(print, file=sys.stderr),
    )  # fmt: skip


def _evaluated(
    options: argparse.Namespace, indexer: PlaceIndexer, params: PlaceLocalizationParams
) -> PlaceEvaluation:
    place_map, tolerance = indexer.place_map, options.tolerance
    if tolerance is None:
        tolerance = default_tolerance(place_map)
    if options.leave_one_out:
        return evaluate_leave_one_out(indexer, params, tolerance)
    if options.truth:
        queries = queries_of_table(place_map, options.truth, options.folder or options.truth.parent)
    else:
        queries = queries_of_map(place_map, read_place_map(options.queries), tolerance)
    return evaluate(indexer, params, queries)


def report_lines(evaluation: PlaceEvaluation, unit: str) -> List[str]:
    """Human-readable report of an evaluation.

    :param unit: of position errors
    """
    figures = evaluation.figures()
    lines = [
        "{queries:.0f} queries, {unmapped_queries:.0f} of them not in the map",
        "recall " + ", ".join(f"@{n} {{recall@{n}:.3f}}" for n in RANKS)
        + "; area under precision-recall {area:.3f}",
        "calibration error {calibration_error:.3f}; 95 % quantile if perfectly calibrated "
        "{perfect_calibration_error:.3f}",
        "unknown place: reported for {unknown_rate_in_map:.1%} of the queries in the map, and for "
        "{unknown_rate_off_map:.1%} of the others",
        f"position error: median {{position_error:.2f}} {unit}, 90 % below {{position_error_90:.2f}} "
        f"{unit}; {{ellipse_coverage:.1%}} in the 95 % ellipse; {{estimates:.0f}} estimates",
        "time per query: {query_ms:.1f} ms (median), 95 % below {query_ms_95:.1f} ms",
        "index: {index_mb:.2f} MB, " + ("loaded" if evaluation.cost.is_loaded else "built")
        + " in {index_seconds:.2f} s; the process grew by {resident_mb:.0f} MB",
    ]  # fmt: skip
    if not figures["estimates"]:
        del lines[4]
    return [line.format(**figures).replace("nan%", "-").replace("nan", "-") for line in lines]


def _write_json(path: Path, mode: str, unit: str, evaluation: PlaceEvaluation) -> None:
    figures = {"mode": mode, "unit": unit, **evaluation.figures()}
    queries = [_as_json(result) for result in evaluation.results]
    with atomic_file(path) as file:
        json.dump({"figures": _without_nan(figures), "queries": queries}, file, indent=1)
        file.write("\n")


def _as_json(result: QueryResult) -> Dict[str, Any]:
    query, found = result.query, result.found
    return {
        "image": str(query.path),
        "is_in_map": bool(query.true_places),
        "status": found.status.name,
        "hypotheses": [[each.photo.image, each.probability] for each in found.hypotheses],
        "rank": result.rank if np.isfinite(result.rank) else None,
        "unknown_probability": found.unknown_probability,
    }


def _without_nan(figures: Dict[str, Any]) -> Dict[str, Any]:
    """JSON has no nan."""
    return {name: None if value != value else value for name, value in figures.items()}
