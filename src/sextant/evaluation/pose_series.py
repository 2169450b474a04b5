# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Series of poses of a static camera at a measured distance or a surveyed point, and their statistics.

Poses are T_reference_camera; the reference is usually the marker to which the distance was measured. At
surveyed points they are T_map_base, and the number of the point, from 1, takes the place of the distance.
Rotations are roll, pitch, yaw about the fixed axes of the reference, R = Rz(yaw) Ry(pitch) Rx(roll), in
radians. At a pitch of 90 degrees, roll and yaw are undefined (gimbal lock).
"""

import re
from dataclasses import dataclass, field
from typing import Dict, List, Mapping, Optional, Protocol, Sequence, Tuple

import numpy as np

import sextant

AXES = ("x", "y", "z", "roll", "pitch", "yaw")
UNITS = ("m", "m", "m", "rad", "rad", "rad")
POINT = "point"  # in place of the measured axis: the distances are numbers of surveyed points
UNIT_OF = {**dict(zip(AXES, UNITS)), POINT: ""}  # unit of the distances by axis
SAME_DISTANCE = 6  # decimals; folders "1" and "1.0" are one distance
MAX_DISTANCE = {"m": 100.0, "rad": np.pi}  # by unit
TURN = 2.0 * np.pi


@dataclass(frozen=True)
class BagCount:
    """Number of poses of a bag that are in a series, and that were left out."""

    bag: str  # path
    poses: int  # in the series
    stale: int = 0  # left out: stamped before the bag began
    invalid: int = 0  # left out: not finite, or not a rotation
    images: Optional[int] = None  # number of images, with and without a pose; None: unknown


@dataclass(frozen=True)
class PoseSeries:
    """Poses at one distance, of one or more bags; N may be 0."""

    distance: float  # true value of the measured axis, metres (radians for an angle); or number of the point
    stamps: np.ndarray  # (N,) int64, nanoseconds
    bags: np.ndarray  # (N,) name of each pose's bag
    poses: np.ndarray  # (N, 6) x y z in metres, roll pitch yaw in radians
    covariances: np.ndarray  # (N, 6, 6) published, order of PoseWithCovariance; NaN: none
    counts: Tuple[BagCount, ...] = ()  # of all bags, also of those without poses
    frame: str = ""  # reference frame; empty: unknown
    method: str = ""  # mode of the locator or topic, if several are compared


class TruePoses(Protocol):
    """True poses of series: GroundTruth or SurveyedPoints."""

    axis: str  # measured axis, or POINT

    def at(self, distance: float) -> np.ndarray:
        """Returns the true pose (6,) of a series, in metres and radians; NaN: unknown."""


@dataclass(frozen=True)
class GroundTruth:
    """True values of the six axes; the distance is the true value of one of them."""

    axis: str = "z"  # measured axis, whose values are the distances
    others: Mapping[str, Optional[float]] = field(default_factory=dict)  # default 0; None: unknown

    def at(self, distance: float) -> np.ndarray:
        """Returns the true pose (6,) at a distance, in metres and radians; NaN: unknown.

        :raises ValueError: an unknown axis, the measured axis among the others, or a value that is not finite
        """
        for axis in (self.axis, *self.others):
            if axis not in AXES:
                raise ValueError(f"'{axis}' is not an axis, allowed are {', '.join(AXES)}")
        if self.axis in self.others:
            raise ValueError(f"the true {self.axis} is the distance, it cannot be set as well")
        values = {axis: self.others.get(axis, 0.0) for axis in AXES}
        values[self.axis] = distance
        for axis, value in values.items():
            if value is not None and not np.isfinite(value):
                raise ValueError(f"the true {axis} is {value}, not finite")
        return np.array([np.nan if values[axis] is None else values[axis] for axis in AXES])


@dataclass(frozen=True)
class SeriesStatistics:
    """Accuracy of a series, (6,) arrays in the order of AXES. NaN: undefined (deviation of one pose, bias and
    RMSE without a true value).

    std and covariance are divided by N - 1, rmse by N: rmse^2 = bias^2 + std^2 (N - 1) / N.
    """

    distance: float  # metres, or radians for an angle; or number of the point
    axis: str  # measured axis, or POINT
    count: int  # number of poses
    truth: np.ndarray  # true values
    mean: np.ndarray  # angles within half a turn of the truth; of 0 if that is unknown
    std: np.ndarray  # standard deviations
    bias: np.ndarray  # mean - truth
    rmse: np.ndarray  # root mean square errors
    covariance: np.ndarray  # (6, 6) about the mean
    published: np.ndarray  # root of the mean published variance
    poses: np.ndarray  # (N, 6) of the series, angles unwrapped to their mean
    method: str = ""  # mode of the locator or topic, if several are compared
    images: Optional[int] = None  # number of images, with and without a pose; None: unknown

    @property
    def place(self) -> str:
        """The distance with its unit, without trailing zeros; or the number of the point."""
        digits = f"{self.distance + 0.0:.{SAME_DISTANCE}f}".rstrip("0").rstrip(".")
        return f"point {digits}" if self.axis == POINT else f"{digits} {UNIT_OF[self.axis]}"

    @property
    def label(self) -> str:
        """The method, if several are compared, and the place."""
        return f"{self.method} {self.place}".strip()


def distance_of_folder(name: str, axis: str = "z") -> float:
    """Parses the name of a folder: metres, or radians if the axis is an angle.

    Negative values are allowed, since the axis may be any coordinate.

    :raises ValueError: the name is not a plain number, or the value is out of range
    """
    if not re.fullmatch(r"[+-]?(\d+\.?\d*|\.\d+)", name, re.ASCII):
        raise ValueError(f"folder '{name}': its name is not a distance, expected a number like 0.757")
    unit = UNIT_OF[axis]
    if abs(float(name)) > MAX_DISTANCE[unit]:
        raise ValueError(f"folder '{name}': more than {MAX_DISTANCE[unit]:.4g} {unit}; is it in {unit}?")
    return float(name)


def pose_series(
    distance: float,
    bag: str,
    stamps: Sequence[int],
    poses: np.ndarray,
    covariances: Optional[np.ndarray] = None,
    start: Optional[int] = None,
    frame: str = "",
    images: Optional[int] = None,
) -> PoseSeries:
    """Builds the series of one bag, without invalid poses.

    :param distance: true value of the measured axis, metres or radians
    :param bag: name
    :param stamps: (N,) nanoseconds
    :param poses: (N, 4, 4) T_reference_camera, or (N, 6) x y z roll pitch yaw
    :param covariances: (N, 6, 6) published, or None; all zeros: unknown, by the convention of ROS
    :param start: of the bag, nanoseconds; earlier poses are stale
    :param frame: reference frame
    :param images: number of images, with and without a pose; None: unknown
    :raises ValueError: inconsistent shapes
    """
    stamps = np.asarray(stamps, dtype=np.int64).reshape(-1)
    count = len(stamps)
    poses = np.asarray(poses, dtype=float)
    if poses.shape not in ((count, 4, 4), (count, 6)) and poses.size + count > 0:
        raise ValueError(f"poses have the shape {poses.shape}, expected ({count}, 4, 4) or ({count}, 6)")
    fresh = np.full(count, True) if start is None else stamps >= start
    valid = fresh & np.array([_is_pose(pose) for pose in poses], dtype=bool)
    return PoseSeries(
        distance=float(distance),
        stamps=stamps[valid],
        bags=np.full(int(valid.sum()), bag, dtype=object),
        poses=np.array([_xyz_rpy(pose) for pose in poses[valid]]).reshape(-1, 6),
        covariances=_covariances(covariances, count)[valid],
        counts=(BagCount(bag, int(valid.sum()), int((~fresh).sum()), int((fresh & ~valid).sum()), images),),
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
    """Joins series of the same method and distance, keeping the order of methods and of bags; sorts by
    distance.

    :raises ValueError: they have different frames
    """
    frames = {each.frame: each.counts[0].bag for each in series if each.counts}
    if len(frames) > 1:
        listed = ", ".join(f"'{frame}' in {bag}" for frame, bag in frames.items())
        raise ValueError(f"the poses are not all in one frame: {listed}")
    groups: Dict[str, Dict[float, List[PoseSeries]]] = {}
    for each in series:
        distance = round(each.distance, SAME_DISTANCE) + 0.0  # + 0.0: turns -0.0 into 0.0
        groups.setdefault(each.method, {}).setdefault(distance, []).append(each)
    return [_joined(distance, of[distance]) for of in groups.values() for distance in sorted(of)]


def _joined(distance: float, series: Sequence[PoseSeries]) -> PoseSeries:
    arrays = ("stamps", "bags", "poses", "covariances")
    return PoseSeries(
        distance,
        **{name: np.concatenate([getattr(each, name) for each in series]) for name in arrays},
        counts=tuple(count for each in series for count in each.counts),
        frame=series[0].frame,
        method=series[0].method,
    )


def series_statistics(series: PoseSeries, ground_truth: TruePoses) -> SeriesStatistics:
    """Computes mean, deviation, bias, RMSE and covariance of a series.

    :raises ValueError: as GroundTruth.at()
    """
    truth = ground_truth.at(series.distance)
    poses = _without_turns(series.poses, truth)
    count = len(poses)
    nothing = np.full(6, np.nan)
    mean = poses.mean(axis=0) if count else nothing
    covariance = np.cov(poses, rowvar=False) if count > 1 else np.full((6, 6), np.nan)
    bias = mean - truth
    mean_square = np.square(poses - truth).mean(axis=0) if count else nothing
    return SeriesStatistics(
        distance=series.distance,
        axis=ground_truth.axis,
        count=count,
        truth=truth,
        mean=mean,
        std=np.sqrt(np.diag(covariance)),
        bias=bias,
        rmse=np.sqrt(mean_square),
        covariance=covariance,
        published=_root_mean_square(published_sigmas(series)),
        poses=poses,
        method=series.method,
        images=_images(series.counts),
    )


def _images(counts: Sequence[BagCount]) -> Optional[int]:
    known = [count.images for count in counts if count.images is not None]
    return sum(known) if known and len(known) == len(counts) else None


def _without_turns(poses: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Unwraps the angles around their mean, and moves the mean by whole turns closest to the truth."""
    poses = poses.copy()
    angles = poses[:, 3:]
    if len(angles):
        angles -= TURN * np.round((angles - _circular_mean(angles)) / TURN)
        angles -= TURN * np.round((angles.mean(axis=0) - np.nan_to_num(truth[3:])) / TURN)
    return poses


