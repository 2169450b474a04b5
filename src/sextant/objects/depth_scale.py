# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Estimation of the factor that corrects a depth camera's depths, from distances measured with a tape."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import List, NamedTuple, Sequence, Tuple

import numpy as np

from sextant.base.strict_params import StrictParams, param, within

MAX_DISTANCE = 100.0  # metres
SIGNIFICANCE = 3.0  # standard deviations
COLUMNS = ("measured", "true")


class MeasuredDepth(NamedTuple):
    """Measured and true distance, in metres."""

    measured: float  # depth from the camera
    true: float  # distance from the tape


@dataclass(frozen=True)
class DepthScaleParams(StrictParams):
    """Standard deviations of both distances."""

    depth_sigma: float = param(
        0.004,
        "standard deviation of a depth at 1 m; grows with the square of the depth",
        within(1e-6, 1),
        "m",
    )
    tape_sigma: float = param(
        0.002, "standard deviation of a distance measured with the tape", within(0, 1), "m"
    )


class DepthScale(NamedTuple):
    """The model true = scale * measured, its residuals, and significant deviations from it."""

    scale: float  # factor
    deviation: float  # standard deviation of the scale
    residuals: np.ndarray  # (n,) true - scale * measured, metres
    sigmas: np.ndarray  # (n,) expected standard deviations of the residuals, metres
    warnings: List[str]  # a significant offset or curvature


def read_measured_depths(path: Path) -> List[MeasuredDepth]:
    """Read lines `measured, true` in metres; a title line with these names and comments with # are skipped.

    :raises OSError: the file cannot be read
    :raises ValueError: names the invalid line and the reason
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except UnicodeDecodeError:
        raise ValueError(f"{path}: is not a text file") from None
    found: List[MeasuredDepth] = []
    for number, line in enumerate(lines, 1):
        cells = [cell.strip() for cell in line.split(",")]
        is_title = not found and tuple(cells) == COLUMNS
        if cells != [""] and not cells[0].startswith("#") and not is_title:
            found.append(_measured(cells, f"{path}:{number}"))
    if not found:
        raise ValueError(f"{path}: contains no line `measured, true`")
    return found


def _measured(cells: List[str], where: str) -> MeasuredDepth:
    if len(cells) != 2:
        raise ValueError(f"{where}: must be two numbers, measured and true, is '{','.join(cells)}'")
    return MeasuredDepth(*(_metres(cell, where) for cell in cells))


def _metres(text: str, where: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value <= MAX_DISTANCE:
        raise ValueError(f"{where}: '{text}' is not a distance in (0, {MAX_DISTANCE:g}] metres")
    return value


def estimate_depth_scale(measured: Sequence[MeasuredDepth], params: DepthScaleParams) -> DepthScale:
    """Weighted least squares through the origin. The standard deviation is scaled by the Birge ratio of the
    residuals if that is above 1 (Birge 1932, "The calculation of errors by the method of least squares").

    :raises ValueError: no distances, or a parameter out of range
    """
    if not measured:
        raise ValueError("no distance was measured")
    measured, true = np.array(measured, float).T
    sigmas = np.hypot(params.depth_sigma * true**2, params.tape_sigma)
    (scale,), (deviation,), residuals = _least_squares(measured[:, np.newaxis], true, sigmas)
    warnings = []
    for name, other, unit in (
        ("an offset", np.ones_like(measured), "m"),
        ("a curvature", measured**2, "1/m"),
    ):
        warnings += _warning(name, np.column_stack([measured, other]), true, sigmas, unit)
    return DepthScale(float(scale), float(deviation), residuals, sigmas, warnings)


def _least_squares(
    A: np.ndarray, b: np.ndarray, sigmas: np.ndarray
) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coefficients, their standard deviations, and residuals."""
    weighted = A / sigmas[:, np.newaxis]
    covariance = np.linalg.inv(weighted.T @ weighted)
    found = covariance @ (weighted.T @ (b / sigmas))
    residuals = b - A @ found
    freedom = len(b) - len(found)
    birge = np.sum((residuals / sigmas) ** 2) / freedom if freedom else 1.0
    return found, np.sqrt(np.diag(covariance) * max(1.0, birge)), residuals


def _warning(name: str, A: np.ndarray, true: np.ndarray, sigmas: np.ndarray, unit: str) -> List[str]:
    """A message if a further coefficient is significant; it needs at least three distances."""
    if len(np.unique(A[:, 0])) < 3:
        return []
    (scale, value), (_, deviation), _ = _least_squares(A, true, sigmas)
    if abs(value) <= SIGNIFICANCE * deviation:
        return []
    return [
        f"{name} of {value:+.4f} ± {deviation:.4f} {unit} is significant; with it the scale is {scale:.4f}"
    ]
