# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Files that evaluate_places writes: options, checks and content."""

import tempfile
from argparse import Namespace
from pathlib import Path
from typing import Any, Dict, List, Mapping, NamedTuple, Sequence

from sextant.base.html_report import Table
from sextant.base.table_file import FORMATS, check_table_path, write_table
from sextant.commands.command_line import check_output
from sextant.place_reports.place_comparison import ComparedMethod, comparison_table
from sextant.place_reports.place_evaluation_page import write_evaluation_page
from sextant.place_reports.place_evaluation_plots import plot_names, write_plots
from sextant.place_reports.place_evaluation_report import write_json
from sextant.place_reports.place_picture_table import write_picture_table
from sextant.places.place_evaluation import PlaceEvaluation


class Findings(NamedTuple):
    """Results of the command."""

    evaluations: Mapping[str, PlaceEvaluation]  # of the queries, by the name of the mode or method
    unit: str  # of distances
    compared: Sequence[ComparedMethod] = ()  # empty: no comparison
    distances: Sequence[float] = ()  # of correct hypotheses in the comparison

    @property
    def exact(self) -> Dict[str, PlaceEvaluation]:
        """The evaluations without clusters, by name."""
        merged = {each.name for each in self.compared if each.clusters}
        return {name: each for name, each in self.evaluations.items() if name not in merged}

    def table(self) -> Table:
        """The comparison."""
        return comparison_table(self.compared, self.distances, self.unit)


def add_output_options(group: Any) -> None:
    """Adds the options to an argument group."""
    text = "table with a row per query: matches, distances, errors, probability, time"
    group.add_argument("--per-picture", type=Path, metavar="CSV", help=text)
    text = f"comparison as a table: {', '.join(FORMATS)}"
    group.add_argument("--table", type=Path, nargs="+", default=[], metavar="FILE", help=text)
    text = f"writes {', '.join(plot_names([''], False))}; for a comparison also comparison.png"
    group.add_argument("--plots", type=Path, metavar="FOLDER", help=text)
    group.add_argument("--page", type=Path, metavar="HTML", help="tables and plots in one file")
    text = "all figures and the result of each query; not of a comparison"
    group.add_argument("--json", type=Path, metavar="FILE", help=text)
    group.add_argument("--force", action="store_true", help="overwrite existing files")


def check_outputs(options: Namespace, methods: Sequence[str]) -> None:
    """Checks all paths before anything is computed.

    :param methods: names of the compared methods; empty: no comparison
    :raises OSError, ValueError: a file cannot be written, exists, or is not of this evaluation
    """
    if options.table and not methods:
        raise ValueError("--table needs --compare or --clusters")
    if options.json and methods:
        raise ValueError("--json is of one method; use --table and --per-picture for a comparison")
    if options.plots:
        options.plots.mkdir(parents=True, exist_ok=True)
    for path in options.table:
        check_table_path(path)
    for path in _files(options, methods):
        check_output(path, options.force)


def _files(options: Namespace, methods: Sequence[str]) -> List[Path]:
    files = [options.per_picture, *options.table, options.json, options.page]
    if options.plots:
        files += [options.plots / name for name in plot_names(methods or [""], bool(methods))]
    return [path for path in files if path]


def write_outputs(options: Namespace, findings: Findings) -> List[Path]:
    """Writes the files.

    :returns: the files
    :raises OSError: a file cannot be written
    """
    if options.per_picture:
        write_picture_table(options.per_picture, findings.evaluations, findings.unit)
    for path in options.table:
        write_table(path, findings.table())
    if options.json:
        ((mode, evaluation),) = findings.evaluations.items()
        write_json(options.json, mode, findings.unit, evaluation)
    if options.plots or options.page:
        with tempfile.TemporaryDirectory() as temporary:
            folder = options.plots or Path(temporary)
            plots = write_plots(folder, findings.exact, findings.compared, findings.distances, findings.unit)
            if options.page:
                _write_page(options, findings, plots)
    return _files(options, [each.name for each in findings.compared if not each.clusters])


def _write_page(options: Namespace, findings: Findings, plots: Sequence[Path]) -> None:
    queries = options.queries or options.truth or "each photo of the map, with the others"
    write_evaluation_page(
        options.page,
        f"Map: {options.map}. Queries: {queries}.",
        findings.evaluations,
        findings.unit,
        plots,
        list(findings.exact),
        findings.table() if findings.compared else None,
    )
