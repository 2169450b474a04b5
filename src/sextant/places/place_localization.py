# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where in a map of places a robot is, picture by picture."""

from dataclasses import dataclass, field
from enum import IntEnum
from typing import List, NamedTuple, Optional

import numpy as np

from sextant.places.place_belief import BeliefParams, Hypothesis
from sextant.places.place_estimate import PlaceEstimate, estimate, scale_of
from sextant.places.place_index import PlaceIndex
from sextant.places.place_map import Photo, PlaceMap
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
class LocalizationParams:
    """How pictures are recognized and taken together."""

    mode: str = "filter"  # one of sextant.places.place_modes.MODES, or votes
    max_places: int = 5  # [1, 1000]; that are told
    window: int = 30  # [2, 1000]; pictures of mode sequence
    min_matches: int = 10  # [1, 100000]; votes, in mode votes, with less nothing is told
    recognition: RecognitionParams = field(default_factory=RecognitionParams)
    belief: BeliefParams = field(default_factory=BeliefParams)

    def validate(self) -> None:
        """:raises ValueError: names the first field out of range"""
        if self.mode not in (*MODES, VOTES):
            raise ValueError(f"mode is '{self.mode}', allowed is one of {', '.join((*MODES, VOTES))}")
        for name, low, high in (("max_places", 1, 1000), ("window", 2, 1000), ("min_matches", 1, 100000)):
            if not low <= getattr(self, name) <= high:
                raise ValueError(f"{name} is {getattr(self, name)}, allowed is [{low}, {high}]")
        self.recognition.validate()
        self.belief.validate()


class Answer(NamedTuple):
    """A place, told by its likeliest photo."""

    photo: Photo
    probability: float


class Localization(NamedTuple):
    """What is known after a picture."""

    status: Status
    answers: List[Answer]  # most probable first
    nowhere: float  # probability
    estimate: Optional[PlaceEstimate]  # where the status is LOCALIZED
    found_again: bool  # it is LOCALIZED and was not, or was elsewhere
    statistics: MatchStatistics
    match: MatchedPhoto  # of the photo that the picture alone is likest


class PlaceLocalizer:
    """Takes the pictures of one robot in their order. Not thread-safe."""

    def __init__(self, place_map: PlaceMap, index: PlaceIndex, params: Optional[LocalizationParams] = None):
        """:raises ValueError: a parameter out of range, or a photo that is not in the index"""
        self._params = params or LocalizationParams()
        self._params.validate()
        self.scale = scale_of(place_map)
        self._places = place_map.places()
        self._positions = np.array([(photos[0].x, photos[0].y) for photos in self._places])
        self._pixels = np.array(self.scale or (1.0, 1.0))  # in metres, if possible
        self._last: Optional[np.ndarray] = None  # where it was localized
        if self._params.mode == VOTES:
            self._voter = PlaceVoter(place_map, index, self._params.min_matches, self._params.max_places)
        else:
            self._recognizer = PlaceRecognizer(place_map, index, self._params.recognition)
            self.reset()

    def reset(self) -> None:
        """Forgets all pictures."""
        self._last = None
        if self._params.mode != VOTES:
            in_units = self._positions * self._pixels
            self._mode = MODES[self._params.mode](in_units, self._params.belief, self._params.window)

    def localize(self, image: np.ndarray, distance: Optional[float] = None) -> Localization:
        """:param image: uint8, (height, width) grey or (height, width, 3) BGR

        :param distance: metres since the last picture, by odometry; not used where the map has no scale
        """
        if self._params.mode == VOTES:
            return self._voted(image)
        seen = self._recognizer.recognize(image)
        gone = distance if self.scale else None
        self._mode.update(Seen(seen.log_ratios if seen.usable else None, gone))
        return self._told(seen, gone)

    def _told(self, seen: Recognition, gone: Optional[float]) -> Localization:
        belief = self._mode.belief
        found = belief.hypotheses(self._params.max_places)
        answers = [Answer(seen.best_photos[each.place], each.probability) for each in found]
        status = _status(answers, belief.nowhere) if seen.usable else Status.UNUSABLE
        place, again = None, False
        if status == Status.LOCALIZED:
            place = self._estimate(found[0], seen)
            again = self._is_found_again(found[0].place, gone)
        if status != Status.UNUSABLE:
            self._last = self._positions[found[0].place] if place else None
        return Localization(status, answers, belief.nowhere, place, again, seen.statistics, seen.match)

    def _estimate(self, found: Hypothesis, seen: Recognition) -> PlaceEstimate:
        spacing = self._mode.belief.spacing / float(np.mean(self._pixels))
        yaws = [seen.best_photos[place].yaw for place in found.around]
        return estimate(self._positions[found.around], self._mode.belief.places[found.around], yaws, spacing)

    def _is_found_again(self, place: int, gone: Optional[float]) -> bool:
        if self._last is None:
            return True
        belief, params = self._mode.belief, self._params.belief
        jump = np.linalg.norm((self._positions[place] - self._last) * self._pixels)
        return bool(jump > (gone or 0.0) + (params.reach + params.radius) * belief.spacing)

    def _voted(self, image: np.ndarray) -> Localization:
        votes = self._voter.vote(image)
        answers = [Answer(*each) for each in zip(votes.photos, votes.probabilities)]
        status = _status(answers, 0.0) if answers else Status.UNUSABLE
        place = None
        if status == Status.LOCALIZED:
            photo = answers[0].photo
            place = estimate(np.array([[photo.x, photo.y]]), np.ones(1), [photo.yaw], self._voter.spacing)
        again = place is not None and self._last is None
        self._last = None if place is None else np.array([place.x, place.y])
        return Localization(status, answers, 0.0, place, again, votes.statistics, votes.match)


def _status(answers: List[Answer], nowhere: float) -> Status:
    if nowhere > 0.5:
        return Status.NOWHERE
    return Status.LOCALIZED if answers and answers[0].probability > 0.5 else Status.AMBIGUOUS
