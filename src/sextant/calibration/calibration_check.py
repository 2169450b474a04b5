# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks whether a calibration is still valid, from photos of markers at measured distances.

Photos and distances are fitted twice: with the given calibration, and with free lens parameters
(calibration_fit.py). The difference is the calibration's error; its uncertainty shows whether the photos
suffice for a decision.
"""

from dataclasses import dataclass, replace
from typing import Dict, List, Sequence

import numpy as np

import sextant
from sextant.base.strict_params import StrictParams, above_zero, param
from sextant.calibration.calibration_fit import (
    CENTRE_X,
    CENTRE_Y,
    EDGE,
    FOCAL,
    CalibrationFit,
    FitSigmas,
    fit_calibration,
    project,
)
from sextant.calibration.calibration_observations import Observation

GOOD, NOT_GOOD, UNKNOWN = 0, 1, 2  # exit codes of the command
CERTAIN = 2.0  # confidence limit, standard deviations
NEAR_CORNER = 0.65  # distance from the image centre, half diagonals
_NOISY = 4.0  # corner noise over corner_sigma, above which the lens model cannot describe the photos
_WRONG_READING = 3.0  # error of a tape reading, standard deviations
_RINGS = {"centre": (0.0, 0.4), "middle": (0.4, 0.7), "edge": (0.7, np.inf)}  # radii, half diagonals


@dataclass(frozen=True)
class CheckParams(StrictParams):
    """Uncertainty of the measurements, and tolerances of the calibration."""

    tape_sigma: float = param(0.005, "standard deviation of a measured distance", above_zero(1.0), "m")
    size_sigma: float = param(0.0003, "standard deviation of a marker's edge length", above_zero(1.0), "m")
    zero_sigma: float = param(
        0.05,
        "standard deviation of the distance from the tape's zero to the projection centre",
        above_zero(1.0),
        "m",
    )
    corner_sigma: float = param(0.2, "standard deviation of corners in a sharp photo", above_zero(10.0), "px")
    focal_tolerance: float = param(
        0.0125, "tolerance of the focal length, as a fraction of it", above_zero(1.0)
    )
    centre_tolerance: float = param(
        0.0125, "tolerance of the principal point, as a fraction of the image width", above_zero(1.0)
    )
    edge_tolerance: float = param(
        0.01, "tolerance in the image corner, as a fraction of the image width", above_zero(1.0)
    )


@dataclass(frozen=True)
class LensDeviation:
    """Error of one lens parameter."""

    name: str  # of the parameter
    unit: str  # of the following fields
    error: float  # calibration minus truth
    sigma: float  # standard deviation of the error
    tolerance: float  # maximum of a good calibration

    @property
    def state(self) -> int:
        """NOT_GOOD if the error is significant, UNKNOWN if it could exceed the tolerance, else GOOD."""
        if abs(self.error) > max(self.tolerance, CERTAIN * self.sigma):
            return NOT_GOOD
        return UNKNOWN if CERTAIN * self.sigma > self.tolerance else GOOD


@dataclass(frozen=True)
class DistanceComparison:
    """Measured and estimated distance of all photos with one tape reading."""

    measured: float  # by tape, metres
    estimated: float  # mean with the given calibration, metres
    photos: int  # number of photos


@dataclass(frozen=True)
class Ring:
    """Corners at similar distance from the image centre, with the given calibration."""

    name: str  # key of _RINGS
    residual: float  # RMS reprojection error, pixels
    noise: float  # expected from noise alone, pixels
    corners: int  # number of corners


@dataclass(frozen=True)
class CalibrationCheck:
    """Result of a check."""

    state: int  # GOOD, NOT_GOOD or UNKNOWN
    reasons: List[str]  # sentences, at least one
    deviations: List[LensDeviation]  # one per lens parameter
    distances: List[DistanceComparison]  # by ascending distance
    rings: List[Ring]  # from the image centre outwards
    fit: CalibrationFit  # of the lens to the photos


def check_calibration(
    calibration: "sextant.CameraCalibration", observations: Sequence[Observation], params: CheckParams
) -> CalibrationCheck:
    """Checks a calibration.

    :raises ValueError: no observations, or one that no pose explains
    """
    if not observations:
        raise ValueError("no photo shows a marker")
    sigmas = FitSigmas(params.tape_sigma, params.zero_sigma, params.size_sigma)
    fit = fit_calibration(calibration, observations, sigmas)
    deviations = _deviations(calibration, fit, params)
    outliers, missing = _outliers(fit, params), _missing(calibration, observations, deviations)
    state = _state(deviations, outliers, missing)
    reasons = {
        GOOD: ["the calibration is still good"],
        NOT_GOOD: [_words(each) for each in deviations if each.state == NOT_GOOD],
        UNKNOWN: [*outliers, *missing],
    }[state]
    untaped = [replace(each, distance=None) for each in observations]
    as_it_is = fit_calibration(calibration, untaped, replace(sigmas, lens=1e-9))
    distances = _compare_distances(observations, as_it_is)
    rings = _rings(calibration, observations, as_it_is, min(1.0, fit.noise_scale))
    return CalibrationCheck(state, reasons, deviations, distances, rings, fit)


def _deviations(
    calibration: "sextant.CameraCalibration", fit: CalibrationFit, params: CheckParams
) -> List[LensDeviation]:
    width, sigmas = calibration.width, np.sqrt(np.diag(fit.covariance))
    rows = [
        ("focal length", "%", FOCAL, 100.0, params.focal_tolerance * 100.0),
        ("principal point x", "px", CENTRE_X, 1.0, params.centre_tolerance * width),
        ("principal point y", "px", CENTRE_Y, 1.0, params.centre_tolerance * width),
        ("distortion in the corner", "px", EDGE, 1.0, params.edge_tolerance * width),
    ]
    return [
        LensDeviation(name, unit, -scale * fit.error[i], scale * sigmas[i], tolerance)
        for name, unit, i, scale, tolerance in rows
    ]


def _words(deviation: LensDeviation) -> str:
    error, sigma = f"{abs(deviation.error):.1f}", f"{deviation.sigma:.1f}"
    if deviation.unit == "%":
        sign = "long" if deviation.error > 0 else "short"
        return f"the focal length is {error} % +- {sigma} % too {sign} (or the markers have another size)"
    if deviation.name.startswith("principal"):
        return f"the {deviation.name} is off by {deviation.error:+.1f} +- {sigma} pixels"
    return f"the distortion does not fit at the edges: off by {error} +- {sigma} pixels in the image corner"


def _outliers(fit: CalibrationFit, params: CheckParams) -> List[str]:
    """Returns errors that no lens explains."""
    found = [
        f"the distance {reading:g} m contradicts the others: measure again"
        for reading, error in fit.tape_errors.items()
        if abs(error) > _WRONG_READING
    ]
    if fit.noise_scale > _NOISY:
        pixels = fit.noise_scale * params.corner_sigma
        found.append(
            f"the corners are off by {pixels:.1f} pixels whatever the lens: blurred photos, a bent print,"
            " a map that is not this board, or a lens that this model cannot describe"
        )
    return found


def _missing(
    calibration: "sextant.CameraCalibration",
    observations: Sequence[Observation],
    deviations: Sequence[LensDeviation],
) -> List[str]:
    """Returns which further photos are needed for a decision."""
    focal, *centre, edge = deviations
    missing = _missing_distances(observations) if focal.state == UNKNOWN else []
    bare = _bare_corners(calibration, observations)
    if bare:
        missing.append(f"no marker near the image corner: {', '.join(bare)}")
    elif UNKNOWN in (each.state for each in (*centre, edge)):
        missing.append(
            "too few markers near the image corners: take more photos there, tilted by 20 to 40 degrees"
        )
    return missing


def _missing_distances(observations: Sequence[Observation]) -> List[str]:
    measured = {each.distance for each in observations if each.distance is not None}
    far = "the farthest at least twice the nearest"
    if len(measured) < 3:
        return [f"three measured distances are needed, {far}, not {len(measured)}"]
    if max(measured) < 2.0 * min(measured):
        return [f"the distances are too close together: {far}"]
    return ["the focal length is too uncertain: take more photos, farther apart, with a more exact tape"]


def _bare_corners(calibration: "sextant.CameraCalibration", observations: Sequence[Observation]) -> List[str]:
    xy = np.concatenate([each.corners.reshape(-1, 2) for each in observations])
    offset, radius = _from_middle(calibration, xy)
    names = {"upper left": (-1, -1), "upper right": (1, -1), "lower left": (-1, 1), "lower right": (1, 1)}
    return [
        name
        for name, signs in names.items()
        if not np.any((radius >= NEAR_CORNER) & np.all(offset * signs > 0, axis=1))
    ]


def _from_middle(calibration: "sextant.CameraCalibration", pixels: np.ndarray):
    """Returns offsets (n, 2) from the image centre in pixels and distances (n,) in half diagonals."""
    size = np.array([calibration.width, calibration.height])
    offset = pixels - 0.5 * (size - 1)
    return offset, np.linalg.norm(offset, axis=1) / (0.5 * np.linalg.norm(size))


def _state(deviations: Sequence[LensDeviation], outliers: Sequence[str], missing: Sequence[str]) -> int:
    """A wrong tape reading affects the focal length only."""
    trusted = deviations[1:] if outliers else deviations
    if any(each.state == NOT_GOOD for each in trusted):
        return NOT_GOOD
    return UNKNOWN if outliers or missing else GOOD


def _compare_distances(observations: Sequence[Observation], fit: CalibrationFit) -> List[DistanceComparison]:
    estimated: Dict[float, List[float]] = {}
    for observation, T in zip(observations, fit.poses):
        if observation.distance is not None:
            estimated.setdefault(observation.distance, []).append(float(np.linalg.norm(T[:3, 3])))
    rows = sorted(estimated.items())
    return [DistanceComparison(measured, float(np.mean(each)), len(each)) for measured, each in rows]


def _rings(
    calibration, observations: Sequence[Observation], as_it_is: CalibrationFit, noise_scale: float
) -> List[Ring]:
    camera = sextant.CameraModel(calibration)
    squares, noise, radii = [], [], []
    for observation, T in zip(observations, as_it_is.poses):
        pixels = observation.corners.reshape(-1, 2)
        residuals = project(camera, observation.points @ T[:3, :3].T + T[:3, 3]) - pixels
        squares.append(np.mean(residuals**2, axis=1))
        left = 1.0 - 6.0 / residuals.size  # a pose has six degrees of freedom
        noise.append(left * (noise_scale * observation.sigmas.ravel()) ** 2)
        radii.append(_from_middle(calibration, pixels)[1])
    squares, noise, radii = map(np.concatenate, (squares, noise, radii))
    rings = []
    for name, (low, high) in _RINGS.items():
        inside = (radii >= low) & (radii < high)
        if np.any(inside):
            rms = [float(np.sqrt(np.mean(each[inside]))) for each in (squares, noise)]
            rings.append(Ring(name, *rms, int(np.sum(inside))))
    return rings
