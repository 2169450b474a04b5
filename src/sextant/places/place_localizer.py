# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Localizes a robot in a place map, image by image."""

from dataclasses import dataclass
from enum import IntEnum
from typing import List, NamedTuple, Optional, Tuple

import numpy as np

import sextant
from sextant.base.strict_params import StrictParams, nested, one_of, param, within
from sextant.place_maps.place_map import Photo, PlaceMap
from sextant.place_points.place_points import PlacePoints
from sextant.place_points.point_localizer import MetricPose, PointLocalizer
from sextant.places.place_belief import BeliefParams, BeliefPeak
from sextant.places.place_estimate import PlaceEstimate, estimate, scale_of
from sextant.places.place_heading import DEVIATION, turn_to_left
from sextant.places.place_index import PlaceIndex
from sextant.places.place_matches import MatchedPhoto
from sextant.places.place_modes import MODES, ImageEvidence
from sextant.places.place_recognition import PlaceRecognizer, Recognition, RecognitionParams
from sextant.places.place_votes import MatchStatistics
from sextant.places.rough_pose import RoughPose
from sextant.places.vote_shares import VoteCounter

VOTES = "votes"  # the mode that counts matches, without a belief


class Status(IntEnum):
    """Status of a localization, with the values of sextant/PlaceHypotheses."""

    LOCALIZED = 0  # one place and its neighbours are more probable than everything else together
    AMBIGUOUS = 1  # no place is as probable as that
    UNKNOWN_PLACE = 2  # probably a place that is not in the map
    UNUSABLE = 3  # the image has too little content


@dataclass(frozen=True)
class PlaceLocalizationParams(StrictParams):
    """Parameters of recognition and of the fusion of successive images."""

    mode: str = param(
        "filter", "[fusion of successive images](../how_to/places.md#parameters)", one_of(*MODES, VOTES)
    )
    max_places: int = param(5, "maximum number of hypotheses", within(1, 1000))
    window: int = param(30, "mode sequence: number of fused images", within(2, 1000))
    min_matches: int = param(10, "mode votes: minimum number of votes", within(1, 100000))
    recognition: RecognitionParams = nested(RecognitionParams)
    belief: BeliefParams = nested(BeliefParams)


class PlaceHypothesis(NamedTuple):
    """A place and its probability."""

    photo: Photo  # the most likely photo of the place
    probability: float  # of the place and its neighbours
    estimate: PlaceEstimate  # from the place and its neighbours


class Localization(NamedTuple):
    """Result of one image."""

    status: Status  # LOCALIZED, AMBIGUOUS, UNKNOWN_PLACE or UNUSABLE
    hypotheses: List[PlaceHypothesis]  # most probable first
    unknown_probability: float  # of a place that is not in the map
    estimate: Optional[PlaceEstimate]  # None unless the status is LOCALIZED
    # LOCALIZED for the first time, after UNKNOWN_PLACE, or farther away than the robot can have driven
    relocalized: bool  # localized for the first time, or again
    statistics: MatchStatistics  # of the image's keypoints
    match: MatchedPhoto  # the photo that matches this image best
    pose: Optional[MetricPose] = None  # by the points of the map; None: the estimate is all that is known


class _RelocalizationDetector:
    """Detects that the robot is localized after it was lost, or farther away than it can have driven."""

    def __init__(self, spacing: float, params: BeliefParams):
        self._reach, self._radius = params.reach * spacing, params.radius * spacing
        self._last: Optional[np.ndarray] = None  # at the last image with status LOCALIZED
        self._driven = 0.0  # maximum distance driven since then

    def update(self, status: Status, position: Optional[np.ndarray], distance: Optional[float]) -> bool:
        self._driven += (distance or 0.0) + self._reach
        if status == Status.UNKNOWN_PLACE:
            self._last = None
        if status != Status.LOCALIZED:
            return False
        lost = self._last is None or np.linalg.norm(position - self._last) > self._driven + self._radius
        self._last, self._driven = position, 0.0
        return bool(lost)