def _circular_mean(angles: np.ndarray) -> np.ndarray:
    """Returns the circular mean of each column (Mardia and Jupp 2000, "Directional statistics", 2.2.4)."""
    return np.arctan2(np.sin(angles).mean(axis=0), np.cos(angles).mean(axis=0))


def published_sigmas(series: PoseSeries) -> np.ndarray:
    """Returns the published standard deviations (N, 6) of x y z roll pitch yaw; NaN: none.

    Published rotations are about fixed axes; rotation_axes() at the mean converts them to roll, pitch and
    yaw. They are NaN in gimbal lock.
    """
    if len(series.poses) == 0:
        return np.empty((0, 6))
    mean = _circular_mean(series.poses[:, 3:])
    turn = np.linalg.inv(rotation_axes(mean)) if abs(np.cos(mean[1])) > 1e-6 else np.full((3, 3), np.nan)
    position, rotation = series.covariances[:, :3, :3], turn @ series.covariances[:, 3:, 3:] @ turn.T
    variances = np.concatenate([np.diagonal(each, axis1=1, axis2=2) for each in (position, rotation)], axis=1)
    return np.sqrt(np.where(variances >= 0.0, variances, np.nan))


def rotation_axes(rpy: np.ndarray) -> np.ndarray:
    """Returns the Jacobian J (3, 3) with delta = J d(roll, pitch, yaw) to first order, where R becomes
    Exp(delta) R. Its columns are the axes of roll, pitch and yaw in the reference frame."""
    _, pitch, yaw = rpy
    after_roll = sextant.pose_from_xyz_rpy(np.zeros(3), [0.0, pitch, yaw])[:3, 0]
    return np.stack([after_roll, [-np.sin(yaw), np.cos(yaw), 0.0], [0.0, 0.0, 1.0]], axis=1)


def _root_mean_square(values: np.ndarray) -> np.ndarray:
    """Returns (6,) over the rows of (N, 6), ignoring NaN; NaN without values."""
    known = ~np.isnan(values)
    squares = np.where(known, values, 0.0) ** 2
    return np.sqrt(squares.sum(axis=0) / np.where(known.any(axis=0), known.sum(axis=0), np.nan))
