# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Trajectory files: TUM's text format, and CSV with a header.

TUM: lines `stamp tx ty tz qx qy qz qw`, separated by blanks, `#` begins a comment; seconds and metres
(https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats).
CSV: the header names the columns (COLUMNS), in any order; other columns are ignored. Output of
`rostopic echo -p` for stamped poses and EuRoC's ground truth can be read directly.
"""

from decimal import Decimal
from pathlib import Path
from typing import Dict, Iterable, Iterator, List, Sequence, Tuple, Union

import numpy as np

import sextant
from sextant.base.atomic_file import atomic_file
from sextant.evaluation.trajectory import Trajectory, seconds_text
from sextant.geometry.poses import quaternion_of

FIELDS = ("stamp", "x", "y", "z", "qx", "qy", "qz", "qw")
SECOND, NANOSECOND = Decimal(10**9), Decimal(1)
MAX_STAMP = 2**32 * 10**9  # nanoseconds; ROS stores seconds in 32 bits
NORM_TOLERANCE = 1e-3  # of a quaternion, enough for four decimals

# Alternative names of the columns in a header, in lower case.
COLUMNS: Dict[str, Tuple[str, ...]] = {
    "stamp": ("time", "timestamp", "t", "stamp_ns", "#timestamp [ns]", "#timestamp", "field.header.stamp"),
    **{axis: (f"t{axis}", f"p_rs_r_{axis} [m]", f"p{axis}") for axis in "xyz"},
    **{f"q{axis}": (f"q_{axis}", f"q_rs_{axis} []") for axis in "xyzw"},
}
IN_NANOSECONDS = ("stamp_ns", "#timestamp [ns]", "#timestamp", "field.header.stamp")
ROS_POSES = (
    "field.pose.",
    "field.pose.pose.",
    "field.transform.",
)  # of PoseStamped, Odometry, TransformStamped

SEPARATORS = {".csv": ",", ".tum": " ", ".txt": " "}  # by file name ending

FilePath = Union[str, Path]


def read_trajectory(path: FilePath) -> Trajectory:
    """Reads a trajectory from a .csv file, or from a .tum or .txt file in TUM's format.

    :returns: T_map_base by stamp in nanoseconds, see sextant.evaluation.trajectory
    :raises OSError: the file cannot be read
    :raises ValueError: "file:line: reason", or an unknown ending
    """
    readers = {".csv": read_csv, ".tum": read_tum, ".txt": read_tum}
    return readers[_checked_ending(path, readers)](path)


def read_tum(path: FilePath) -> Trajectory:
    """Reads a trajectory in TUM's format; raises as read_trajectory()."""
    rows = ((number, line.split()) for number, line in _lines(path))
    return _trajectory(path, rows, FIELDS, SECOND)


def read_csv(path: FilePath) -> Trajectory:
    """Reads a trajectory from a CSV file with a header; raises as read_trajectory()."""
    lines = _lines(path, strip_comments=False)  # the header may begin with #, as EuRoC's
    first, header = next(lines, (1, ""))
    names = [name.strip().lower() for name in header.split(",")]
    try:
        fields = _fields(names)
    except ValueError as error:
        raise ValueError(f"{path}:{first}: {error}") from None
    unit = NANOSECOND if names[fields.index("stamp")] in IN_NANOSECONDS else SECOND
    rows = ((number, line.split(",")) for number, line in lines if not line.startswith("#"))
    return _trajectory(path, rows, fields, unit)


def write_trajectory(path: FilePath, trajectory: Trajectory) -> None:
    """Writes a trajectory atomically; the ending selects the format, as in read_trajectory().

    :raises OSError: the file cannot be written
    :raises ValueError: unknown ending
    """
    ending = _checked_ending(path, SEPARATORS)
    separator = SEPARATORS[ending]
    rows = [
        [seconds_text(stamp), *(repr(float(value)) for value in (*T[:3, 3], *quaternion_of(T[:3, :3])))]
        for stamp, T in sorted(trajectory.items())
    ]
    with atomic_file(path) as file:
        file.write(("" if separator == "," else "# ") + separator.join(FIELDS) + "\n")
        file.writelines(separator.join(row) + "\n" for row in rows)


