# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Report of a sweep of marker_design: ranges by marker size, the smallest size for a target, and files.

A figure of several angles, numbers in view, noises or lights is that of the worst of them.
"""

import csv
from pathlib import Path
from typing import Callable, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from sextant.base.atomic_file import atomic_file
from sextant.evaluation.marker_design import QUANTILE, CellResult, Resolution, Setup, Target

MIN_DETECTED = 0.95  # fraction of the markers that are detected up to the range
NUMBERS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
COLUMNS = (
    "width, px",
    "height, px",
    "family",
    "noise, grey levels",
    "light, grey levels",
    "size, m",
    "in view",
    "distance, m",
    "angle, degrees",
    "size, px",
    "images",
    "markers detected, %",
    "images with a pose, %",
    "median position error, m",
    "95 % position error, m",
    "95 % rotation error, degrees",
    "CPU, ms",
)


class Choice(NamedTuple):
    """The smallest marker that reaches a target."""

    in_view: int  # number of markers
    size: Optional[float]  # edge length, m; None: no size of the sweep


def write_table(path: Path, results: Iterable[CellResult]) -> None:
    """Writes a CSV file, one row per combination; empty figures: the markers do not fit into the image.

    :raises OSError: the file cannot be written; an existing one is unchanged
    """
    with atomic_file(path) as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(map(_row, results))


def _row(result: CellResult) -> List[object]:
    cell, setup = result.cell, result.cell.setup
    values = [*setup.resolution, *setup[1:], *cell[1:], f"{result.pixels:.4g}", result.images]
    figures = [100.0 * result.detected, 100.0 * result.located, result.median_error, result.error]
    figures += [np.rad2deg(result.angle_error), 1e3 * result.cpu]
    return values + [f"{each:.4g}" if result.images else "" for each in figures]


def range_table(results: Sequence[CellResult], setup: Setup, name: str, target: Target) -> List[str]:
    """Formats the range of detection and the range within target.error by marker size, as lines.

    :param name: of the setup, as describe()
    """
    own = [each for each in results if each.cell.setup == setup]
    angles = ", ".join(f"{each:g}" for each in values_of(own, "angle"))
    heading = f"{100 * QUANTILE:g} % of the poses within {100 * target.error:g} cm up to"
    counts = "".join(f"{in_view_text(count):16}" for count in values_of(own, "in_view"))
    return [
        f"{name}; worst of {angles} degrees",
        f"{'':10}{'markers':18}{heading}",
        f"{'size':10}{'detected up to':18}{counts}CPU per image",
        *(
            _range_line([each for each in own if each.cell.size == size], target)
            for size in values_of(own, "size")
        ),
    ]


def _range_line(own: List[CellResult], target: Target) -> str:
    seen = [each for each in own if each.images]
    detected = _good_distances(seen, lambda each: each.detected >= MIN_DETECTED)
    pixels = {each.cell.distance: f" ({each.pixels:.0f} px)" for each in seen}
    ranges = []
    for count in values_of(own, "in_view"):
        of_count = [each for each in own if each.cell.in_view == count]
        ranges.append(_good_distances(of_count, lambda each: each.error <= target.error))
    cpu = max((each.cpu for each in seen), default=np.nan)
    limit = _limit(detected) + (pixels[detected[-1]] if detected else "")
    cells = "".join(f"{_limit(each):16}" for each in ranges)
    return f"{own[0].cell.size:<5g} m   {limit:18}{cells}{1e3 * cpu:.0f} ms"


def _limit(distances: List[float]) -> str:
    """Formats the last distance, metres."""
    return f"{distances[-1]:g} m" if distances else "–"


def _good_distances(results: List[CellResult], is_good: Callable[[CellResult], bool]) -> List[float]:
    """Returns the distances, in ascending order, up to the first one at which a result is not good.

    Distances at which the markers do not fit into the image are left out.
    """
    good: List[float] = []
    for distance in values_of(results, "distance"):
        there = [each for each in results if each.cell.distance == distance]
        if all(each.images for each in there):
            if not all(map(is_good, there)):
                break
            good.append(distance)
    return good


def choices(results: Iterable[CellResult], target: Target) -> Dict[Tuple[Resolution, str], List[Choice]]:
    """Returns the smallest size for every number in view, by resolution and family."""
    chosen: Dict[Tuple[Resolution, str], List[Choice]] = {}
    for key in dict.fromkeys(each.cell.setup[:2] for each in results):
        own = [each for each in results if each.cell.setup[:2] == key]
        chosen[key] = [_choice(own, count, target) for count in values_of(own, "in_view")]
    return chosen


def _choice(results: List[CellResult], in_view: int, target: Target) -> Choice:
    own = [each for each in results if each.cell.in_view == in_view]
    for size in values_of(own, "size"):
        of_size = [each for each in own if each.cell.size == size]
        if target.distance in _good_distances(of_size, lambda each: each.error <= target.error):
            return Choice(in_view, size)
    return Choice(in_view, None)


def answer(chosen: Sequence[Choice], key: Tuple[Resolution, str], camera: str, target: Target) -> str:
    """Formats choices, e.g. "for 2 cm at 4 m with camera.yaml, ...: markers of 0.16 m, two in view".

    :param key: resolution and family
    :param camera: its name
    """
    found = [f"markers of {each.size:g} m, {in_view_text(each.in_view)}" for each in chosen if each.size]
    lacking = " or ".join(NUMBERS[each.in_view] for each in chosen if each.size is None)
    if lacking:
        found.append(f"with {lacking} in view no size of this sweep")
    (width, height), family = key
    where = f"{100 * target.error:g} cm at {target.distance:g} m with {camera}, {width} x {height}, {family}"
    return f"for {where}: {'; '.join(found)}"


def describe(setup: Setup, focal_length: float) -> str:
    """Formats a setup as text.

    :param focal_length: pixels
    """
    camera = f"{setup.resolution[0]} x {setup.resolution[1]}, f = {focal_length:.0f} px"
    return f"{camera}, {setup.family}, noise {setup.noise:g}, light {setup.light:g}"


def in_view_text(count: int) -> str:
    """Formats a number of markers in view, e.g. "two in view"."""
    return f"{NUMBERS[count]} in view"


def values_of(results: Iterable[CellResult], name: str) -> List[float]:
    """Returns the values of a field of the cells, in ascending order."""
    return sorted({getattr(each.cell, name) for each in results})
