# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Evaluation of a detector on labelled photos."""

import time
from dataclasses import dataclass
from typing import Callable, Dict, List, NamedTuple, Sequence, Tuple

import numpy as np
from tqdm import tqdm

from sextant.detection_scores.average_precision import (
    OVERLAPS,
    DetectorScore,
    TrueObjects,
    average_precisions,
    detector_score,
    matched_objects,
    mean_precision,
)
from sextant.geometry.registered_depth import depths_at
from sextant.images.photo_depth import read_photo_depth
from sextant.images.photo_file import read_rgb
from sextant.labels.labelled_photos import LabelledPhoto, LabelledPhotos
from sextant.objects.detections import Detections, Detector

BINS = np.linspace(0.0, 1.0, 11)  # of the scores in the reliability diagram
CONFIDENCES = np.round(np.arange(0.05, 0.96, 0.01), 2)  # that are compared
PARTS = 3  # of the photos or objects, by size, light or distance
NAMES = {"size": ("small", "middle", "large"), "light": ("dark", "middle", "bright"),
         "distance": ("near", "middle", "far")}  # fmt: skip


class Group(NamedTuple):
    """Objects of similar size or distance, or of photos with similar light."""

    name: str  # in words, with its limits
    objects: int  # number of objects
    recall: float  # fraction that is detected at the chosen confidence


@dataclass(frozen=True)
class Matched:
    """Detections of all photos, and the objects that they match (with their classes)."""

    scores: np.ndarray  # (n,) of the detections
    is_right: np.ndarray  # bool (n,) whether they match an object of their class
    photo: np.ndarray  # int (n,) index of the photo
    object_scores: np.ndarray  # (objects,) score of the detection that matches each object; 0: none
    object_photo: np.ndarray  # int (objects,) index of the photo

    def recall(self, confidence: float) -> float:
        """Fraction of the objects that are detected."""
        return float(np.mean(self.object_scores >= confidence)) if len(self.object_scores) else np.nan

    def precision(self, confidence: float) -> float:
        """Fraction of the detections that are right."""
        chosen = self.is_right[self.scores >= confidence]
        return float(chosen.mean()) if len(chosen) else np.nan

    def false_alarms(self, confidence: float, photos: int) -> float:
        """Number of wrong detections per photo."""
        return float(np.count_nonzero(~self.is_right & (self.scores >= confidence)) / photos)


@dataclass(frozen=True)
class ObjectEvaluation:
    """Figures of a detector."""

    name: str  # of the detector
    size: Tuple[int, int]  # width and height of its input, pixels
    classes: Tuple[str, ...]  # names
    score: DetectorScore  # AP50 of each class, and the confusion matrix at the confidence
    map_50_95: float  # mean average precision over OVERLAPS
    milliseconds: np.ndarray  # (photos,) time of each
    matched: Matched  # detections and objects
    groups: Dict[str, List[Group]]  # by size, light and, where there is depth, distance
    photos: int  # number of photos
    worst: List[int]  # indices of the photos with most mistakes, the worst first

    @property
    def confidence(self) -> float:
        """Minimum score of a detection."""
        return self.score.threshold

    def recommended(self, false_alarms: float) -> float:
        """Least of CONFIDENCES with at most so many false alarms per photo; NaN: none has so few."""
        fits = [each for each in CONFIDENCES if self.matched.false_alarms(each, self.photos) <= false_alarms]
        return float(min(fits)) if fits else np.nan

    def reliability(self) -> np.ndarray:
        """Mean score, fraction of right detections and their number (3, bins) in BINS; NaN: none."""
        which = np.clip(np.digitize(self.matched.scores, BINS) - 1, 0, len(BINS) - 2)
        count = np.bincount(which, minlength=len(BINS) - 1).astype(float)
        with np.errstate(invalid="ignore"):
            mean = np.bincount(which, self.matched.scores, len(BINS) - 1) / count
            right = np.bincount(which, self.matched.is_right, len(BINS) - 1) / count
        return np.array([mean, right, count])


