# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tells how good a map of places is, by pictures whose places are known.

evaluate_places park.txt --queries autumn.txt                  the photos of another map on the same overview
evaluate_places park.txt --truth truth.csv --folder walk/      a table: query,right_refs
evaluate_places park.txt --leave-one-out                       every photo of the map, taken out of it
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
from sextant.places.place_estimate import scale_of
from sextant.places.place_evaluation import (
    ONE_BY_ONE,
    RANKS,
    Outcome,
    PlaceEvaluation,
    evaluate,
    evaluate_left_out,
)
from sextant.places.place_index import PROFILES, IndexParams
from sextant.places.place_library import Library
from sextant.places.place_localization import VOTES, PlaceLocalizationParams
from sextant.places.place_modes import MODES
from sextant.places.place_plots import plot_precision_recall, plot_reliability
from sextant.places.place_queries import default_tolerance, queries_of_map, queries_of_table
from sextant.places.place_recognition import RecognitionParams

PLOTS = ("precision_recall.png", "reliability.png")


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """:returns: exit code: 0, or 2 when nothing was measured."""
    return run(_parser(), arguments, _evaluate)


def _parser() -> CommandParser:
    parser = CommandParser(prog="evaluate_places", description=__doc__)
    parser.add_argument("map", type=Path, metavar="MAP")
    truth = parser.add_mutually_exclusive_group(required=True)
    truth.add_argument("--queries", type=Path, metavar="OTHER_MAP", help="on the same overview")
    truth.add_argument(
        "--truth", type=Path, metavar="CSV", help="right_refs: photos, with blanks; none: nowhere"
    )
    truth.add_argument("--leave-one-out", action="store_true", help=f"modes {' and '.join(ONE_BY_ONE)}")
    parser.add_argument("--folder", type=Path, help="of the queries of --truth (default: that of the CSV)")
    parser.add_argument(
        "--tolerance", type=float, metavar="METRES",
        help="to a right place; pixels where the map has no scale (default: two spacings of places)",
    )  # fmt: skip
    _add_method_options(parser)
    _add_network_options(parser)
    parser.add_argument("--plots", type=Path, metavar="FOLDER", help="writes " + " and ".join(PLOTS))
    parser.add_argument(
        "--json", type=Path, metavar="FILE", help="writes all figures, and what each query got"
    )
    parser.add_argument("--force", action="store_true", help="overwrite files that are there")
    return parser


def _add_method_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--mode", choices=(*MODES, VOTES), help="default: filter; with --leave-one-out: single"
    )
    parser.add_argument(
        "--profile", choices=PROFILES, default="tuned", help="plain: what follows as OpenCV has it"
    )
    known, names = sextant.FeatureParams(), sextant.feature_names()
    parser.add_argument(
        "--detector", choices=names, default=known.detector, help="default: %(default)s; so is the extractor"
    )
    parser.add_argument("--extractor", choices=names, default=known.extractor)
    parser.add_argument(
        "--matcher",
        choices=sextant.matcher_names(),
        default=IndexParams.matcher,
        help="default: %(default)s",
    )
    parser.add_argument(
        "--orb-wta-k", type=int, default=known.orb_wta_k, metavar="N",
        help="ORB: points that decide a bit (default: %(default)s)",
    )  # fmt: skip
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="photos described at a time")
    parser.add_argument(
        "--scheduler", default="", metavar="tcp://HOST:PORT", help="of a Dask cluster that describes them"
    )


def _add_network_options(parser: argparse.ArgumentParser) -> None:
    known = GlobalDescriptorParams()
    parser.add_argument("--network", default="", metavar="ONNX", help="file of a global descriptor")
    parser.add_argument("--network-backend", choices=BACKEND_NAMES, default=known.backend)
    for side in ("width", "height"):
        parser.add_argument(
            f"--network-{side}", type=int, default=getattr(known, side), metavar="PIXELS",
            help="of what pictures are resized to (default: as the model says)",
        )  # fmt: skip
    parser.add_argument(
        "--network-channels", choices=CHANNELS, default=known.channels, help="default: %(default)s"
    )
    for name, what in (("mean", "is taken from pixels of 0 to 1"), ("std", "they are divided by")):
        parser.add_argument(
            f"--network-{name}", type=float, nargs="+", default=getattr(known, name), metavar="X",
            help=f"what {what}; one a channel (default: ImageNet's)",
        )  # fmt: skip
    parser.add_argument(
        "--network-weight", type=float, default=RecognitionParams.network_weight, metavar="WEIGHT",
        help="of what it says, against the keypoints (default: %(default)s)",
    )  # fmt: skip


