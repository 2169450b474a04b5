# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whether a calibration is still good, judged by photos of markers at measured distances.

Photos and tape are explained twice: with the calibration as it is, and with a lens that may be another
(calibration_fit.py). What the second changes is the calibration's error, and how certain that is tells
whether the photos suffice for a judgement.
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
from sextant.calibration.calibration_sightings import Sighting

GOOD, NOT_GOOD, UNKNOWN = 0, 1, 2  # as the command ends
CERTAIN = 2.0  # standard deviations
NEAR_CORNER = 0.65  # of the way from the image's middle to its corner
_NOISY = 4.0  # corners so much noisier than corner_sigma are no marker seen through any lens of this model
_WRONG_READING = 3.0  # standard deviations of the tape
_RINGS = {"middle": (0.0, 0.4), "between": (0.4, 0.7), "edge": (0.7, np.inf)}  # of the half diagonal


@dataclass(frozen=True)
class CheckParams(StrictParams):
    """What was measured how exactly, and how far a calibration may be off."""

    tape_sigma: float = param(0.005, above_zero(1.0))  # metres
    size_sigma: float = param(0.0003, above_zero(1.0))  # metres, of a marker's edge
    zero_sigma: float = param(0.05, above_zero(1.0))  # metres from the tape's end to the centre of projection
    corner_sigma: float = param(0.2, above_zero(10.0))  # pixels, of corners in a sharp photo
    focal_tolerance: float = param(0.0125, above_zero(1.0))  # share of the focal length
    centre_tolerance: float = param(0.0125, above_zero(1.0))  # share of the image's width
    edge_tolerance: float = param(0.01, above_zero(1.0))  # share of the image's width, in its corner


@dataclass(frozen=True)
class LensDeviation:
    """One property of the lens: how far the calibration is off (itself minus the truth), in its unit."""

    name: str
    unit: str
    error: float
    sigma: float
    tolerance: float

    @property
    def state(self) -> int:
        """Not good beyond doubt, or unknown where the tolerance could be exceeded unseen."""
        if abs(self.error) > max(self.tolerance, CERTAIN * self.sigma):
            return NOT_GOOD
        return UNKNOWN if CERTAIN * self.sigma > self.tolerance else GOOD


@dataclass(frozen=True)
class SeenDistance:
    """All photos of one reading of the tape, as the calibration has them; metres."""

    told: float
    seen: float
    photos: int


@dataclass(frozen=True)
class Ring:
    """Corners at like distance from the image's middle, through the calibration as it is; pixels."""

    name: str
    residual: float  # RMS
    noise: float  # what it would be of noise alone
    corners: int


@dataclass(frozen=True)
class CalibrationCheck:
    """The judgement, and what it was made from."""

    state: int  # GOOD, NOT_GOOD or UNKNOWN
    reasons: List[str]  # in words, at least one
    deviations: List[LensDeviation]
    distances: List[SeenDistance]
    rings: List[Ring]
    fit: CalibrationFit


def check_calibration(
    calibration: "sextant.CameraCalibration", sightings: Sequence[Sighting], params: CheckParams
) -> CalibrationCheck:
    """Judges a calibration by what was seen through its lens.

    :raises ValueError: params out of range, no sighting, or one that no pose explains
    """
    if not sightings:
        raise ValueError("no photo shows a marker")
    sigmas = FitSigmas(params.tape_sigma, params.zero_sigma, params.size_sigma)
    fit = fit_calibration(calibration, sightings, sigmas)
    deviations = _deviations(calibration, fit, params)
    blunders, missing = _blunders(fit, params), _missing(calibration, sightings, deviations)
    state = _state(deviations, blunders, missing)
    reasons = {
        GOOD: ["the calibration is still good"],
        NOT_GOOD: [_words(each) for each in deviations if each.state == NOT_GOOD],
        UNKNOWN: [*blunders, *missing],
    }[state]
    untaped = [replace(each, distance=None) for each in sightings]
    as_it_is = fit_calibration(calibration, untaped, replace(sigmas, lens=1e-9))
    distances = _seen_distances(sightings, as_it_is)
    rings = _rings(calibration, sightings, as_it_is, min(1.0, fit.noise_scale))
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
        way = "long" if deviation.error > 0 else "short"
        return f"the focal length is {error} % +- {sigma} % too {way} (or the markers have another size)"
    if deviation.name.startswith("principal"):
        return f"the {deviation.name} is off by {deviation.error:+.1f} +- {sigma} pixels"
    return f"the distortion does not fit at the edges: off by {error} +- {sigma} pixels in the image's corner"


