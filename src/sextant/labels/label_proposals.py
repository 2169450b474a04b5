# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Labels that a detector proposes, to be corrected by a person."""

from pathlib import Path
from typing import List, Sequence, Tuple

import numpy as np
from tqdm import tqdm

from sextant.images.photo_file import read_rgb
from sextant.labels.labelled_photos import LabelledPhotos, labelled_photo
from sextant.objects.detections import Detector


def proposed_labels(
    paths: Sequence[Path], detector: Detector, progress: str = ""
) -> Tuple[LabelledPhotos, List[np.ndarray]]:
    """The objects that a detector finds in photos, and their scores.

    :param progress: title of the progress bar; empty: none
    :raises OSError, ValueError: a photo cannot be read
    """
    photos, scores = [], []
    for path in tqdm(paths, disable=None if progress else True, desc=progress):
        image = read_rgb(path)
        found = detector.detect(image)
        size = image.shape[1], image.shape[0]
        whole = np.all(found.boxes[:, 2:] > found.boxes[:, :2], axis=1)
        photos.append(labelled_photo(path, size, found.boxes[whole], found.classes[whole]))
        scores.append(found.scores[whole])
    return LabelledPhotos(tuple(detector.classes), tuple(photos)), scores
