# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Observations of markers in photos, with measured distances."""

from dataclasses import dataclass
from typing import List, Optional, Sequence

import numpy as np

import sextant


@dataclass(frozen=True)
class Observation:
    """A rigid object in a photo: one marker, or the markers of a board."""

    photo: str  # path
    T_object_marker: np.ndarray  # (m, 4, 4), of m markers
    sizes: np.ndarray  # (m,) edge lengths, metres
    corners: np.ndarray  # (m, 4, 2) pixels
    sigmas: np.ndarray  # (m, 4) standard deviation of a corner coordinate, pixels
    distance: Optional[float] = None  # from the lens straight to the object's origin, metres; None: unknown

    @property
    def points(self) -> np.ndarray:
        """Corners in the object frame, metres, of shape (4 * m, 3)."""
        quads = [
            sextant.marker_corners(size) @ T[:3, :3].T + T[:3, 3]
            for T, size in zip(self.T_object_marker, self.sizes)
        ]
        return np.concatenate(quads)


def marker_observations(
    photo: str,
    detections: Sequence["sextant.Detection"],
    size: float,
    distance: Optional[float],
    measured_id: Optional[int],
    corner_sigma: float,
) -> List[Observation]:
    """Returns an observation for every marker of a photo.

    :param distance: from the lens straight to the centre of one marker, metres; None: not measured
    :param measured_id: id of that marker; None: the only one
    :param corner_sigma: standard deviation of corner coordinates besides each corner's own, pixels
    :raises ValueError: there is a distance, but measured_id is missing although there are several markers, or
        two of them have it
    """
    measured = None if distance is None else _measured(photo, detections, measured_id)
    return [
        Observation(
            photo,
            np.eye(4)[None],
            np.array([size]),
            np.array(each.corners)[None],
            _sigmas(each, corner_sigma)[None],
            distance if each.id == measured else None,
        )
        for each in detections
    ]


def _measured(
    photo: str, detections: Sequence["sextant.Detection"], measured_id: Optional[int]
) -> Optional[int]:
    """Returns the id of the marker whose distance was measured."""
    ids = [each.id for each in detections]
    if measured_id is None and len(ids) > 1:
        raise ValueError(f"{photo}: shows the markers {sorted(ids)}: set the id of the measured one")
    measured = measured_id if measured_id is not None or not ids else ids[0]
    if ids.count(measured) > 1:
        raise ValueError(f"{photo}: shows marker {measured} more than once")
    return measured


def board_observation(
    photo: str,
    detections: Sequence["sextant.Detection"],
    board: "sextant.MarkerMap",
    distance: Optional[float],
    corner_sigma: float,
) -> List[Observation]:
    """Returns one observation of the board's markers in a photo; empty if there are none.

    :param distance: from the lens straight to the origin of the board, metres; None: not measured
    :param corner_sigma: standard deviation of corner coordinates besides each corner's own, pixels
    :raises ValueError: a marker of the board is in the photo more than once
    """
    seen = [(each, board.find(each.family, each.id)) for each in detections]
    found = [(detection, marker) for detection, marker in seen if marker is not None]
    if len({marker.name for _, marker in found}) < len(found):
        raise ValueError(f"{photo}: shows a marker of the board more than once")
    if not found:
        return []
    rows = [
        (marker.T_map_marker, marker.size, detection.corners, _sigmas(detection, corner_sigma))
        for detection, marker in found
    ]
    return [Observation(photo, *map(np.array, zip(*rows)), distance)]


def _sigmas(detection: "sextant.Detection", corner_sigma: float) -> np.ndarray:
    """Adds corner_sigma and each corner's own sigma (-1: unknown) in quadrature, as the locator does."""
    return np.hypot(corner_sigma, np.maximum(detection.corner_sigmas, 0.0))