def _blunders(fit: CalibrationFit, params: CheckParams) -> List[str]:
    """What no lens explains."""
    found = [
        f"the distance {told:g} m contradicts the others: measure again"
        for told, error in fit.tape_errors.items()
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
    sightings: Sequence[Sighting],
    deviations: Sequence[LensDeviation],
) -> List[str]:
    """Which photos would tell what these do not."""
    focal, *centre, edge = deviations
    missing = _missing_distances(sightings) if focal.state == UNKNOWN else []
    bare = _bare_corners(calibration, sightings)
    if bare:
        missing.append(f"no marker near the image's corner: {', '.join(bare)}")
    elif UNKNOWN in (each.state for each in (*centre, edge)):
        missing.append(
            "too few markers toward the image's corners: more photos there, turned by 20 to 40 degrees"
        )
    return missing


def _missing_distances(sightings: Sequence[Sighting]) -> List[str]:
    told = {each.distance for each in sightings if each.distance is not None}
    far = "the farthest twice the nearest or more"
    if len(told) < 3:
        return [f"three measured distances are needed, {far}, not {len(told)}"]
    if max(told) < 2.0 * min(told):
        return [f"the distances are too close together: {far}"]
    return [
        "the distances tell too little of the focal length: more photos, farther apart, a more exact tape"
    ]


def _bare_corners(calibration: "sextant.CameraCalibration", sightings: Sequence[Sighting]) -> List[str]:
    xy = np.concatenate([each.corners.reshape(-1, 2) for each in sightings])
    offset, radius = _from_middle(calibration, xy)
    names = {"upper left": (-1, -1), "upper right": (1, -1), "lower left": (-1, 1), "lower right": (1, 1)}
    return [
        name
        for name, signs in names.items()
        if not np.any((radius >= NEAR_CORNER) & np.all(offset * signs > 0, axis=1))
    ]


def _from_middle(calibration: "sextant.CameraCalibration", pixels: np.ndarray):
    """Offsets (n, 2) from the image's middle in pixels, and distances (n,) in half diagonals."""
    size = np.array([calibration.width, calibration.height])
    offset = pixels - 0.5 * (size - 1)
    return offset, np.linalg.norm(offset, axis=1) / (0.5 * np.linalg.norm(size))


def _state(deviations: Sequence[LensDeviation], blunders: Sequence[str], missing: Sequence[str]) -> int:
    """A wrong reading of the tape makes a wrong focal length, but nothing else wrong."""
    believed = deviations[1:] if blunders else deviations
    if any(each.state == NOT_GOOD for each in believed):
        return NOT_GOOD
    return UNKNOWN if blunders or missing else GOOD


def _seen_distances(sightings: Sequence[Sighting], as_it_is: CalibrationFit) -> List[SeenDistance]:
    seen: Dict[float, List[float]] = {}
    for sighting, T in zip(sightings, as_it_is.poses):
        if sighting.distance is not None:
            seen.setdefault(sighting.distance, []).append(float(np.linalg.norm(T[:3, 3])))
    return [SeenDistance(told, float(np.mean(each)), len(each)) for told, each in sorted(seen.items())]


def _rings(
    calibration, sightings: Sequence[Sighting], as_it_is: CalibrationFit, noise_scale: float
) -> List[Ring]:
    camera = sextant.CameraModel(calibration)
    squares, noise, radii = [], [], []
    for sighting, T in zip(sightings, as_it_is.poses):
        pixels = sighting.corners.reshape(-1, 2)
        residuals = project(camera, sighting.points @ T[:3, :3].T + T[:3, 3]) - pixels
        squares.append(np.mean(residuals**2, axis=1))
        left = 1.0 - 6.0 / residuals.size  # a pose takes up six residuals
        noise.append(left * (noise_scale * sighting.sigmas.ravel()) ** 2)
        radii.append(_from_middle(calibration, pixels)[1])
    squares, noise, radii = map(np.concatenate, (squares, noise, radii))
    rings = []
    for name, (low, high) in _RINGS.items():
        inside = (radii >= low) & (radii < high)
        if np.any(inside):
            rms = [float(np.sqrt(np.mean(each[inside]))) for each in (squares, noise)]
            rings.append(Ring(name, *rms, int(np.sum(inside))))
    return rings
