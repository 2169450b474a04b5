# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the locator takes of the statistics, as a YAML file of its parameters."""

import textwrap
from dataclasses import dataclass
from pathlib import Path
from typing import List, Optional, Sequence, Union

import numpy as np

import sextant
from sextant.base.atomic_file import atomic_file
from sextant.evaluation.pose_series import AXES, UNITS, SeriesStatistics, rotation_axes

FEWEST = 7  # poses: of six or fewer the matrix is singular, which says of some direction that it is exact


@dataclass(frozen=True)
class CornerNoise:
    """Noise of the corners that a camera and a detector see."""

    sigma: float  # standard deviation of a coordinate, pixels, (0, 10]
    measured: str  # how, for the file's reader


@dataclass(frozen=True)
class ConstantCovariance:
    """A covariance for every pose, which knows nothing of how far the markers are."""

    matrix: np.ndarray  # (6, 6) order of PoseWithCovariance, about the fixed axes of the reference; m, rad
    measured: str  # of which poses, for the file's reader


def constant_covariance(statistics: Sequence[SeriesStatistics], frame: str = "") -> ConstantCovariance:
    """The covariance of the worst distance of those with 7 poses or more, by the position's trace.

    It is the mean of e e' with e the errors, so that its diagonal is the squared RMSE: a bias that stays is
    an error that a filter has to reckon with. Axes whose truth is not known have no bias in it. Roll, pitch
    and yaw become rotations about the fixed axes (pose_series.rotation_axes()), which is what
    PoseWithCovariance means.

    :param frame: whose axes they are, for the file's reader; empty: not told
    :raises ValueError: too few poses, or an axis that never varies
    """
    enough = [each for each in statistics if each.count >= FEWEST]
    if not enough:
        raise ValueError(f"a covariance needs {FEWEST} poses of one distance at least, there are not so many")
    worst = max(enough, key=lambda each: np.trace(_matrix(each)[:3, :3]))
    matrix = _matrix(worst)
    still = [axis for axis, variance in zip(AXES, np.diag(matrix)) if not variance > 0.0]
    if still:
        raise ValueError(f"{', '.join(still)} never vary, and exact they are not: are the poses of a plane?")
    return ConstantCovariance(matrix, f"{_told(worst, enough)} {_axes(frame)}".strip())


def _axes(frame: str) -> str:
    """The marker's z, towards the camera, is no z of a map."""
    return f"In the axes of '{frame}'; the locator takes it in those of its map." if frame else ""


def _matrix(of: SeriesStatistics) -> np.ndarray:
    bias = np.nan_to_num(of.bias)
    matrix = of.covariance * (of.count - 1) / of.count + np.outer(bias, bias)
    turn = np.eye(6)
    turn[3:, 3:] = rotation_axes(of.mean[3:])
    matrix = turn @ matrix @ turn.T
    return 0.5 * (matrix + matrix.T)


def _told(of: SeriesStatistics, among: Sequence[SeriesStatistics]) -> str:
    parts = [f"Of {of.count} poses at {of.axis} = {of.label}"]
    parts.append(f"the worst of {', '.join(each.label for each in among)} by the trace of the position")
    unknown = [axis for axis, bias in zip(AXES, of.bias) if np.isnan(bias)]
    spread = "about the mean: without the bias"
    if len(unknown) < 6:
        spread = "about the truth: the bias is in it"
        spread += f", but of {', '.join(unknown)}, whose truth is not known" if unknown else ""
    return "; ".join([*parts, spread]) + "."


def write_locator_yaml(
    path: Union[str, Path],
    corner: Optional[CornerNoise] = None,
    covariance: Optional[ConstantCovariance] = None,
) -> None:
    """Writes corner_sigma, constant_covariance, or both, for the private parameters of the locator.

    A constant_covariance that is loaded replaces what the measurement says of itself: those who do not want
    that leave it out, or in a file of its own.

    :raises OSError: the file cannot be written; an old one stays as it was
    :raises ValueError: neither is given, or the locator would not take it
    """
    if corner is None and covariance is None:
        raise ValueError("there is neither corner noise nor a covariance to write")
    _require_accepted(corner, covariance)
    lines: List[str] = []
    if corner is not None:
        lines += [*_comment(corner.measured), f"corner_sigma: {_real(corner.sigma)}  # px"]
    if covariance is not None:
        lines += [*_comment(covariance.measured), *_comment(_sigmas(covariance.matrix))]
        lines += ["constant_covariance:  # row by row, order x y z roll pitch yaw, m and rad"]
        rows = [", ".join(map(_real, row)) for row in covariance.matrix]
        lines += ["  [" + ",\n   ".join(rows) + "]"]
    with atomic_file(path) as file:
        file.write("\n".join(lines) + "\n")


def _require_accepted(corner: Optional[CornerNoise], covariance: Optional[ConstantCovariance]) -> None:
    params = sextant.LocatorParams()
    if corner is not None:
        params.corner_sigma = float(corner.sigma)
    if covariance is not None:
        params.constant_covariance = [float(value) for value in np.ravel(covariance.matrix)]
    params.validate()


def _real(value: float) -> str:
    """Exact, and always with a point: YAML 1.1 takes 1e-05 for a text."""
    text = repr(float(value))
    return text if "." in text else text.replace("e", ".0e")


def _sigmas(matrix: np.ndarray) -> str:
    sigmas = np.sqrt(np.diag(matrix))
    return "Sigmas: " + ", ".join(f"{a} {s:.4g} {u}" for a, s, u in zip(AXES, sigmas, UNITS)) + "."


def _comment(text: str) -> List[str]:
    text = "".join(each if each.isprintable() else " " for each in text)  # YAML refuses control characters
    return textwrap.wrap(text, 100, initial_indent="# ", subsequent_indent="# ")
