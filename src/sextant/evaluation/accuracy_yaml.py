# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes parameters of the locator from accuracy statistics, as YAML files."""

import textwrap
from dataclasses import dataclass
from pathlib import Path
from typing import List, Sequence, Union

import numpy as np

import sextant
from sextant.base.atomic_file import atomic_file
from sextant.evaluation.pose_series import AXES, UNITS, SeriesStatistics, rotation_axes

MIN_POSES = 7  # with six or fewer, the covariance is singular


@dataclass(frozen=True)
class CornerNoise:
    """Noise of detected corners."""

    sigma: float  # standard deviation of a coordinate, pixels, (0, 10]
    measured: str  # how it was measured, as a comment of the file


@dataclass(frozen=True)
class ConstantCovariance:
    """One covariance for all poses, independent of the distance of the markers."""

    matrix: np.ndarray  # (6, 6) order of PoseWithCovariance, about the fixed axes of the reference; m, rad
    measured: str  # from which poses, as a comment of the file


def constant_covariance(statistics: Sequence[SeriesStatistics], frame: str = "") -> ConstantCovariance:
    """Computes the covariance of the worst distance with at least 7 poses, by the trace of the position.

    It is the mean of e e' of the errors e, so that its diagonal is the squared RMSE: a filter has to account
    for the bias. Axes without a known true value contribute no bias. Roll, pitch and yaw are converted to
    rotations about the fixed axes (pose_series.rotation_axes()), as in PoseWithCovariance.

    :param frame: reference frame, as a comment of the file; empty: unknown
    :raises ValueError: too few poses, or an axis without variance
    """
    enough = [each for each in statistics if each.count >= MIN_POSES]
    if not enough:
        raise ValueError(f"a covariance needs at least {MIN_POSES} poses at one distance")
    worst = max(enough, key=lambda each: np.trace(_matrix(each)[:3, :3]))
    matrix = _matrix(worst)
    still = [axis for axis, variance in zip(AXES, np.diag(matrix)) if not variance > 0.0]
    if still:
        raise ValueError(f"{', '.join(still)} have no variance: are the poses planar?")
    return ConstantCovariance(matrix, f"{_describe(worst, enough)} {_axes(frame)}".strip())


def _axes(frame: str) -> str:
    """Names the axes: z of a marker, towards the camera, is not z of a map."""
    return f"In the axes of '{frame}'; the locator uses it in the axes of its map." if frame else ""


def _matrix(of: SeriesStatistics) -> np.ndarray:
    bias = np.nan_to_num(of.bias)
    matrix = of.covariance * (of.count - 1) / of.count + np.outer(bias, bias)
    turn = np.eye(6)
    turn[3:, 3:] = rotation_axes(of.mean[3:])
    matrix = turn @ matrix @ turn.T
    return 0.5 * (matrix + matrix.T)


def _describe(of: SeriesStatistics, among: Sequence[SeriesStatistics]) -> str:
    parts = [f"From {of.count} poses at {of.axis} = {of.label}"]
    parts.append(f"the worst of {', '.join(each.label for each in among)} by the trace of the position")
    unknown = [axis for axis, bias in zip(AXES, of.bias) if np.isnan(bias)]
    spread = "about the mean: without bias"
    if len(unknown) < 6:
        spread = "about the truth: with bias"
        spread += f", except of {', '.join(unknown)}, whose true values are unknown" if unknown else ""
    return "; ".join([*parts, spread]) + "."


def write_corner_noise(path: Union[str, Path], noise: CornerNoise) -> None:
    """Writes corner_sigma, a private parameter of the locator.

    :raises OSError: the file cannot be written; an existing one is unchanged
    :raises ValueError: the value is out of the locator's range
    """
    params = sextant.LocatorParams()
    params.corner_sigma = float(noise.sigma)
    params.validate()
    _write(path, [*_comment(noise.measured), f"corner_sigma: {_real(noise.sigma)}  # px"])


def write_constant_covariance(path: Union[str, Path], covariance: ConstantCovariance) -> None:
    """Writes constant_covariance, a private parameter of the locator that replaces its own covariances.

    Errors as write_corner_noise().
    """
    params = sextant.LocatorParams()
    params.constant_covariance = [float(value) for value in np.ravel(covariance.matrix)]
    params.validate()
    lines = [*_comment(covariance.measured), *_comment(_sigmas(covariance.matrix))]
    lines += ["constant_covariance:  # row by row, order x y z roll pitch yaw, m and rad"]
    rows = [", ".join(map(_real, row)) for row in covariance.matrix]
    _write(path, [*lines, "  [" + ",\n   ".join(rows) + "]"])


def _write(path: Union[str, Path], lines: List[str]) -> None:
    with atomic_file(path) as file:
        file.write("\n".join(lines) + "\n")


def _real(value: float) -> str:
    """Formats a number exactly, with a point: YAML 1.1 reads 1e-05 as a string."""
    text = repr(float(value))
    return text if "." in text else text.replace("e", ".0e")


def _sigmas(matrix: np.ndarray) -> str:
    sigmas = np.sqrt(np.diag(matrix))
    return "Sigmas: " + ", ".join(f"{a} {s:.4g} {u}" for a, s, u in zip(AXES, sigmas, UNITS)) + "."


def _comment(text: str) -> List[str]:
    text = "".join(each if each.isprintable() else " " for each in text)  # YAML refuses control characters
    return textwrap.wrap(text, 100, initial_indent="# ", subsequent_indent="# ")