def _checked_ending(path: FilePath, known: Iterable[str]) -> str:
    ending = Path(path).suffix.lower()
    if ending not in known:
        raise ValueError(f"{path}: the file name of a trajectory must end in {', '.join(sorted(known))}")
    return ending


def _lines(path: FilePath, strip_comments: bool = True) -> Iterator[Tuple[int, str]]:
    """Yields number and text of every line that is not blank, without a byte order mark."""
    try:
        with open(path, encoding="utf-8-sig") as file:
            for number, line in enumerate(file, 1):
                line = (line.split("#", 1)[0] if strip_comments else line).strip()
                if line:
                    yield number, line
    except UnicodeDecodeError:
        raise ValueError(f"{path}: is not UTF-8 text") from None


def _field_of_name() -> Dict[str, str]:
    fields = {alias: field for field, aliases in COLUMNS.items() for alias in (field, *aliases)}
    for prefix in ROS_POSES:
        for axis in "xyzw":
            fields[f"{prefix}orientation.{axis}"] = fields[f"{prefix}rotation.{axis}"] = f"q{axis}"
            fields[f"{prefix}position.{axis}"] = fields[f"{prefix}translation.{axis}"] = axis
    return fields


def _fields(names: Sequence[str]) -> List[str]:
    """Returns the field of each column of a header; empty: ignored."""
    known = _field_of_name()
    fields = [known.get(name, "") for name in names]
    for field in FIELDS:
        columns = [name for name, each in zip(names, fields) if each == field]
        if not columns:
            raise ValueError(f"no column '{field}'; the header must be {','.join(FIELDS)}")
        if len(columns) > 1:
            raise ValueError(f"more than one column for '{field}': {', '.join(columns)}")
    return fields


def _trajectory(
    path: FilePath, rows: Iterator[Tuple[int, List[str]]], fields: Sequence[str], unit: Decimal
) -> Trajectory:
    trajectory: Trajectory = {}
    lines: Dict[int, int] = {}
    for number, row in rows:
        try:
            stamp, pose = _stamped_pose(row, fields, unit)
            if stamp in lines:
                raise ValueError(f"duplicate stamp, as in line {lines[stamp]}")
        except ValueError as error:
            raise ValueError(f"{path}:{number}: {error}") from None
        trajectory[stamp], lines[stamp] = pose, number
    if not trajectory:
        raise ValueError(f"{path}: contains no pose")
    return trajectory


def _stamped_pose(row: Sequence[str], fields: Sequence[str], unit: Decimal) -> Tuple[int, np.ndarray]:
    if len(row) != len(fields):
        raise ValueError(f"{len(row)} values, expected {len(fields)}")
    texts = dict(zip(fields, row))
    values = [_number(field, texts[field]) for field in FIELDS[1:]]
    pose = sextant.pose_from_quaternion(values[:3], values[3:], NORM_TOLERANCE)
    return _nanoseconds(texts["stamp"], unit), pose


def _number(field: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise ValueError(f"{field} is '{text.strip()}', not a number") from None
    if not np.isfinite(value):
        raise ValueError(f"{field} is '{text.strip()}', not finite")
    return value


def _nanoseconds(text: str, unit: Decimal) -> int:
    """Parses a stamp. Decimal, since a float resolves today's seconds to 0.2 microseconds only."""
    try:
        stamp = Decimal(text.strip())
    except ArithmeticError:
        raise ValueError(f"stamp is '{text.strip()}', not a number") from None
    if not (stamp.is_finite() and 0 <= stamp < MAX_STAMP / unit):
        unit_name = "seconds" if unit == SECOND else "nanoseconds"
        raise ValueError(f"stamp is '{text.strip()}', not a time in {unit_name}")
    return int((stamp * unit).to_integral_value())
