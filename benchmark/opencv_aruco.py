# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""OpenCV's own ArUco functions, for comparison; their names changed in OpenCV 4.7."""

from typing import Callable, Dict

import cv2
import numpy as np


def opencv_detector(family: str) -> Callable[[np.ndarray], Dict[int, np.ndarray]]:
    """Returns a function that finds the corners (4, 2) of each id in an image, with OpenCV's defaults.

    :param family: name of a dictionary, such as DICT_4X4_50
    """
    dictionary = _dictionary(family)
    if hasattr(cv2.aruco, "ArucoDetector"):
        detect = cv2.aruco.ArucoDetector(dictionary).detectMarkers
    else:

        def detect(image):
            return cv2.aruco.detectMarkers(image, dictionary)

    def find(image: np.ndarray) -> Dict[int, np.ndarray]:
        corners, ids, _ = detect(image)
        known = [] if ids is None else ids.ravel().tolist()
        return {id: each.reshape(4, 2) for id, each in zip(known, corners)}

    return find


def opencv_marker(family: str, id: int, side: int) -> np.ndarray:
    """Returns the image of a marker with its black border, uint8 (side, side)."""
    draw = getattr(cv2.aruco, "generateImageMarker", None) or cv2.aruco.drawMarker
    return draw(_dictionary(family), id, side)


def _dictionary(family: str):
    return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, family))
