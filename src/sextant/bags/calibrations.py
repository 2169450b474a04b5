# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Calibrations of cameras: from camera_info, or from a file of camera_calibration."""

from typing import Any, Dict, List, Tuple

import numpy as np
import yaml

from sextant.bags.bag_file import BagError
from sextant.markers.drive_sightings import DriveCamera

# matrix of the file: (field of camera_info, allowed (rows, columns)); 0: any number
_MATRICES: Dict[str, Tuple[str, Tuple[int, int]]] = {
    "camera_matrix": ("K", (3, 3)),
    "distortion_coefficients": ("D", (1, 0)),
    "rectification_matrix": ("R", (3, 3)),
    "projection_matrix": ("P", (3, 4)),
}
_SAME = ("width", "height", "distortion_model", "D", "K", "R", "P", "binning_x", "binning_y")
_REGION = ("x_offset", "y_offset", "width", "height")


def same_calibration(a: Any, b: Any) -> bool:
    """Whether two sensor_msgs/CameraInfo say the same of a camera."""
    same = all(tuple(_listed(getattr(a, name))) == tuple(_listed(getattr(b, name))) for name in _SAME)
    return same and all(getattr(a.roi, name) == getattr(b.roi, name) for name in _REGION)


def _listed(value: Any) -> Any:
    return value if isinstance(value, (list, tuple)) else (value,)


def camera_from_info(info: Any, rectified: bool) -> DriveCamera:
    """The camera of the image as it is published: binning and region of interest of a
    sensor_msgs/CameraInfo are applied (src/ros/conversions.cpp). Its mount is left at identity.

    :raises ValueError: it is no calibration; names the field
    """
    binning = np.array([max(1, info.binning_x), max(1, info.binning_y)])
    whole = info.roi.width == 0 or info.roi.height == 0
    size = [info.width, info.height] if whole else [info.roi.width, info.roi.height]
    offset = np.array([0.0, 0.0] if whole else [info.roi.x_offset, info.roi.y_offset])
    width, height = (int(side) for side in np.array(size) // binning)
    K = _published(np.reshape(info.K, (3, 3)), binning, offset)
    P = _published(np.reshape(info.P, (3, 4)), binning, offset)
    return _checked(width, height, info.distortion_model, info.D, K, info.R, P, rectified)


def _published(matrix: np.ndarray, binning: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """K or P for the pixels that are published: merged ones have their centres half a pixel inside."""
    adapted = matrix.astype(float)
    adapted[:2] /= binning[:, None]
    adapted[:2, 2] = (matrix[:2, 2] - offset + 0.5) / binning - 0.5
    return adapted


def _checked(width, height, model, D, K, R, P, rectified) -> DriveCamera:
    D, K, R, P = (tuple(float(value) for value in np.ravel(matrix)) for matrix in (D, K, R, P))
    camera = DriveCamera(width, height, model, D, K, R, P, rectified, np.eye(4))
    camera.model()
    return camera


def camera_from_file(path: str, rectified: bool) -> DriveCamera:
    """The camera of a YAML file as camera_calibration writes it; for images of the size that it names.

    :raises BagError: it cannot be read, or is no such file; names what is missing or wrong
    """
    try:
        with open(path, encoding="utf-8") as file:
            content = yaml.safe_load(file)
        return _camera_from_content(content, rectified)
    except OSError as error:
        raise BagError(path, f"cannot be read ({error.strerror})", "name a calibration file") from None
    except (ValueError, yaml.YAMLError) as error:
        what = "is no calibration file: " + " ".join(str(error).split())
        raise BagError(path, what, "expected is a YAML file as camera_calibration writes it") from None


def _camera_from_content(content: Any, rectified: bool) -> DriveCamera:
    if not isinstance(content, dict):
        raise ValueError("there are no `name: value` lines in it")
    sides = [_entry(content, name) for name in ("image_width", "image_height")]
    if not all(isinstance(side, int) and not isinstance(side, bool) for side in sides):
        raise ValueError(f"image_width and image_height are {sides}, not whole numbers")
    model = content.get("distortion_model", "plumb_bob")  # as camera_calibration_parsers has it
    if not isinstance(model, str):
        raise ValueError(f"distortion_model is {model!r}, not a name")
    matrices = {
        field: _matrix(name, _entry(content, name), shape) for name, (field, shape) in _MATRICES.items()
    }
    return _checked(*sides, model, rectified=rectified, **matrices)


def _entry(content: Dict[str, Any], name: str) -> Any:
    if name not in content:
        raise ValueError(f"no {name}")
    return content[name]


def _matrix(name: str, entry: Any, shape: Tuple[int, int]) -> List[float]:
    if not isinstance(entry, dict) or {"rows", "cols", "data"} - set(entry):
        raise ValueError(f"{name} needs rows, cols and data")
    rows, columns, data = entry["rows"], entry["cols"], entry["data"]
    _check_numbers(name, data)
    if rows != shape[0] or columns != (shape[1] or len(data)) or len(data) != rows * columns:
        expected = f"{shape[0]} x {shape[1] or 'n'}"
        raise ValueError(f"{name}: {rows} x {columns} with {len(data)} numbers, expected {expected}")
    return data


def _check_numbers(name: str, data: Any) -> None:
    numbers = isinstance(data, list) and all(_is_number(value) for value in data)
    if not numbers or not np.all(np.isfinite(np.array(data, dtype=float))):
        raise ValueError(f"{name}: data is no list of finite numbers")


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)
