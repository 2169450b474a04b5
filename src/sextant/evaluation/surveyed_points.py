# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Surveyed points: a CSV file with the true poses of a standing robot, and the bags recorded there.

    bag,x,y,z,yaw
    p1.bag,-0.61,0.61,0,1.571
    p2/,0,0.61,0,unknown

bag: a file, or a folder with one or more bags, relative to the CSV file. x, y, z: metres in the map; yaw:
radians. The columns may be in any order.
"""

import csv
from dataclasses import dataclass, field
from pathlib import Path
from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence, Union

import numpy as np

from sextant.base.atomic_file import atomic_file
from sextant.evaluation.distance_folders import DistanceBag, DistanceBags, bags_in, is_bag
from sextant.evaluation.pose_series import AXES, POINT, UNIT_OF

SURVEYED = ("x", "y", "z", "yaw")  # axes
COLUMNS = ("bag", *SURVEYED)
UNKNOWN = "unknown"  # in place of a number
LIMITS = {"m": 1e4, "rad": 2.0 * np.pi}  # of absolute values, by unit


class SurveyedPoint(NamedTuple):
    """A row of the file."""

    bag: str  # file or folder, as in the row
    truth: Mapping[str, Optional[float]]  # of SURVEYED, metres and radians; None: unknown
    where: str = ""  # "file:line"


@dataclass(frozen=True)
class SurveyedPoints:
    """True poses of series whose distances are numbers of points, from 1."""

    points: Sequence[SurveyedPoint]  # in the order of their numbers
    others: Mapping[str, Optional[float]] = field(default_factory=dict)  # roll, pitch; default None: unknown
    axis: str = POINT  # in place of a measured axis

    def at(self, distance: float) -> np.ndarray:
        """Returns the true pose (6,) of the point with this number, in metres and radians; NaN: unknown."""
        truth = {**self.others, **self.points[round(distance) - 1].truth}
        values = [truth.get(axis) for axis in AXES]
        return np.array([np.nan if value is None else value for value in values])


def read_points(path: Path) -> List[SurveyedPoint]:
    """Reads a file of points.

    :raises OSError: it cannot be read
    :raises ValueError: "file:line: what is wrong; what to do"
    """
    points: List[SurveyedPoint] = []
    with open(path, newline="", encoding="utf-8-sig") as file:
        rows = csv.DictReader(file, skipinitialspace=True)
        try:
            _check_header([name.strip() for name in rows.fieldnames or ()])
            rows.fieldnames = [name.strip() for name in rows.fieldnames or ()]
            for row in rows:
                points.append(_point(row, f"{path}:{rows.line_num}"))
        except UnicodeDecodeError:
            raise ValueError(f"{path}: is not UTF-8 text; save it as CSV in UTF-8") from None
        except (ValueError, csv.Error) as error:
            raise ValueError(f"{path}:{max(rows.line_num, 1)}: {error}") from None
    if not points:
        raise ValueError(f"{path}:2: there is no point; write one line per point: {','.join(COLUMNS)}")
    return points


def _check_header(names: Sequence[str]) -> None:
    wrong = [f"no column '{name}'" for name in COLUMNS if name not in names]
    wrong += [f"unknown column '{name}'" for name in names if name not in COLUMNS]
    wrong += [f"two columns '{name}'" for name in COLUMNS if names.count(name) > 1]
    if wrong:
        raise ValueError(f"{'; '.join(wrong)}; the first line must be {','.join(COLUMNS)}")


def _point(row: Dict[Optional[str], Union[str, List[str], None]], where: str) -> SurveyedPoint:
    count = sum(value is not None for key, value in row.items() if key is not None) + len(row.get(None) or ())
    if count != len(COLUMNS):
        raise ValueError(f"{count} values, there must be {len(COLUMNS)}; write decimals with a point")
    texts = {name: str(row[name]).strip() for name in COLUMNS}
    if not texts["bag"]:
        raise ValueError("the bag is missing; name the bag that was recorded at this point, or its folder")
    return SurveyedPoint(texts["bag"], {axis: _value(axis, texts[axis]) for axis in SURVEYED}, where)


def _value(axis: str, text: str) -> Optional[float]:
    if text == UNKNOWN:
        return None
    unit = UNIT_OF[axis]
    try:
        value = float(text)
    except ValueError:
        raise ValueError(f"{axis} is '{text}', not a number; write {unit}, or {UNKNOWN}") from None
    if not abs(value) <= LIMITS[unit]:
        raise ValueError(f"{axis} is {text}, allowed is at most {LIMITS[unit]:g} {unit}; is it in {unit}?")
    return value


def point_bags(points: Sequence[SurveyedPoint], folder: Path) -> DistanceBags:
    """Finds the bags of all points.

    :param folder: of the CSV file, to which bags are relative
    :returns: bags by number of the point; problems: "file:line: what is wrong; what to do"
    """
    bags: List[DistanceBag] = []
    problems: List[str] = []
    lines: Dict[Path, str] = {}
    for number, point in enumerate(points, 1):
        inner: List[str] = []
        try:
            for bag in _bags_at(point, folder, inner):
                first = lines.setdefault(bag.resolve(), point.where)
                if first != point.where:
                    raise ValueError(f"{bag} is also the bag of {first}; name the bag of each point once")
                bags.append(DistanceBag(float(number), str(bag)))
        except ValueError as error:
            inner.append(str(error))
        problems += [f"{point.where}: {problem}" for problem in inner]
    return DistanceBags(bags, problems)


def _bags_at(point: SurveyedPoint, folder: Path, problems: List[str]) -> List[Path]:
    path = folder / point.bag
    if path.is_dir():
        return bags_in(path, problems)
    if not path.exists():
        raise ValueError(f"there is no bag {path}; correct the name, or record it")
    if not is_bag(path):
        raise ValueError(f"{path} is not a bag; name a file that ends in .bag, or a folder")
    return [path]


def write_points(path: Path, points: Sequence[SurveyedPoint]) -> None:
    """Writes a file of points atomically.

    :raises OSError: it cannot be written
    """
    with atomic_file(path) as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        for point in points:
            values = [point.truth[axis] for axis in SURVEYED]
            writer.writerow([point.bag, *(UNKNOWN if value is None else repr(value) for value in values)])
