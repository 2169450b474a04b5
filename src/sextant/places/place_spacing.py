# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Distances between the places of a map."""

import numpy as np
from scipy.spatial import cKDTree

NEIGHBOURS = 10.0  # spacings within which photos may show the same place
MAX_SHARE = 0.24  # of the map's extent within which they may: in a map of a few spots each is another place


def spacing_of(positions: np.ndarray) -> float:
    """Median distance between neighbouring places (n, 2); 1 if there are no two distinct positions."""
    if len(positions) < 2:
        return 1.0
    nearest = cKDTree(positions).query(positions, 2)[0][:, 1]
    distinct = nearest[nearest > 0]
    return float(np.median(distinct)) if len(distinct) else 1.0


def neighbour_radius(positions: np.ndarray, spacings: float = NEIGHBOURS) -> float:
    """Distance within which places (n, 2) are neighbours: some spacings, but within MAX_SHARE."""
    extent = np.linalg.norm(np.ptp(positions, axis=0)) if len(positions) else 0.0
    return float(min(spacings * spacing_of(np.unique(positions, axis=0)), MAX_SHARE * extent))
