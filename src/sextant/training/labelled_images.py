# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Images of labelled photos for training, and sets of images joined."""

from functools import partial
from typing import List, Sequence

import numpy as np

from sextant.base.jobs import run_jobs
from sextant.detection_scores.average_precision import TrueObjects
from sextant.images.photo_file import read_rgb
from sextant.labels.labelled_photos import LabelledPhoto, LabelledPhotos
from sextant.training.image_set import ImageSet, ObjectImage, letterboxed_image, stacked_images


def labelled_image_set(photos: LabelledPhotos, size: int, jobs: int, progress: str = "") -> ImageSet:
    """Reads and letterboxes labelled photos.

    :param size: side of the network's input, pixels
    :param jobs: number of parallel processes
    :param progress: title of the progress bar, as in run_jobs()
    :raises JobError: a photo cannot be read
    """
    names = [str(photo.path) for photo in photos.photos]
    read = run_jobs(partial(_letterboxed, size=size), photos.photos, jobs, names=names, progress=progress)
    return stacked_images(list(read))


def _letterboxed(photo: LabelledPhoto, size: int) -> ObjectImage:
    truth = TrueObjects(photo.boxes, photo.classes, np.ones(len(photo.classes), bool))
    return letterboxed_image(ObjectImage(read_rgb(photo.path), truth), size)


def with_class_indices(images: ImageSet, names: Sequence[str], to: Sequence[str]) -> ImageSet:
    """Simulated images in a set of other classes; objects of classes that are not in it are left out.

    :param names: classes of the images. :param to: classes of the set
    """
    kept: List[ObjectImage] = []
    index = np.array([to.index(name) if name in to else -1 for name in names])
    for image, truth in zip(images.images, images.truths()):
        moved = index[truth.classes]
        there = moved >= 0
        kept.append(
            ObjectImage(image, TrueObjects(truth.boxes[there], moved[there], truth.is_counted[there]))
        )
    return stacked_images(kept)
