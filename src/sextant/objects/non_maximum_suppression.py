# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Greedy non-maximum suppression of boxes."""

import cv2
import numpy as np

from sextant.objects.detections import NO_DETECTIONS, Detections


def non_maximum_suppression(
    found: Detections, max_overlap: float, class_agnostic: bool, max_objects: int
) -> Detections:
    """Remove boxes that overlap one with a higher score (greedy non-maximum suppression).

    :param max_overlap: intersection over union above which the lower score is removed
    :param class_agnostic: also between different classes. :param max_objects: that are kept
    """
    if not len(found.scores):
        return NO_DETECTIONS
    apart = 0.0 if class_agnostic else float(np.ptp(found.boxes)) + 1.0  # classes do not overlap then
    boxes = found.boxes + apart * found.classes[:, np.newaxis]
    sizes = np.hstack([boxes[:, :2], boxes[:, 2:] - boxes[:, :2]])
    kept = cv2.dnn.NMSBoxes(sizes.tolist(), found.scores.tolist(), 0.0, max_overlap)
    return found.of(np.ravel(kept).astype(int)[:max_objects])
