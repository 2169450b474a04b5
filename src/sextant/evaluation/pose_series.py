# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses of a camera that stood still at a measured distance, and what they say of its accuracy.

Poses are T_reference_camera; the reference is usually the marker that the distance was measured from.
Rotations are roll, pitch, yaw about the fixed axes of the reference, R = Rz(yaw) Ry(pitch) Rx(roll), in
radians; where pitch is a right angle, roll and yaw cannot be told apart, and their numbers mean nothing.
"""

import re
from dataclasses import dataclass, field
from typing import List, Mapping, Optional, Sequence, Tuple

import numpy as np

import sextant

AXES = ("x", "y", "z", "roll", "pitch", "yaw")
UNITS = ("m", "m", "m", "rad", "rad", "rad")
SAME_DISTANCE = 6  # decimals: folders "1" and "1.0" are one distance
FARTHEST = {"m": 100.0, "rad": np.pi}
TURN = 2.0 * np.pi


@dataclass(frozen=True)
class BagCount:
    """How many poses of a bag are in a series, and how many were left out."""

    bag: str
    poses: int
    stale: int = 0  # stamped before the bag began: of another place
    invalid: int = 0  # not finite, or their rotation is none


@dataclass(frozen=True)
class PoseSeries:
    """Poses at one distance, of one bag or of several; N may be 0: nothing was seen from there."""

    distance: float  # true value of the axis that was measured, metres (radians for an angle)
    stamps: np.ndarray  # (N,) int64, nanoseconds
    bags: np.ndarray  # (N,) name of each pose's bag
    poses: np.ndarray  # (N, 6) x y z in metres, roll pitch yaw in radians
    covariances: np.ndarray  # (N, 6, 6) as published, order of PoseWithCovariance; NaN where there was none
    counts: Tuple[BagCount, ...] = ()  # of every bag, also of one without poses
    frame: str = ""  # the reference; empty: not told


@dataclass(frozen=True)
class Truths:
    """What is known of the true poses: one axis by the distance, the others here."""

    axis: str = "z"  # the one that distances are values of
    others: Mapping[str, Optional[float]] = field(default_factory=dict)  # 0 if not named, None: not known

    def at(self, distance: float) -> np.ndarray:
        """(6,) true pose in metres and radians, NaN where it is not known.

        :raises ValueError: an axis that there is not, the distance's own among the others, a value not finite
        """
        for axis in (self.axis, *self.others):
            if axis not in AXES:
                raise ValueError(f"'{axis}' is no axis, allowed are {', '.join(AXES)}")
        if self.axis in self.others:
            raise ValueError(f"the true {self.axis} is the distance, it cannot be given as well")
        values = {axis: self.others.get(axis, 0.0) for axis in AXES}
        values[self.axis] = distance
        for axis, value in values.items():
            if value is not None and not np.isfinite(value):
                raise ValueError(f"the true {axis} is {value}, not finite")
        return np.array([np.nan if values[axis] is None else values[axis] for axis in AXES])


@dataclass(frozen=True)
class SeriesStatistics:
    """Accuracy of a series, (6,) arrays in the order of AXES. NaN says that there is none: of one pose no
    deviation, of an unknown truth no bias and no RMSE.

    std and covariance divide by N - 1, rmse by N, so that rmse^2 = bias^2 + std^2 (N - 1) / N.
    """

    distance: float
    axis: str  # whose value the distance is
    count: int
    truth: np.ndarray
    mean: np.ndarray  # angles within half a turn of the truth, else of 0
    std: np.ndarray
    bias: np.ndarray  # mean - truth
    rmse: np.ndarray
    covariance: np.ndarray  # (6, 6) about the mean
    published: np.ndarray  # root of the mean variance that was published
    poses: np.ndarray  # (N, 6) the series', angles by whole turns moved next to their mean

    @property
    def label(self) -> str:
        """The distance in as many digits as it has, with its unit."""
        digits = f"{self.distance + 0.0:.{SAME_DISTANCE}f}".rstrip("0").rstrip(".")
        return f"{digits} {UNITS[AXES.index(self.axis)]}"


def distance_of_folder(name: str, axis: str = "z") -> float:
    """The true value that a folder is named by: metres, radians where the axis is an angle.

    Negative values are coordinates like others (an axis may be one along the wall).

    :raises ValueError: a name that is no plain number, or a value that no room has
    """
    if not re.fullmatch(r"[+-]?(\d+\.?\d*|\.\d+)", name, re.ASCII):
        raise ValueError(f"folder '{name}': its name is no distance, expected a number like 0.757")
    unit = UNITS[AXES.index(axis)]
    if abs(float(name)) > FARTHEST[unit]:
        raise ValueError(f"folder '{name}': more than {FARTHEST[unit]:.4g} {unit}; is it in {unit}?")
    return float(name)


def pose_series(
    distance: float,
    bag: str,
    stamps: Sequence[int],
    poses: np.ndarray,
    covariances: Optional[np.ndarray] = None,
    start: Optional[int] = None,
    frame: str = "",
) -> PoseSeries:
    """The series of one bag, without the poses that are none.

    :param stamps: (N,) nanoseconds
    :param poses: (N, 4, 4) T_reference_camera, or (N, 6) x y z roll pitch yaw
    :param covariances: (N, 6, 6) as published, or None; zeros say, as usual in ROS, that it is not known
    :param start: of the bag, nanoseconds: an earlier pose is left over from another place
    :param frame: that the poses are in
    :raises ValueError: shapes that do not fit
    """
    stamps = np.asarray(stamps, dtype=np.int64).reshape(-1)
    count = len(stamps)
    poses = np.asarray(poses, dtype=float)
    if poses.shape not in ((count, 4, 4), (count, 6)) and poses.size + count > 0:
        raise ValueError(f"poses are of the shape {poses.shape}, expected ({count}, 4, 4) or ({count}, 6)")
    fresh = np.full(count, True) if start is None else stamps >= start
    valid = fresh & np.array([_is_pose(pose) for pose in poses], dtype=bool)
    return PoseSeries(
        distance=float(distance),
        stamps=stamps[valid],
        bags=np.full(int(valid.sum()), bag, dtype=object),
        poses=np.array([_xyz_rpy(pose) for pose in poses[valid]]).reshape(-1, 6),
        covariances=_covariances(covariances, count)[valid],
        counts=(BagCount(bag, int(valid.sum()), int((~fresh).sum()), int((fresh & ~valid).sum())),),
        frame=frame,
    )


def _is_pose(pose: np.ndarray) -> bool:
    if not np.isfinite(pose).all():
        return False
    R = pose[:3, :3] if pose.ndim == 2 else np.eye(3)
    return bool(np.abs(R @ R.T - np.eye(3)).max() < 1e-3 and np.linalg.det(R) > 0.0)


def _xyz_rpy(pose: np.ndarray) -> np.ndarray:
    return pose if pose.ndim == 1 else np.concatenate([pose[:3, 3], sextant.rpy_from_rotation(pose[:3, :3])])


def _covariances(covariances: Optional[np.ndarray], count: int) -> np.ndarray:
    if covariances is None:
        return np.full((count, 6, 6), np.nan)
    covariances = np.array(covariances, dtype=float).reshape(-1, 6, 6)
    if len(covariances) != count:
        raise ValueError(f"{len(covariances)} covariances of {count} poses")
    known = np.isfinite(covariances).all(axis=(1, 2)) & covariances.any(axis=(1, 2))
    covariances[~known] = np.nan
    return covariances


def by_distance(series: Sequence[PoseSeries]) -> List[PoseSeries]:
    """One series a distance, ascending; the bags of a distance follow one another in their order.

    :raises ValueError: they are not all in one frame
    """
    frames = {each.frame: each.counts[0].bag for each in series if each.counts}
    if len(frames) > 1:
        told = ", ".join(f"'{frame}' in {bag}" for frame, bag in frames.items())
        raise ValueError(f"the poses are not all in one frame: {told}")
    at = [round(each.distance, SAME_DISTANCE) + 0.0 for each in series]  # + 0.0: there is no -0
    return [_joined(here, [s for s, d in zip(series, at) if d == here]) for here in sorted(set(at))]


def _joined(distance: float, series: Sequence[PoseSeries]) -> PoseSeries:
    arrays = ("stamps", "bags", "poses", "covariances")
    return PoseSeries(
        distance,
        **{name: np.concatenate([getattr(each, name) for each in series]) for name in arrays},
        counts=tuple(count for each in series for count in each.counts),
        frame=series[0].frame,
    )


def series_statistics(series: PoseSeries, truths: Truths) -> SeriesStatistics:
    """Mean, deviation, bias, RMSE and covariance of a series.

    :raises ValueError: as Truths.at()
    """
    truth = truths.at(series.distance)
    poses = _without_turns(series.poses, truth)
    count = len(poses)
    nothing = np.full(6, np.nan)
    mean = poses.mean(axis=0) if count else nothing
    covariance = np.cov(poses, rowvar=False) if count > 1 else np.full((6, 6), np.nan)
    bias = mean - truth
    mean_square = np.square(poses - truth).mean(axis=0) if count else nothing
    return SeriesStatistics(
        distance=series.distance,
        axis=truths.axis,
        count=count,
        truth=truth,
        mean=mean,
        std=np.sqrt(np.diag(covariance)),
        bias=bias,
        rmse=np.sqrt(mean_square),
        covariance=covariance,
        published=_root_mean_square(published_sigmas(series)),
        poses=poses,
    )


def _without_turns(poses: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Angles next to each other, then all of them moved by the same whole turns so that their mean is nearest
    to the truth."""
    poses = poses.copy()
    angles = poses[:, 3:]
    if len(angles):
        angles -= TURN * np.round((angles - _circular_mean(angles)) / TURN)
        angles -= TURN * np.round((angles.mean(axis=0) - np.nan_to_num(truth[3:])) / TURN)
    return poses


