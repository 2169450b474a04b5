# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads calibration files of camera_calibration and camera_info_manager."""

import math
from pathlib import Path
from typing import Any, Dict, List, Union

import numpy as np
import yaml

import sextant

_MATRICES = {"camera_matrix": (3, 3), "rectification_matrix": (3, 3), "projection_matrix": (3, 4)}


class CalibrationFileError(ValueError):
    """A file is not a valid calibration: "file: reason"."""

    def __init__(self, path: Union[str, Path], what: str):
        super().__init__(str(path), what)
        self.path, self.what = str(path), what

    def __str__(self) -> str:
        return f"{self.path}: {self.what}"


def read_calibration(path: Union[str, Path]) -> "sextant.CameraCalibration":
    """Reads a YAML file.

    :returns: calibration of the raw images
    :raises CalibrationFileError: the file cannot be read, a field is missing or invalid, or the camera model
        refuses the values
    """
    try:
        return _calibration(yaml.safe_load(Path(path).read_text(encoding="utf-8")))
    except OSError as error:
        what = f"cannot be read: {error.strerror}"
    except UnicodeDecodeError:
        what = "is not a text file"
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f" in line {mark.line + 1}" if mark else ""
        what = f"is not YAML{line}: {getattr(error, 'problem', error)}"
    except ValueError as error:
        what = str(error)
    raise CalibrationFileError(path, what)


def _calibration(table: Any) -> "sextant.CameraCalibration":
    if not isinstance(table, dict):
        raise ValueError("is not a calibration file of camera_calibration")
    calibration = sextant.CameraCalibration()
    calibration.width, calibration.height = _pixels(table, "image_width"), _pixels(table, "image_height")
    # the default model is that of camera_calibration_parsers
    calibration.distortion_model = str(table.get("distortion_model", "plumb_bob"))
    calibration.D = _numbers(table, "distortion_coefficients")
    calibration.K, calibration.R, calibration.P = (
        np.reshape(_numbers(table, name, rows, cols), (rows, cols))
        for name, (rows, cols) in _MATRICES.items()
    )
    sextant.CameraModel(calibration)  # validates the values
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
    """Returns the data of a matrix; cols 0: any number of columns."""
    matrix = _field(table, name)
    data = matrix.get("data") if isinstance(matrix, dict) else None
    numbers = [_number(value) for value in data] if isinstance(data, list) else [math.nan]
    if not np.all(np.isfinite(numbers)):
        raise ValueError(f"{name} needs 'data', a list of numbers")
    shape = (matrix.get("rows"), matrix.get("cols"))
    wanted = (rows, cols or len(numbers))
    if shape != wanted or len(numbers) != wanted[0] * wanted[1]:
        needed = f"{rows} x {cols}" if cols else "one row of all numbers"
        raise ValueError(
            f"{name} has {len(numbers)} numbers and the shape {shape[0]} x {shape[1]}, it needs {needed}"
        )
    return numbers


def _number(value: Any) -> float:
    """Parses a number; NaN if invalid. PyYAML reads 5e-05, as camera_info_manager writes it, as a string."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        return math.nan
    try:
        return float(value)
    except ValueError:
        return math.nan
