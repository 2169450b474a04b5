# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where in a map of places a robot is, picture by picture."""

from dataclasses import dataclass
from enum import IntEnum
from typing import List, NamedTuple, Optional

import numpy as np

from sextant.base.strict_params import StrictParams, nested, one_of, param, within
from sextant.place_maps.place_map import Photo, PlaceMap
from sextant.places.place_belief import BeliefParams, BeliefPeak
from sextant.places.place_estimate import PlaceEstimate, estimate, scale_of
from sextant.places.place_index import PlaceIndex
from sextant.places.place_matches import MatchedPhoto
from sextant.places.place_modes import MODES, Seen
from sextant.places.place_recognition import PlaceRecognizer, Recognition, RecognitionParams
from sextant.places.place_voter import PlaceVoter
from sextant.places.place_votes import MatchStatistics

VOTES = "votes"  # the mode that counts matches, with no belief


class Status(IntEnum):
    """The numbers are those of sextant/PlaceHypotheses."""

    LOCALIZED = 0  # one place, with its neighbours, is more probable than all others together
    AMBIGUOUS = 1
    NOWHERE = 2
    UNUSABLE = 3  # the picture shows too little


@dataclass(frozen=True)
class PlaceLocalizationParams(StrictParams):
    """How pictures are recognized and taken together."""

    mode: str = param("filter", one_of(*MODES, VOTES))  # of sextant.places.place_modes.MODES, or votes
    max_places: int = param(5, within(1, 1000))  # that are told
    window: int = param(30, within(2, 1000))  # pictures of mode sequence
    min_matches: int = param(10, within(1, 100000))  # votes, in mode votes, with less nothing is told
    recognition: RecognitionParams = nested(RecognitionParams)
    belief: BeliefParams = nested(BeliefParams)


class PlaceAnswer(NamedTuple):
    """A place, told by its likeliest photo."""

    photo: Photo
    probability: float


class Localization(NamedTuple):
    """What is known after a picture."""

    status: Status
    answers: List[PlaceAnswer]  # most probable first
    nowhere: float  # probability
    estimate: Optional[PlaceEstimate]  # where the status is LOCALIZED
    found_again: bool  # it is LOCALIZED, and never was, was nowhere, or was elsewhere
    statistics: MatchStatistics
    match: MatchedPhoto  # of the photo that the picture alone is likest


class _Followed:
    """Whether a robot that is localized was lost before, or is farther away than it can have gone."""

    def __init__(self, spacing: float, params: BeliefParams):
        self._reach, self._radius = params.reach * spacing, params.radius * spacing
        self._last: Optional[np.ndarray] = None  # where it was localized
        self._gone = 0.0  # at most, since then

    def update(self, status: Status, position: Optional[np.ndarray], distance: Optional[float]) -> bool:
        self._gone += (distance or 0.0) + self._reach
        if status == Status.NOWHERE:
            self._last = None
        if status != Status.LOCALIZED:
            return False
        lost = self._last is None or np.linalg.norm(position - self._last) > self._gone + self._radius
        self._last, self._gone = position, 0.0
        return bool(lost)


class PlaceLocalizer:
    """Takes the pictures of one robot in their order. Not thread-safe."""

    def __init__(
        self, place_map: PlaceMap, index: PlaceIndex, params: Optional[PlaceLocalizationParams] = None
    ):
        """:raises ValueError: a parameter out of range, or a photo that is not in the index"""
        self._params = params or PlaceLocalizationParams()
        self.scale = scale_of(place_map)
        self._positions = np.array([(place[0].x, place[0].y) for place in place_map.places()])
        self._pixels = np.array(self.scale or (1.0, 1.0))  # (2,) in metres, if possible
        if self._params.mode == VOTES:
            self._voter = PlaceVoter(place_map, index, self._params.min_matches, self._params.max_places)
        else:
            self._recognizer = PlaceRecognizer(place_map, index, self._params.recognition)
        self.reset()

    def reset(self) -> None:
        """Forgets all pictures."""
        in_units, belief = self._positions * self._pixels, self._params.belief
        mode = MODES["single" if self._params.mode == VOTES else self._params.mode]
        self._mode = mode(in_units, belief, self._params.window)
        self._spacing = self._mode.belief.spacing / self._pixels  # (2,) pixels
        self._followed = _Followed(self._mode.belief.spacing, belief)

    def localize(self, image: np.ndarray, distance: Optional[float] = None) -> Localization:
        """:param image: uint8, (height, width) grey or (height, width, 3) BGR

        :param distance: metres since the last picture, by odometry; not used where the map has no scale
        """
        if self._params.mode == VOTES:
            return self._voted(image)
        seen = self._recognizer.recognize(image)
        gone = distance if self.scale else None
        self._mode.update(Seen(seen.log_ratios if seen.usable else None, gone, seen.voted))
        return self._told(seen, gone)

    def _told(self, seen: Recognition, gone: Optional[float]) -> Localization:
        belief = self._mode.belief
        found = belief.hypotheses(self._params.max_places)
        answers = [PlaceAnswer(seen.best_photos[each.place], each.probability) for each in found]
        status = _status(answers, belief.nowhere) if seen.usable else Status.UNUSABLE
        place = self._estimate(found[0], seen) if status == Status.LOCALIZED else None
        at = self._positions[found[0].place] * self._pixels if place else None
        again = self._followed.update(status, at, gone)
        return Localization(status, answers, belief.nowhere, place, again, seen.statistics, seen.match)

    def _estimate(self, found: BeliefPeak, seen: Recognition) -> PlaceEstimate:
        yaws = [seen.best_photos[place].yaw for place in found.around]
        probabilities = self._mode.belief.places[found.around]
        return estimate(self._positions[found.around], probabilities, yaws, self._spacing)

    def _voted(self, image: np.ndarray) -> Localization:
        votes = self._voter.vote(image)
        answers = [PlaceAnswer(*each) for each in zip(votes.photos, votes.probabilities)]
        status = _status(answers, 0.0) if answers else Status.UNUSABLE
        place, at = None, None
        if status == Status.LOCALIZED:
            photo = answers[0].photo
            place = estimate(np.array([[photo.x, photo.y]]), np.ones(1), [photo.yaw], self._spacing)
            at = np.array([photo.x, photo.y]) * self._pixels
        again = self._followed.update(status, at, None)
        return Localization(status, answers, 0.0, place, again, votes.statistics, votes.match)


def _status(answers: List[PlaceAnswer], nowhere: float) -> Status:
    if nowhere > 0.5:
        return Status.NOWHERE
    return Status.LOCALIZED if answers and answers[0].probability > 0.5 else Status.AMBIGUOUS
