# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Localizes a robot on a recorded drive, as the node marker_locator does."""

from collections import Counter
from dataclasses import dataclass
from typing import Dict

import numpy as np

import sextant
from sextant.localization.drive_observations import DriveObservations
from sextant.localization.recorded_instants import count_instants, recorded_instants


@dataclass(frozen=True)
class LocatedDrive:
    """Poses of the base in the map, by ascending stamp."""

    stamps: np.ndarray  # (N,) int64, nanoseconds
    poses: np.ndarray  # (N, 4, 4) T_map_base, metres
    covariances: np.ndarray  # (N, 6, 6) order of PoseWithCovariance, m and rad
    failures: Dict[str, int]  # number of instants with markers but without a pose, by reason
    instants: int  # number of instants, with and without markers


def locate_drive(
    drive: DriveObservations, marker_map: "sextant.MarkerMap", params: "sextant.LocalizationParams"
) -> LocatedDrive:
    """Localizes the robot instant by instant, as the node does, without a prior.

    :raises ValueError: as sextant.LocalizationParams.validate()
    """
    localization = sextant.MarkerLocalization(params)
    recorded = recorded_instants([drive])
    stamps, poses, covariances, failures = [], [], [], Counter()
    for stamp, instant in zip(recorded.stamps, recorded.instants):
        if not instant.views:
            continue
        result = localization.locate(marker_map, instant.views, instant.T_odom_base, 1e-9 * stamp)
        if result.pose is None:
            failures[result.reason] += 1
            continue
        stamps.append(stamp)
        poses.append(result.pose.T_map_base)
        covariances.append(result.pose.covariance)
    return LocatedDrive(
        np.array(stamps, dtype=np.int64),
        np.array(poses).reshape(-1, 4, 4),
        np.array(covariances).reshape(-1, 6, 6),
        dict(failures),
        count_instants(drive),
    )
