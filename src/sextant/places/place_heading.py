# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Heading of a camera relative to that of the most similar photo, by the directions of their matches.

Far things, and the mean of near ones on both sides, turn by the angle between the cameras. The photo is
assumed to be of the same camera and size as the image.
"""

from typing import Optional

import numpy as np

import sextant
from sextant.places.place_matches import MatchedPhoto

# Fitted on walks along the simulated streets 5 and 6, usual and hard ones.
WINDOW = np.deg2rad(4.0)  # largest difference of a match's turn from that of the best match
MIN_MATCHES, MIN_SHARE = 15, 0.4  # number and share of matches within the window
DEVIATION = 0.09  # standard deviation of the turn, radians


def turn_to_left(match: MatchedPhoto, camera: "sextant.CameraModel") -> Optional[float]:
    """Angle of the image to the left of the photo, radians; None if too few matches agree.

    :param camera: of the image
    """
    turns = _bearings(camera, match.query_xy) - _bearings(camera, match.photo_xy)
    known = np.isfinite(turns)
    turns, weights = turns[known], match.weights[known]
    if len(turns) < MIN_MATCHES:
        return None
    is_near = np.abs(turns[:, np.newaxis] - turns) <= WINDOW
    agree = is_near[(is_near @ weights).argmax()]
    if agree.sum() < MIN_MATCHES or agree.mean() < MIN_SHARE:
        return None
    return float(np.average(turns[agree], weights=weights[agree]))


def _bearings(camera: "sextant.CameraModel", xy: np.ndarray) -> np.ndarray:
    """Angles (m,) to the right of the optical axis, radians; nan outside of the camera's model.

    :param xy: (m, 2) fractions of the image's longer side
    """
    return np.arctan(camera.rays(xy * max(camera.size))[:, 0])
