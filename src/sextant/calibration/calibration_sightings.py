# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Markers in a photo and the distance that was measured to them."""

from dataclasses import dataclass
from typing import List, Optional, Sequence

import numpy as np

import sextant


@dataclass(frozen=True)
class Sighting:
    """What must fit one pose: a marker in a photo, or the markers of one board."""

    photo: str
    T_object_marker: np.ndarray  # (m, 4, 4), metres
    sizes: np.ndarray  # (m,), metres
    corners: np.ndarray  # (m, 4, 2), pixels
    sigmas: np.ndarray  # (m, 4), noise of a corner's coordinates, pixels
    distance: Optional[float] = None  # metres, straight from the lens to the object's origin

    @property
    def points(self) -> np.ndarray:
        """Corners (4 m, 3) in the object's frame, metres."""
        quads = [
            sextant.marker_corners(size) @ T[:3, :3].T + T[:3, 3]
            for T, size in zip(self.T_object_marker, self.sizes)
        ]
        return np.concatenate(quads)


def sightings_of(
    photo: str,
    detections: Sequence["sextant.Detection"],
    size: float,
    distance: Optional[float],
    measured_id: Optional[int],
    corner_sigma: float,
) -> List[Sighting]:
    """Every marker of a photo by itself.

    :param distance: metres, straight from the lens to the middle of one marker; None: not measured
    :param measured_id: id of that marker; None: the only one
    :raises ValueError: several markers, and it is not told which was measured
    """
    measured = None if distance is None else _measured(photo, detections, measured_id)
    return [
        Sighting(
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
    """Id of the marker that was measured."""
    ids = [each.id for each in detections]
    if measured_id is None and len(ids) > 1:
        raise ValueError(f"{photo}: shows the markers {sorted(ids)}: tell the id of the measured one")
    measured = measured_id if measured_id is not None or not ids else ids[0]
    if ids.count(measured) > 1:
        raise ValueError(f"{photo}: shows marker {measured} more than once")
    return measured


def board_sighting(
    photo: str,
    detections: Sequence["sextant.Detection"],
    board: "sextant.MarkerMap",
    distance: Optional[float],
    corner_sigma: float,
) -> List[Sighting]:
    """The markers of a photo that are in a map, as one rigid board; none where there are none.

    :param distance: metres, straight from the lens to the origin of the map; None: not measured
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
    return [Sighting(photo, *map(np.array, zip(*rows)), distance)]


def _sigmas(detection: "sextant.Detection", corner_sigma: float) -> np.ndarray:
    """As the locator: what all corners have in common, and what each tells of itself (-1: nothing)."""
    return np.hypot(corner_sigma, np.maximum(detection.corner_sigmas, 0.0))
