# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Table of an evaluation with one row per query."""

import csv
from pathlib import Path
from typing import Dict, Mapping, Union

import numpy as np

from sextant.base.atomic_file import atomic_file
from sextant.place_reports.place_predictors import QUANTITIES
from sextant.places.place_evaluation import PlaceEvaluation, QueryResult

Cell = Union[str, int, float]


def write_picture_table(path: Path, evaluations: Mapping[str, PlaceEvaluation], unit: str) -> None:
    """Writes a CSV file with the columns of picture_row(); an unknown value is empty.

    :param evaluations: by the name of the method, at least one with a query
    :param unit: of the errors, m or px
    :raises OSError: the file cannot be written
    """
    rows = [
        {"method": name, **picture_row(result, evaluation.pixels, unit)}
        for name, evaluation in evaluations.items()
        for result in evaluation.results
    ]
    with atomic_file(path) as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows({name: _text(cell) for name, cell in row.items()} for row in rows)


def picture_row(result: QueryResult, pixels: np.ndarray, unit: str) -> Dict[str, Cell]:
    """The localization of one query by column.

    image: file. in_map: 1 if it has a correct place. status: see Status. answer: best photo. right: 1 if it
    shows a correct place. rank: of the first correct hypothesis. Then QUANTITIES. best_error, second_error,
    worst_error: distances of the best, second and farthest hypothesis from the truth. ms: processing time.

    :param pixels: metres per pixel, see QueryResult.errors()
    :param unit: of the errors, ends the names of their columns
    """
    found, errors = result.found, result.errors(pixels)
    best, second = (errors[n] if len(errors) > n else np.nan for n in range(2))
    return {
        "image": str(result.query.path),
        "in_map": int(bool(result.query.true_places)),
        "status": found.status.name,
        "answer": found.hypotheses[0].photo.image if found.hypotheses else "",
        "right": int(result.rank == 1),
        "rank": int(result.rank) if np.isfinite(result.rank) else "",
        **{name: quantity(found) for name, quantity in QUANTITIES.items()},
        f"best_error_{unit}": best,
        f"second_error_{unit}": second,
        f"worst_error_{unit}": errors.max() if len(errors) else np.nan,
        "ms": 1e3 * result.seconds,
    }


def _text(cell: Cell) -> str:
    if isinstance(cell, (str, int)):
        return str(cell)
    return "" if np.isnan(cell) else f"{cell:.6g}"
