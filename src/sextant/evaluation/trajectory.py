# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A trajectory: a dictionary from the stamp of an image in nanoseconds to T_map_base, (4, 4), metres."""

from typing import Dict, List, Sequence

import numpy as np

Trajectory = Dict[int, np.ndarray]


def seconds_text(stamp: int) -> str:
    """Formats nanoseconds as seconds. A double has only 15 digits, a stamp 19."""
    return f"{stamp // 10**9}.{stamp % 10**9:09d}"


def common_stamps(truth: Trajectory, estimate: Trajectory) -> List[int]:
    """Returns the stamps that are in both, ascending."""
    return sorted(set(truth) & set(estimate))


def finite_poses(trajectory: Trajectory, stamps: Sequence[int]) -> np.ndarray:
    """Returns the poses (N, 4, 4) at stamps of the trajectory.

    :raises ValueError: a pose is not finite
    """
    poses = np.array([trajectory[stamp] for stamp in stamps], dtype=float).reshape(-1, 4, 4)
    for wrong in np.flatnonzero(~np.isfinite(poses).all(axis=(1, 2))):
        raise ValueError(f"the pose at {stamps[wrong]} ns is not finite")
    return poses
