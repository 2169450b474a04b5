# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Trajectories in files: TUM's text format, and CSV with a header.

TUM: `stamp tx ty tz qx qy qz qw` a line, separated by blanks, `#` begins a comment; seconds and metres
(https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats).
CSV: commas; the header names the columns (COLUMNS), in any order, and other columns are left alone: what
`rostopic echo -p` writes of poses with a header, and EuRoC's ground truth, can be read as they are.
"""

from decimal import Decimal
from pathlib import Path
from typing import Dict, Iterable, Iterator, List, Sequence, Tuple, Union

import numpy as np

import sextant
from sextant.base.atomic_file import atomic_file
from sextant.evaluation.trajectory import Trajectory
from sextant.geometry.poses import quaternion_of

FIELDS = ("stamp", "x", "y", "z", "qx", "qy", "qz", "qw")
SECOND, NANOSECOND = Decimal(10**9), Decimal(1)
LATEST = 2**32 * 10**9  # nanoseconds; ROS counts seconds in 32 bits
NORM_TOLERANCE = 1e-3  # of a quaternion: files with four decimals stay below

# Names that a column of the header may have in place of the field's own, in lower case.
COLUMNS: Dict[str, Tuple[str, ...]] = {
    "stamp": ("time", "timestamp", "t", "stamp_ns", "#timestamp [ns]", "#timestamp", "field.header.stamp"),
    **{axis: (f"t{axis}", f"p_rs_r_{axis} [m]", f"p{axis}") for axis in "xyz"},
    **{f"q{axis}": (f"q_{axis}", f"q_rs_{axis} []") for axis in "xyzw"},
}
IN_NANOSECONDS = ("stamp_ns", "#timestamp [ns]", "#timestamp", "field.header.stamp")
ROS_POSES = ("field.pose.", "field.pose.pose.", "field.transform.")  # of PoseStamped, Odometry, Transform…

WRITTEN = {".csv": ",", ".tum": " ", ".txt": " "}  # what stands between two fields

FilePath = Union[str, Path]


def read_trajectory(path: FilePath) -> Trajectory:
    """A trajectory of a file, read as its ending says: .csv, or .tum or .txt for TUM's format.

    :returns: T_map_base by stamp in nanoseconds, see sextant.evaluation.trajectory
    :raises OSError: it cannot be read
    :raises ValueError: "file:line: reason", or an ending that says nothing
    """
    readers = {".csv": read_csv, ".tum": read_tum, ".txt": read_tum}
    return readers[_checked_ending(path, readers)](path)


def read_tum(path: FilePath) -> Trajectory:
    """A trajectory of a file in TUM's format; raises as read_trajectory()."""
    rows = ((number, line.split()) for number, line in _lines(path))
    return _trajectory(path, rows, FIELDS, SECOND)


def read_csv(path: FilePath) -> Trajectory:
    """A trajectory of a CSV file with a header; raises as read_trajectory()."""
    lines = _lines(path, comments=False)
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
    """Writes a trajectory atomically, in the format that the ending says; as read_trajectory() reads it.

    :raises OSError: the file cannot be written
    :raises ValueError: an ending that says nothing
    """
    ending = _checked_ending(path, WRITTEN)
    comma = WRITTEN[ending]
    rows = [
        [f"{stamp // 10**9}.{stamp % 10**9:09d}", *(repr(float(value)) for value in _fields_of(T))]
        for stamp, T in sorted(trajectory.items())
    ]
    with atomic_file(path) as file:
        file.write(("" if comma == "," else "# ") + comma.join(FIELDS) + "\n")
        file.writelines(comma.join(row) + "\n" for row in rows)


def _fields_of(T: np.ndarray) -> List[float]:
    return [*T[:3, 3], *quaternion_of(T[:3, :3])]


def _checked_ending(path: FilePath, known: Iterable[str]) -> str:
    ending = Path(path).suffix.lower()
    if ending not in known:
        raise ValueError(f"{path}: a trajectory's file ends in {', '.join(sorted(known))}")
    return ending


def _lines(path: FilePath, comments: bool = True) -> Iterator[Tuple[int, str]]:
    """Number and text of every line that is not blank; a spreadsheet's byte order mark is left out."""
    try:
        with open(path, encoding="utf-8-sig") as file:
            for number, line in enumerate(file, 1):
                line = (line.split("#", 1)[0] if comments else line).strip()
                if line:
                    yield number, line
    except UnicodeDecodeError:
        raise ValueError(f"{path}: is no text in UTF-8") from None


def _field_of_name() -> Dict[str, str]:
    fields = {alias: field for field, aliases in COLUMNS.items() for alias in (field, *aliases)}
    for prefix in ROS_POSES:
        for axis in "xyzw":
            fields[f"{prefix}orientation.{axis}"] = fields[f"{prefix}rotation.{axis}"] = f"q{axis}"
            fields[f"{prefix}position.{axis}"] = fields[f"{prefix}translation.{axis}"] = axis
    return fields


def _fields(names: Sequence[str]) -> List[str]:
    """The field that each column of a header holds, empty for one that is left alone."""
    known = _field_of_name()
    fields = [known.get(name, "") for name in names]
    for field in FIELDS:
        columns = [name for name, each in zip(names, fields) if each == field]
        if not columns:
            raise ValueError(f"no column '{field}'; the header names {', '.join(FIELDS)}, commas between")
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
                raise ValueError(f"the stamp of line {lines[stamp]} again")
        except ValueError as error:
            raise ValueError(f"{path}:{number}: {error}") from None
        trajectory[stamp], lines[stamp] = pose, number
    if not trajectory:
        raise ValueError(f"{path}: no pose in it")
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
    """Decimal, not float: a float of today's seconds is only good to 0.2 microseconds."""
    try:
        stamp = Decimal(text.strip())
    except ArithmeticError:
        raise ValueError(f"stamp is '{text.strip()}', not a number") from None
    if not (stamp.is_finite() and 0 <= stamp < LATEST / unit):
        unit_name = "seconds" if unit == SECOND else "nanoseconds"
        raise ValueError(f"stamp is '{text.strip()}', no time in {unit_name}")
    return int((stamp * unit).to_integral_value())