class PlaceLocalizer:
    """Localizes one robot from its successive images. Not thread-safe."""

    scale: Optional[Tuple[float, float]]  # metres per pixel of the overview, see scale_of()

    def __init__(
        self,
        place_map: PlaceMap,
        index: PlaceIndex,
        params: Optional[PlaceLocalizationParams] = None,
        points: Optional[PlacePoints] = None,
        same_camera: bool = False,
    ):
        """:param points: of the map, for metric poses
        :param same_camera: the map's photos were taken by the camera that is passed to localize(), with the
            same size: the matches measure the heading
        :raises ValueError: a parameter out of range, or a photo that is not in the index
        """
        self._params, self._same_camera = params or PlaceLocalizationParams(), same_camera
        self._points = PointLocalizer(points) if points else None
        self.scale = scale_of(place_map)
        self._positions = place_map.positions()
        self._metres_per_pixel = np.array(self.scale or (1.0, 1.0))  # (2,)
        if self._params.mode == VOTES:
            counts = self._params.min_matches, self._params.max_places
            self._votes = VoteCounter(place_map, index, *counts)
        else:
            self._recognizer = PlaceRecognizer(place_map, index, self._params.recognition)
        self.reset()

    def reset(self) -> None:
        """Discards the evidence of all images."""
        positions, belief = self._positions * self._metres_per_pixel, self._params.belief
        mode = MODES["single" if self._params.mode == VOTES else self._params.mode]
        self._mode = mode(positions, belief, self._params.window)
        # distance between neighbouring places along x and y
        self._spacing = self._mode.belief.spacing / self._metres_per_pixel  # (2,) pixels
        self._relocalization = _RelocalizationDetector(self._mode.belief.spacing, belief)

    def localize(
        self,
        image: np.ndarray,
        distance: Optional[float] = None,
        camera: Optional["sextant.CameraModel"] = None,
        rough: Optional[RoughPose] = None,
    ) -> Localization:
        """Localizes the robot with one more image.

        :param image: uint8, (height, width) grey or (height, width, 3) BGR
        :param distance: metres since the last image, by odometry; ignored if the map has no scale
        :param camera: that took the image; without it there is no metric pose
        :param rough: of the camera, by another estimate; not used by mode votes
        :raises ValueError: the image does not have the camera's size
        """
        found = self._localize(image, distance, rough)
        if camera is None or found.estimate is None:
            return found
        if self._same_camera:
            found = found._replace(estimate=self._with_heading(found.estimate, found.match, camera))
        if self._points is None:
            return found
        near = found.hypotheses[0].photo.image
        return found._replace(pose=self._points.localize(image, camera, near))

    def _localize(
        self, image: np.ndarray, distance: Optional[float], rough: Optional[RoughPose]
    ) -> Localization:
        if self._params.mode == VOTES:
            return self._localize_by_votes(image)
        recognition = self._recognizer.recognize(image, rough)
        driven = distance if self.scale else None
        log_ratios = recognition.log_ratios if recognition.usable else None
        is_absolute, weights = recognition.is_absolute, recognition.log_weights
        self._mode.update(ImageEvidence(log_ratios, driven, is_absolute, weights))
        return self._localize_by_belief(recognition, driven)

    def _localize_by_belief(self, recognition: Recognition, driven: Optional[float]) -> Localization:
        belief = self._mode.belief
        peaks, unknown = belief.hypotheses(self._params.max_places)
        photos = recognition.best_photos
        hypotheses = [
            PlaceHypothesis(photos[peak.place], peak.probability, self._estimate(peak, recognition))
            for peak in peaks
        ]
        status = _status(hypotheses, unknown) if recognition.usable else Status.UNUSABLE
        estimated = hypotheses[0].estimate if status == Status.LOCALIZED else None
        position = self._positions[peaks[0].place] * self._metres_per_pixel if estimated else None
        relocalized = self._relocalization.update(status, position, driven)
        statistics, match = recognition.statistics, recognition.match
        return Localization(status, hypotheses, unknown, estimated, relocalized, statistics, match)

    def _estimate(self, peak: BeliefPeak, recognition: Recognition) -> PlaceEstimate:
        yaws = [recognition.best_photos[place].yaw for place in peak.around]
        probabilities = self._mode.belief.places[peak.around]
        return estimate(self._positions[peak.around], probabilities, yaws, self._spacing)

    def _estimate_of(self, photo: Photo) -> PlaceEstimate:
        return estimate(np.array([[photo.x, photo.y]]), np.ones(1), [photo.yaw], self._spacing)

    def _with_heading(
        self, place: PlaceEstimate, match: MatchedPhoto, camera: "sextant.CameraModel"
    ) -> PlaceEstimate:
        """The estimate with the heading by the matches, if they are with a photo of its places."""
        offset = np.array([match.photo.x - place.x, match.photo.y - place.y]) / self._spacing
        if match.photo.yaw is None or np.linalg.norm(offset) > self._params.belief.radius:
            return place
        angle = turn_to_left(match, camera)
        if angle is None:
            return place
        return place._replace(yaw=match.photo.yaw + angle, yaw_deviation=DEVIATION)

    def _localize_by_votes(self, image: np.ndarray) -> Localization:
        votes = self._votes.count(image)
        hypotheses = [
            PlaceHypothesis(photo, share, self._estimate_of(photo))
            for photo, share in zip(votes.photos, votes.shares)
        ]
        status = _status(hypotheses, 0.0) if hypotheses else Status.UNUSABLE
        estimated, position = None, None
        if status == Status.LOCALIZED:
            estimated = hypotheses[0].estimate
            position = np.array([estimated.x, estimated.y]) * self._metres_per_pixel
        relocalized = self._relocalization.update(status, position, None)
        return Localization(status, hypotheses, 0.0, estimated, relocalized, votes.statistics, votes.match)


def _status(hypotheses: List[PlaceHypothesis], unknown: float) -> Status:
    if unknown > 0.5:
        return Status.UNKNOWN_PLACE
    return Status.LOCALIZED if hypotheses and hypotheses[0].probability > 0.5 else Status.AMBIGUOUS
