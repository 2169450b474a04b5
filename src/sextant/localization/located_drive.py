# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where a robot was on a recorded drive: what the locator node would have said."""

from collections import Counter
from dataclasses import dataclass
from typing import Dict

import numpy as np

import sextant
from sextant.localization.drive_sightings import DriveSightings
from sextant.localization.recorded_instants import recorded_instants


@dataclass(frozen=True)
class LocatedDrive:
    """Poses of the base in the map, in order of time."""

    stamps: np.ndarray  # (N,) int64, nanoseconds
    poses: np.ndarray  # (N, 4, 4) T_map_base, metres
    covariances: np.ndarray  # (N, 6, 6) order of PoseWithCovariance, m and rad
    without: Dict[str, int]  # how many instants with markers have no pose, by reason


def locate_drive(
    drive: DriveSightings, marker_map: "sextant.MarkerMap", params: "sextant.LocalizationParams"
) -> LocatedDrive:
    """Locates instant by instant, as the node does; begins without any memory.

    :raises ValueError: as sextant.LocalizationParams.validate()
    """
    localization = sextant.MarkerLocalization(params)
    recorded = recorded_instants([drive])
    stamps, poses, covariances, without = [], [], [], Counter()
    for stamp, instant in zip(recorded.stamps, recorded.instants):
        if not instant.views:
            continue
        result = localization.locate(marker_map, instant.views, instant.T_odom_base)
        if result.pose is None:
            without[result.reason] += 1
            continue
        stamps.append(stamp)
        poses.append(result.pose.T_map_base)
        covariances.append(result.pose.covariance)
    return LocatedDrive(
        np.array(stamps, dtype=np.int64),
        np.array(poses).reshape(-1, 4, 4),
        np.array(covariances).reshape(-1, 6, 6),
        dict(without),
    )
