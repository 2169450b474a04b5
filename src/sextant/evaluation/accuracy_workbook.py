# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes accuracy statistics as a spreadsheet.

Its statistics are formulas over the raw poses, so that rows of outliers can be deleted.
"""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import List, Optional, Sequence, Union

import numpy as np
from openpyxl import Workbook
from openpyxl.cell.cell import ILLEGAL_CHARACTERS_RE
from openpyxl.styles import Alignment, Border, Font, PatternFill, Side
from openpyxl.utils import get_column_letter
from openpyxl.worksheet.worksheet import Worksheet

from sextant.base.atomic_file import atomic_file
from sextant.evaluation.error_statistics import (
    QUANTITIES,
    QUANTITY_UNITS,
    ErrorStatistics,
    error_statistics,
)
from sextant.evaluation.pose_series import (
    AXES,
    POINT,
    UNIT_OF,
    UNITS,
    PoseSeries,
    SeriesStatistics,
    published_sigmas,
)
from sextant.evaluation.trajectory import seconds_text

FIRST_ROW = 2  # of the data, below the headings
FIRST_AXIS = 4  # column of x in a sheet of raw poses
TEXT, DECIMAL, SCIENTIFIC, INTEGER, PERCENT = "General", "0.00000", "0.00E+00", "0", "0.0 %"  # of cells
NOT_IN_A_NAME = re.compile(r"[\[\]:*?/\\]")  # characters that the name of a sheet must not have
MAX_NAME = 31  # characters of the name of a sheet
UNDEFINED = "undefined"  # for instance the standard deviation of a single pose
UNKNOWN = "unknown"  # the axis has no true value

FONT = "Calibri"
HEADING = dict(
    font=Font(FONT, bold=True, color="FFFFFF"),
    fill=PatternFill("solid", fgColor="0072B2"),
    alignment=Alignment(horizontal="center", vertical="center", wrap_text=True),
)
LEFT, RIGHT = Alignment(horizontal="left", indent=1), Alignment(horizontal="right")
TOP_LINE = Border(top=Side(style="thin", color="808080"))

ERRORS_NOTES = (
    "Errors of all poses: mean of estimate - truth, standard deviation (N - 1), 95th percentile and maximum"
    " of the absolute errors. position: distance from the true position. These are values, not formulas.",
)
SUMMARY_NOTES = (
    "All values but truth and published are formulas over the raw poses: delete the row of an outlier there,"
    " and they are updated. std is divided by N - 1, RMSE by N; bias = mean - truth.",
    "published: root of the mean published variance. It is close to std if the covariances are consistent.",
    "roll, pitch, yaw: about the fixed axes of the reference, R = Rz(yaw) Ry(pitch) Rx(roll). Whole"
    " turns are added to angles that cross +-pi; the heading of such a column ends in 'unwrapped'.",
)
COVARIANCE_NOTES = (
    "Covariances of the poses about their mean, divided by N - 1."
    " The unit is that of the row times that of the column.",
)
BAGS_NOTES = ("stale: left out, stamped before the bag began. invalid: left out, NaN or not a rotation.",)


class _Formula(str):
    """A formula. Other strings are text, even the name of a bag that begins with =."""


@dataclass(frozen=True)
class _Column:
    heading: str
    width: float
    format: str = TEXT


def write_workbook(
    path: Union[str, Path], series: Sequence[PoseSeries], statistics: Sequence[SeriesStatistics]
) -> None:
    """Writes summary, covariances, bags and raw poses of every distance atomically.

    If there are several methods, each has sheets of its own.

    :param path: must end in .xlsx
    :param series: the result of by_distance()
    :param statistics: those of each series, in the same order
    :raises OSError: the file cannot be written
    :raises ValueError: another ending, no series, statistics of other series, a duplicate distance, or two
        methods with the same end of the name
    """
    _check(path, series, statistics)
    book = Workbook()
    book.remove(book.active)
    book.properties.creator = "sextant"
    _write_errors(book.create_sheet("errors"), error_statistics(statistics))
    for method in dict.fromkeys(each.method for each in statistics):
        pairs = [pair for pair in zip(series, statistics) if pair[1].method == method]
        _write_method(book, method, *map(list, zip(*pairs)))
    with atomic_file(path, "wb") as file:
        book.save(file)


def _check(
    path: Union[str, Path], series: Sequence[PoseSeries], statistics: Sequence[SeriesStatistics]
) -> None:
    if not str(path).lower().endswith(".xlsx"):
        raise ValueError(f"{path}: the file name of a workbook must end in .xlsx")
    if not series or [each.distance for each in series] != [each.distance for each in statistics]:
        raise ValueError("a workbook needs series, and the statistics of each of them in the same order")
    names = [_sheet_name(each.label).lower() for each in statistics]
    if len(set(names)) < len(names):
        raise ValueError(
            "two series have the same distance: join them with by_distance(); or two topics have names with"
            " the same end: evaluate them one by one"
        )


def _write_method(
    book: Workbook, method: str, series: Sequence[PoseSeries], statistics: Sequence[SeriesStatistics]
) -> None:
    def sheet(name: str) -> Worksheet:
        return book.create_sheet(_sheet_name(f"{method} {name}".strip()))

    _write_summary(sheet("summary"), statistics)
    _write_covariances(sheet("covariance"), statistics)
    _write_bags(sheet("bags"), series, statistics)
    for one_series, its_statistics in zip(series, statistics):
        _write_poses(sheet(its_statistics.place), one_series, its_statistics)


def _sheet_name(label: str) -> str:
    return NOT_IN_A_NAME.sub(".", label)[-MAX_NAME:]


def _write_errors(sheet: Worksheet, errors: Sequence[ErrorStatistics]) -> None:
    columns = [_Column("method", 16), _Column("place", 12), _Column("poses", 8, INTEGER)]
    columns += [_Column("images", 8, INTEGER), _Column("with a pose", 9, PERCENT)]
    columns += [_Column("error of", 10), _Column("unit", 7)]
    columns += [_Column(name, 13, DECIMAL) for name in ("mean", "std", "95 %", "worst")]
    _set_up_sheet(sheet, columns, "C2")
    row = FIRST_ROW
    for each in errors:
        images = UNKNOWN if each.images is None else each.images
        for i, quantity in enumerate(QUANTITIES):
            numbers = [_number(values[i], UNKNOWN) for values in (each.mean, each.std, each.p95, each.worst)]
            values = [each.method, each.place, each.poses, images, _number(each.share, UNKNOWN), quantity]
            _write_row(sheet, row, [*values, QUANTITY_UNITS[i], *numbers], columns, line_above=i == 0)
            row += 1
    sheet.auto_filter.ref = f"A1:{get_column_letter(len(columns))}{row - 1}"
    _write_notes(sheet, ERRORS_NOTES, row + 1, len(columns))


def _write_summary(sheet: Worksheet, statistics: Sequence[SeriesStatistics]) -> None:
    columns = [_distance_column(statistics), _Column("axis", 8), _Column("unit", 7), _Column("N", 8, INTEGER)]
    columns += [_Column(name, 13, DECIMAL) for name in ("truth", "mean", "std", "bias", "RMSE", "published")]
    _set_up_sheet(sheet, columns, "C2")
    row = FIRST_ROW
    for each in statistics:
        for axis in range(6):
            values = [each.distance, AXES[axis], UNITS[axis], *_summary(each, axis, row)]
            _write_row(sheet, row, values, columns, line_above=axis == 0)
            row += 1
    sheet.auto_filter.ref = f"A1:{get_column_letter(len(columns))}{row - 1}"
    _write_notes(sheet, SUMMARY_NOTES, row + 1, len(columns))


def _summary(statistics: SeriesStatistics, axis: int, row: int) -> List[object]:
    truth, published = _number(statistics.truth[axis], UNKNOWN), _number(statistics.published[axis], "none")
    raw = _raw_cells(statistics, axis)
    if raw is None:
        return [0, truth, *[UNDEFINED] * 4, published]
    return [
        _Formula(f"=COUNT({raw})"),
        truth,
        _Formula(f'=IF(D{row}>0,AVERAGE({raw}),"{UNDEFINED}")'),
        _Formula(f'=IF(D{row}>1,STDEV({raw}),"{UNDEFINED}")'),
        _Formula(f'=IF(AND(D{row}>0,ISNUMBER(E{row})),F{row}-E{row},"{UNKNOWN}")'),
        # mean square error = VARP (the variance with divisor N) + bias^2
        _Formula(f'=IF(ISNUMBER(H{row}),SQRT(VARP({raw})+H{row}^2),"{UNKNOWN}")'),
        published,
    ]


def _distance_column(statistics: Sequence[SeriesStatistics]) -> _Column:
    """Returns the column of distances: numbers with a unit, which can be sorted and plotted."""
    axis = statistics[0].axis
    return (
        _Column(POINT, 12, INTEGER)
        if axis == POINT
        else _Column("distance", 12, f'General" {UNIT_OF[axis]}"')
    )


def _raw_cells(statistics: SeriesStatistics, axis: int) -> Optional[str]:
    """Returns the cells of an axis in the sheet of a distance, None without poses."""
    column = get_column_letter(FIRST_AXIS + axis)
    last = FIRST_ROW + statistics.count - 1
    return (
        f"'{_sheet_name(statistics.label)}'!${column}${FIRST_ROW}:${column}${last}"
        if statistics.count
        else None
    )


def _write_covariances(sheet: Worksheet, statistics: Sequence[SeriesStatistics]) -> None:
    names = [f"{axis}, {unit}" for axis, unit in zip(AXES, UNITS)]
    columns = [_distance_column(statistics), _Column("axis", 13)]
    columns += [_Column(name, 13, SCIENTIFIC) for name in names]
    _set_up_sheet(sheet, columns, "C2")
    row = FIRST_ROW
    for each in statistics:
        for i, name in enumerate(names):
            values = [each.distance, name, *[_covariance(each, i, j) for j in range(6)]]
            _write_row(sheet, row, values, columns, line_above=i == 0)
            row += 1
    _write_notes(sheet, COVARIANCE_NOTES, row + 1, len(columns))


def _covariance(statistics: SeriesStatistics, i: int, j: int) -> str:
    """Returns the formula of a covariance. COVAR divides by N; all spreadsheet programs have it."""
    first, second = _raw_cells(statistics, i), _raw_cells(statistics, j)
    count = f"COUNT({first})"
    formula = f'=IF({count}>1,COVAR({first},{second})*{count}/({count}-1),"{UNDEFINED}")'
    return _Formula(formula) if first else UNDEFINED


def _write_bags(
    sheet: Worksheet, series: Sequence[PoseSeries], statistics: Sequence[SeriesStatistics]
) -> None:
    columns = [_distance_column(statistics), _Column("bag", 60)]
    columns += [_Column(name, 12, INTEGER) for name in ("poses", "stale", "invalid", "images")]
    _set_up_sheet(sheet, columns, "A2")
    counts = [(each.distance, count) for each in series for count in each.counts]
    for row, (distance, count) in enumerate(counts, FIRST_ROW):
        images = UNKNOWN if count.images is None else count.images
        numbers = [count.poses, count.stale, count.invalid, images]
        _write_row(sheet, row, [distance, count.bag, *numbers], columns)
    _write_notes(sheet, BAGS_NOTES, FIRST_ROW + len(counts) + 1, len(columns))


def _write_poses(sheet: Worksheet, series: PoseSeries, statistics: SeriesStatistics) -> None:
    columns = _pose_columns(series, statistics)
    _set_up_sheet(sheet, columns, "D2", landscape=True)
    sigma_count = len(columns) - (FIRST_AXIS + 5)  # columns after that of yaw: 6 or none
    sigmas = published_sigmas(series)[:, :sigma_count]
    first_stamps = {bag: int(series.stamps[series.bags == bag].min()) for bag in set(series.bags)}
    rows = zip(series.stamps.tolist(), series.bags, statistics.poses, sigmas)
    for row, (stamp, bag, pose, sigma) in enumerate(rows, FIRST_ROW):
        numbers = [_number(value, "") for value in (*pose, *sigma)]
        _write_row(
            sheet, row, [(stamp - first_stamps[bag]) * 1e-9, seconds_text(stamp), bag, *numbers], columns
        )
    if statistics.count == 0:
        _write_notes(sheet, ("No poses at this distance.",), FIRST_ROW, len(columns))


def _pose_columns(series: PoseSeries, statistics: SeriesStatistics) -> List[_Column]:
    unwrapped = (statistics.poses != series.poses).any(axis=0)
    remarks = [", unwrapped" if each else "" for each in unwrapped]
    columns = [
        _Column("time since the first pose, s", 12, DECIMAL),
        _Column("stamp, s", 22),
        _Column("bag", 24),
    ]
    columns += [_Column(f"{a}, {u}{remark}", 13, DECIMAL) for a, u, remark in zip(AXES, UNITS, remarks)]
    if np.isfinite(series.covariances).any():
        columns += [_Column(f"sigma {a}, {u}", 11, DECIMAL) for a, u in zip(AXES, UNITS)]
    return columns


def _set_up_sheet(sheet: Worksheet, columns: Sequence[_Column], frozen: str, landscape: bool = False) -> None:
    """Writes headings that stay visible while scrolling; a printed page is as wide as all columns."""
    for number, column in enumerate(columns, 1):
        cell = sheet.cell(1, number, column.heading)
        for name, style in HEADING.items():
            setattr(cell, name, style)
        sheet.column_dimensions[get_column_letter(number)].width = column.width
    sheet.row_dimensions[1].height = 46 if landscape else 24
    sheet.freeze_panes = frozen
    sheet.print_title_rows = "$1:$1"
    sheet.page_setup.orientation = "landscape" if landscape else "portrait"
    sheet.page_setup.paperSize = sheet.PAPERSIZE_A4
    sheet.page_setup.fitToHeight = 0  # any number of pages
    sheet.sheet_properties.pageSetUpPr.fitToPage = True
    sheet.print_options.horizontalCentered = True
    sheet.oddHeader.center.text = "&A"
    sheet.oddFooter.center.text = "&P / &N"


def _write_row(
    sheet: Worksheet, row: int, values: Sequence[object], columns: Sequence[_Column], line_above: bool = False
) -> None:
    for number, (value, column) in enumerate(zip(values, columns), 1):
        if isinstance(value, str) and not isinstance(value, _Formula):
            value = ILLEGAL_CHARACTERS_RE.sub("?", value.encode("utf-8", "replace").decode())
        cell = sheet.cell(row, number, value)
        cell.number_format = column.format
        if isinstance(value, str):
            cell.data_type = "f" if isinstance(value, _Formula) else "s"
        cell.alignment = RIGHT if column.format != TEXT else LEFT
        if line_above:
            cell.border = TOP_LINE


def _write_notes(sheet: Worksheet, notes: Sequence[str], first: int, width: int) -> None:
    for row, note in enumerate(notes, first):
        sheet.merge_cells(start_row=row, end_row=row, start_column=1, end_column=width)
        cell = sheet.cell(row, 1, note)
        cell.font = Font(FONT, italic=True, color="404040")
        cell.alignment = Alignment(wrap_text=True, vertical="top")
        sheet.row_dimensions[row].height = 30


def _number(value: float, otherwise: str) -> Union[float, str]:
    return float(value) if np.isfinite(value) else otherwise
