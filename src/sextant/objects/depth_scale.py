# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""By what a depth camera's depths have to be multiplied, from distances that were measured with a tape."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import List, NamedTuple, Sequence, Tuple

import numpy as np

from sextant.base.strict_params import StrictParams, param, within

MOST = 100.0  # metres
SIGNIFICANT = 3.0  # deviations
COLUMNS = ("told", "true")


class MeasuredDepth(NamedTuple):
    """One distance, in metres."""

    told: float  # by the camera
    true: float  # by the tape


@dataclass(frozen=True)
class DepthScaleParams(StrictParams):
    """How exact both are."""

    range_sigma: float = param(0.004, within(1e-6, 1))  # of a depth at 1 m, growing with its square, metres
    tape_sigma: float = param(0.002, within(0, 1))  # deviation of a taped distance, metres


class DepthScale(NamedTuple):
    """true = scale * told, and what does not fit into that."""

    scale: float
    deviation: float
    residuals: np.ndarray  # (n,) true - scale * told, metres
    sigmas: np.ndarray  # (n,) deviations that are expected of them
    doubts: List[str]  # what is significantly otherwise


def read_measured_depths(path: Path) -> List[MeasuredDepth]:
    """Lines `told, true` in metres; a first line with these names and lines with a # first are passed over.

    :raises OSError: it cannot be read
    :raises ValueError: names the line and what is wrong with it
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except UnicodeDecodeError:
        raise ValueError(f"{path}: is no text") from None
    found: List[MeasuredDepth] = []
    for number, line in enumerate(lines, 1):
        cells = [cell.strip() for cell in line.split(",")]
        is_title = not found and tuple(cells) == COLUMNS
        if cells != [""] and not cells[0].startswith("#") and not is_title:
            found.append(_measured(cells, f"{path}:{number}"))
    if not found:
        raise ValueError(f"{path}: there is no line `told, true` in it")
    return found


def _measured(cells: List[str], where: str) -> MeasuredDepth:
    if len(cells) != 2:
        raise ValueError(f"{where}: must be two numbers, told and true, is '{','.join(cells)}'")
    return MeasuredDepth(*(_metres(cell, where) for cell in cells))


def _metres(text: str, where: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value <= MOST:
        raise ValueError(f"{where}: '{text}' is no distance in (0, {MOST:g}] metres")
    return value


def estimate_depth_scale(measured: Sequence[MeasuredDepth], params: DepthScaleParams) -> DepthScale:
    """Weighted least squares through the origin. The deviation is larger where the residuals are (Birge 1932,
    "The calculation of errors by the method of least squares").

    :raises ValueError: nothing was measured, or a setting out of range
    """
    if not measured:
        raise ValueError("no distance was measured")
    told, true = np.array(measured, float).T
    sigmas = np.hypot(params.range_sigma * true**2, params.tape_sigma)
    (scale,), (deviation,), residuals = _fitted(told[:, np.newaxis], true, sigmas)
    doubts = []
    for name, other, unit in (("an offset", np.ones_like(told), "m"), ("a curvature", told**2, "1/m")):
        doubts += _doubt(name, np.column_stack([told, other]), true, sigmas, unit)
    return DepthScale(float(scale), float(deviation), residuals, sigmas, doubts)


def _fitted(A: np.ndarray, b: np.ndarray, sigmas: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coefficients, their deviations, and residuals."""
    weighted = A / sigmas[:, np.newaxis]
    covariance = np.linalg.inv(weighted.T @ weighted)
    found = covariance @ (weighted.T @ (b / sigmas))
    residuals = b - A @ found
    freedom = len(b) - len(found)
    birge = np.sum((residuals / sigmas) ** 2) / freedom if freedom else 1.0
    return found, np.sqrt(np.diag(covariance) * max(1.0, birge)), residuals


def _doubt(name: str, A: np.ndarray, true: np.ndarray, sigmas: np.ndarray, unit: str) -> List[str]:
    """In words, whether there is something beside the scale; three distances are needed to tell."""
    if len(np.unique(A[:, 0])) < 3:
        return []
    (scale, value), (_, deviation), _ = _fitted(A, true, sigmas)
    if abs(value) <= SIGNIFICANT * deviation:
        return []
    return [
        f"{name} of {value:+.4f} ± {deviation:.4f} {unit} is significant; with it the scale is {scale:.4f}"
    ]