def evaluate_objects(
    name: str,
    photos: LabelledPhotos,
    detector: Detector,
    size: Tuple[int, int],
    confidence: float,
    progress: str = "",
) -> ObjectEvaluation:
    """Runs a detector on labelled photos.

    :param detector: with a minimum score far below the confidence; its classes are those of the photos
    :param size: width and height of its input, pixels
    :param confidence: minimum score of a detection, for recall, precision and the confusion matrix
    :param progress: title of the progress bar; empty: none
    :raises OSError, ValueError: a photo cannot be read
    """
    found, lights, times, distances = [], [], [], []
    for photo in tqdm(photos.photos, disable=None if progress else True, desc=progress):
        image = read_rgb(photo.path)
        begin = time.perf_counter()
        found.append(detector.detect(image))
        times.append(1e3 * (time.perf_counter() - begin))
        lights.append(float(image.mean()))
        distances.append(_distances(photo))
    known = [
        TrueObjects(photo.boxes, photo.classes, np.ones(len(photo.classes), bool)) for photo in photos.photos
    ]
    count, matched = len(photos.classes), _matched(found, known)
    steps = [mean_precision(average_precisions(found, known, count, each)) for each in OVERLAPS]
    groups = _groups(photos, matched, confidence, np.array(lights), np.concatenate(distances or [[]]))
    return ObjectEvaluation(
        name, size, photos.classes, detector_score(found, known, count, confidence), float(np.mean(steps)),
        np.array(times), matched, groups, len(photos.photos), _worst(matched, confidence, len(photos.photos)),
    )  # fmt: skip


def _matched(found: Sequence[Detections], known: Sequence[TrueObjects]) -> Matched:
    scores, right, photo, of_objects, object_photo = [], [], [], [], []
    for number, (detections, objects) in enumerate(zip(found, known)):
        of_photo = np.zeros(len(objects.classes))
        is_right = np.zeros(len(detections.scores), bool)
        for each in np.unique(detections.classes):
            mine, theirs = (np.flatnonzero(part.classes == each) for part in (detections, objects))
            once = np.ones(len(theirs), bool)
            matches = matched_objects(detections.boxes[mine], objects.boxes[theirs], once)
            for detection, match in zip(mine, matches):
                if match >= 0:
                    is_right[detection] = True
                    of_photo[theirs[match]] = detections.scores[detection]
        scores.append(detections.scores), right.append(is_right), of_objects.append(of_photo)
        photo.append(np.full(len(is_right), number)), object_photo.append(np.full(len(of_photo), number))
    columns = (scores, right, photo, of_objects, object_photo)
    types = (float, bool, int, float, int)
    return Matched(*(np.concatenate([np.zeros(0), *each]).astype(kind) for each, kind in zip(columns, types)))


def _worst(matched: Matched, confidence: float, photos: int) -> List[int]:
    false = matched.photo[(matched.scores >= confidence) & ~matched.is_right]
    missed = matched.object_photo[matched.object_scores < confidence]
    mistakes = np.bincount(np.concatenate([false, missed]), minlength=photos)
    order = np.argsort(-mistakes, kind="stable")
    return [int(index) for index in order if mistakes[index]]


def _distances(photo: LabelledPhoto) -> np.ndarray:
    """Depth (n,) of the middles of a photo's boxes, metres; NaN: unknown."""
    depth = read_photo_depth(photo.path)
    if depth is None:
        return np.full(len(photo.boxes), np.nan)
    return depths_at(depth, 0.5 * (photo.boxes[:, :2] + photo.boxes[:, 2:]) - 0.5, photo.size)


def _groups(
    photos: LabelledPhotos, matched: Matched, confidence: float, lights: np.ndarray, distances: np.ndarray
) -> Dict[str, List[Group]]:
    sides = [
        np.sqrt(np.prod(photo.boxes[:, 2:] - photo.boxes[:, :2], axis=1)) / max(photo.size)
        for photo in photos.photos
    ]
    values: Dict[str, Tuple[np.ndarray, Callable[[float], str]]] = {
        "size": (100 * np.concatenate([np.zeros(0), *sides]), lambda value: f"{value:.0f} %"),
        "light": (lights[matched.object_photo], lambda value: f"{value:.0f}"),
        "distance": (distances, lambda value: f"{value:.1f} m"),
    }
    found = matched.object_scores >= confidence
    grouped = {name: _split(found, *each, NAMES[name]) for name, each in values.items()}
    return {name: groups for name, groups in grouped.items() if groups}


def _split(
    found: np.ndarray, values: np.ndarray, text: Callable[[float], str], names: Sequence[str]
) -> List[Group]:
    """PARTS groups with equal numbers of objects whose value is known."""
    known = np.isfinite(values)
    if known.sum() < PARTS:
        return []
    limits = np.quantile(values[known], np.linspace(0, 1, PARTS + 1))
    part = np.clip(np.digitize(values, limits[1:-1]), 0, PARTS - 1)
    groups: List[Group] = []
    for number, name in enumerate(names):
        which = known & (part == number)
        if which.any():
            words = f"{name} ({text(limits[number])} to {text(limits[number + 1])})"
            groups.append(Group(words, int(which.sum()), float(found[which].mean())))
    return groups
