# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses and random drives, as trajectories."""

import numpy as np
from scipy.spatial.transform import Rotation

SECOND = 10**9


def pose(x=0.0, y=0.0, z=0.0, rotvec=(0.0, 0.0, 0.0)):
    T = np.eye(4)
    T[:3, :3] = Rotation.from_rotvec(rotvec).as_matrix()
    T[:3, 3] = x, y, z
    return T


def random_drive(random, count, step=SECOND // 10):
    position = np.cumsum(random.normal(0.0, 0.1, (count, 3)), axis=0)
    rotvec = np.cumsum(random.normal(0.0, 0.1, (count, 3)), axis=0)
    return {i * step: pose(*position[i], rotvec=rotvec[i]) for i in range(count)}