def _evaluate(options: argparse.Namespace) -> Answer:
    _check(options)
    plots = [options.plots / name for name in PLOTS] if options.plots else []
    files = [*([options.json] if options.json else []), *plots]
    for path in files:
        check_output(path, options.force)
    mode = options.mode or ("single" if options.leave_one_out else PlaceLocalizationParams.mode)
    library = _library(options)
    recognition = RecognitionParams(network_weight=options.network_weight)
    evaluation = _evaluated(options, library, PlaceLocalizationParams(mode=mode, recognition=recognition))
    unit = "m" if scale_of(library.place_map) else "px"
    if options.json:
        _write_json(options.json, mode, unit, evaluation)
    if plots:
        plot_precision_recall(plots[0], {mode: evaluation.curve})
        plot_reliability(plots[1], *evaluation.said)
    lines = told(evaluation, unit)
    return Answer([f"{options.map}, mode {mode}: {lines[0]}", *lines[1:], *map(str, files)])


def _check(options: argparse.Namespace) -> None:
    if options.folder and not options.truth:
        raise ValueError("--folder is of the queries of --truth")
    if options.tolerance is not None:
        if options.truth:
            raise ValueError("--tolerance means nothing with --truth, which names the right photos")
        if not 0 <= options.tolerance < math.inf:
            raise ValueError(f"--tolerance is {options.tolerance:g}, allowed is from 0 on")
    if options.plots:
        options.plots.mkdir(parents=True, exist_ok=True)


def _library(options: argparse.Namespace) -> Library:
    network = GlobalDescriptorParams(
        options.network, options.network_backend, options.network_width, options.network_height,
        options.network_channels, options.network_mean, options.network_std,
    )  # fmt: skip
    params = IndexParams.of_profile(
        options.profile, options.detector, options.extractor, options.matcher, network, options.orb_wta_k
    )
    return Library(
        options.map, read_place_map(options.map), params,
        options.jobs, options.scheduler, functools.partial(print, file=sys.stderr),
    )  # fmt: skip


def _evaluated(
    options: argparse.Namespace, library: Library, params: PlaceLocalizationParams
) -> PlaceEvaluation:
    place_map, tolerance = library.place_map, options.tolerance
    if tolerance is None:
        tolerance = default_tolerance(place_map)
    if options.leave_one_out:
        return evaluate_left_out(library, params, tolerance)
    if options.truth:
        queries = queries_of_table(place_map, options.truth, options.folder or options.truth.parent)
    else:
        queries = queries_of_map(place_map, read_place_map(options.queries), tolerance)
    return evaluate(library, params, queries)


def told(evaluation: PlaceEvaluation, unit: str) -> List[str]:
    """Lines for people.

    :param unit: of position errors
    """
    figures = evaluation.figures()
    lines = [
        "{queries:.0f} queries, {nowhere:.0f} of them nowhere in the map",
        "recall " + ", ".join(f"@{n} {{recall@{n}:.3f}}" for n in RANKS)
        + "; area under precision-recall {area:.3f}",
        "calibration error {calibration_error:.3f}; of a perfect forecaster, in 95 % of cases, below "
        "{perfect_calibration_error:.3f}",
        '"nowhere" is said of {said_nowhere_wrongly:.1%} of the queries in the map, and of '
        "{said_nowhere_rightly:.1%} of those that are not",
        f"position: off by {{position_error:.2f}} {unit} (median), 90 % below {{position_error_90:.2f}} "
        f"{unit}; {{in_ellipse:.1%}} in the 95 % ellipse; {{estimates:.0f}} estimates",
        "time a query: {query_ms:.1f} ms (median), 95 % below {query_ms_95:.1f} ms",
        "index: {index_mb:.2f} MB, " + ("loaded" if evaluation.cost.is_loaded else "made")
        + " in {index_seconds:.2f} s; the process grew by {resident_mb:.0f} MB",
    ]  # fmt: skip
    if not figures["estimates"]:
        del lines[4]
    return [line.format(**figures).replace("nan%", "-").replace("nan", "-") for line in lines]


def _write_json(path: Path, mode: str, unit: str, evaluation: PlaceEvaluation) -> None:
    figures = {"mode": mode, "unit": unit, **evaluation.figures()}
    queries = [_as_json(outcome) for outcome in evaluation.outcomes]
    with atomic_file(path) as file:
        json.dump({"figures": _without_nan(figures), "queries": queries}, file, indent=1)
        file.write("\n")


def _as_json(outcome: Outcome) -> Dict[str, Any]:
    query, found = outcome.query, outcome.found
    return {
        "image": str(query.path),
        "is_in_map": bool(query.right),
        "status": found.status.name,
        "answers": [[answer.photo.image, answer.probability] for answer in found.answers],
        "first_right": outcome.rank if np.isfinite(outcome.rank) else None,
        "nowhere": found.nowhere,
    }


def _without_nan(figures: Dict[str, Any]) -> Dict[str, Any]:
    """JSON has no nan."""
    return {name: None if value != value else value for name, value in figures.items()}
