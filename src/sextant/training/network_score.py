# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Scores of a network during its training. Needs PyTorch."""

from typing import List

import torch

from sextant.detection_scores.average_precision import DetectorScore, detector_score
from sextant.detection_scores.detector_scores import MIN_SCORE
from sextant.objects.detections import Detections
from sextant.objects.non_maximum_suppression import non_maximum_suppression
from sextant.objects.yolo_detector import YoloParams
from sextant.objects.yolo_output import BINS, HeadLayout, decoded_heads
from sextant.training.image_set import ImageSet
from sextant.training.yolo_network import YoloNetwork

BATCH = 32  # images


def network_score(network: YoloNetwork, pictures: ImageSet, classes: int) -> DetectorScore:
    """Scores a network in evaluation mode, as detector_scores.scored() the exported one."""
    size, params = pictures.images.shape[1], YoloParams()
    found: List[Detections] = []
    for first in range(0, len(pictures.images), BATCH):
        images = torch.from_numpy(pictures.images[first : first + BATCH]).permute(0, 3, 1, 2).float() / 255.0
        with torch.no_grad():
            predicted = network(images.contiguous(memory_format=torch.channels_last)).numpy()
        for each in predicted:
            boxes = decoded_heads(each, (size, size), HeadLayout(BINS, classes), MIN_SCORE)
            found.append(
                non_maximum_suppression(boxes, params.max_overlap, params.class_agnostic, params.max_objects)
            )
    return detector_score(found, pictures.truths(), classes, params.confidence)