def _circular_mean(angles: np.ndarray) -> np.ndarray:
    """Of each column, Mardia and Jupp 2000, "Directional statistics", eq. 2.2.4."""
    return np.arctan2(np.sin(angles).mean(axis=0), np.cos(angles).mean(axis=0))


def published_sigmas(series: PoseSeries) -> np.ndarray:
    """(N, 6) standard deviations that were published, of the axes of the poses; NaN where there are none.

    Published rotations are about fixed axes, the poses' are roll, pitch and yaw: rotation_axes() at the mean
    leads from one to the other. Where its pitch is a right angle there are none.
    """
    if len(series.poses) == 0:
        return np.empty((0, 6))
    mean = _circular_mean(series.poses[:, 3:])
    turn = np.linalg.inv(rotation_axes(mean)) if abs(np.cos(mean[1])) > 1e-6 else np.full((3, 3), np.nan)
    position, rotation = series.covariances[:, :3, :3], turn @ series.covariances[:, 3:, 3:] @ turn.T
    variances = np.concatenate([np.diagonal(each, axis1=1, axis2=2) for each in (position, rotation)], axis=1)
    return np.sqrt(np.where(variances >= 0.0, variances, np.nan))


def rotation_axes(rpy: np.ndarray) -> np.ndarray:
    """(3, 3) J with delta = J d(roll, pitch, yaw) to first order, where R becomes Exp(delta) R: its columns
    are the axes that roll, pitch and yaw turn about, in the axes of the reference."""
    _, pitch, yaw = rpy
    after_roll = sextant.pose_from_xyz_rpy(np.zeros(3), [0.0, pitch, yaw])[:3, 0]
    return np.stack([after_roll, [-np.sin(yaw), np.cos(yaw), 0.0], [0.0, 0.0, 1.0]], axis=1)


def _root_mean_square(values: np.ndarray) -> np.ndarray:
    """(6,) over the rows of (N, 6) that are numbers, NaN without any."""
    known = ~np.isnan(values)
    squares = np.where(known, values, 0.0) ** 2
    return np.sqrt(squares.sum(axis=0) / np.where(known.any(axis=0), known.sum(axis=0), np.nan))
