# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Report of an evaluation of places as text and as JSON."""

import json
from pathlib import Path
from typing import Any, Dict, List

import numpy as np

from sextant.base.atomic_file import atomic_file
from sextant.places.place_evaluation import RANKS, PlaceEvaluation, QueryResult


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


def write_json(path: Path, mode: str, unit: str, evaluation: PlaceEvaluation) -> None:
    """Writes all figures, and the result of each query.

    :param mode: of the localization
    :param unit: of position errors
    :raises OSError: the file cannot be written
    """
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
