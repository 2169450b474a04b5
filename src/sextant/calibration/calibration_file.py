# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Calibration files as camera_calibration and camera_info_manager write them."""

import math
from pathlib import Path
from typing import Any, Dict, List, Union

import numpy as np
import yaml

import sextant

_MATRICES = {"camera_matrix": (3, 3), "rectification_matrix": (3, 3), "projection_matrix": (3, 4)}


class CalibrationFileError(ValueError):
    """A file that is no calibration: "file: what is wrong"."""

    def __init__(self, path: Union[str, Path], what: str):
        super().__init__(str(path), what)
        self.path, self.what = str(path), what

    def __str__(self) -> str:
        return f"{self.path}: {self.what}"


def read_calibration(path: Union[str, Path]) -> "sextant.CameraCalibration":
    """The calibration in a YAML file, for raw images.

    :raises CalibrationFileError: the file cannot be read, a field is missing or has no sense, or the camera
        model refuses the values
    """
    try:
        return _calibration(_table(Path(path)))
    except OSError as error:
        raise CalibrationFileError(path, f"cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise CalibrationFileError(path, "is no text") from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f" in line {mark.line + 1}" if mark else ""
        problem = getattr(error, "problem", error)
        raise CalibrationFileError(path, f"is no YAML{line}: {problem}") from None
    except ValueError as error:
        raise CalibrationFileError(path, str(error)) from None


def _table(path: Path) -> Dict[str, Any]:
    table = yaml.safe_load(path.read_text(encoding="utf-8"))
    if not isinstance(table, dict):
        raise ValueError("is no calibration as camera_calibration writes it")
    return table


def _calibration(table: Dict[str, Any]) -> "sextant.CameraCalibration":
    calibration = sextant.CameraCalibration()
    calibration.width, calibration.height = _pixels(table, "image_width"), _pixels(table, "image_height")
    # without a model it is plumb_bob, as camera_calibration_parsers has it
    calibration.distortion_model = str(table.get("distortion_model", "plumb_bob"))
    calibration.D = _numbers(table, "distortion_coefficients")
    calibration.K, calibration.R, calibration.P = (
        np.reshape(_numbers(table, name, rows, cols), (rows, cols))
        for name, (rows, cols) in _MATRICES.items()
    )
    sextant.CameraModel(calibration)  # refuses what it cannot project with
    return calibration


def _field(table: Dict[str, Any], name: str) -> Any:
    if name not in table:
        raise ValueError(f"has no {name}")
    return table[name]


def _pixels(table: Dict[str, Any], name: str) -> int:
    value = _field(table, name)
    if not isinstance(value, int) or isinstance(value, bool) or value < 1:
        raise ValueError(f"{name} is {value!r}, it must be a whole number of pixels")
    return value


def _numbers(table: Dict[str, Any], name: str, rows: int = 1, cols: int = 0) -> List[float]:
    """The data of a matrix; without cols as many as it says of itself."""
    matrix = _field(table, name)
    data = matrix.get("data") if isinstance(matrix, dict) else None
    numbers = [_number(value) for value in data] if isinstance(data, list) else [math.nan]
    if not np.all(np.isfinite(numbers)):
        raise ValueError(f"{name} needs 'data', a list of numbers")
    told = (matrix.get("rows"), matrix.get("cols"))
    wanted = (rows, cols or len(numbers))
    if told != wanted or len(numbers) != wanted[0] * wanted[1]:
        needed = f"{rows} x {cols}" if cols else "as many in one row"
        raise ValueError(
            f"{name} has {len(numbers)} numbers and says {told[0]} x {told[1]}, it needs {needed}"
        )
    return numbers


def _number(value: Any) -> float:
    """NaN for what is none. 5e-05 is a text to PyYAML, and what camera_info_manager writes."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        return math.nan
    try:
        return float(value)
    except ValueError:
        return math.nan
