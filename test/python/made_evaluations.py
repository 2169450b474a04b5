# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Evaluations of places that the tests make: what each query found is known."""

from pathlib import Path

import numpy as np

from sextant.place_maps.place_map import Photo
from sextant.places.place_evaluation import Cost, PlaceEvaluation, QueryResult
from sextant.places.place_localizer import Localization, PlaceHypothesis, Status
from sextant.places.place_matches import MatchedPhoto
from sextant.places.place_queries import Query
from sextant.places.place_votes import MatchStatistics

PLACES = [Photo(i, f"{i}.png", 10.0 * i, 5.0) for i in range(12)]


def found_of(answers, distances=(1.0,), matches=3, unknown=0.0):
    """A localization.

    :param answers: pairs of a number of PLACES and a probability
    :param distances: of the keypoints of the image to their nearest neighbours
    :param matches: with the best photo
    """
    values = np.array(distances, float)
    kept = int(np.sum(values <= values.mean()))
    statistics = MatchStatistics(
        len(values), len(values), kept, values.min(), values.mean(), values.max(), values.sum()
    )
    nothing = np.zeros((matches, 2))
    match = MatchedPhoto(PLACES[0], nothing, nothing, np.ones(matches))
    hypotheses = [PlaceHypothesis(PLACES[number], probability, None) for number, probability in answers]
    status = Status.AMBIGUOUS if answers else Status.UNUSABLE
    return Localization(status, hypotheses, unknown, None, False, statistics, match)


def result_of(right, answers, position=None, seconds=0.1, name="q.png", **found):
    """:param right: numbers of the correct PLACES; found: see found_of()"""
    query = Query(Path(name), frozenset((PLACES[i].x, PLACES[i].y) for i in right), position)
    return QueryResult(query, found_of(answers, **found), seconds)


def evaluation_of(*results, pixels=(1.0, 1.0), keypoints=1200):
    return PlaceEvaluation(results, np.array(pixels), Cost(2.0, False, 3_000_000, 4_000_000, keypoints))


def half_right(count=40, shift=10.0):
    """Every second query is right; its distances are smaller, its number of keypoints is no different."""
    rng = np.random.default_rng(7)
    results = []
    for i in range(count):
        number, is_right = i % 10, i % 2 == 0
        distances = rng.normal(50 if is_right else 50 + shift, 5, rng.integers(80, 120))
        answers = [(number if is_right else (number + 5) % 10, 0.6), ((number + 1) % 10, 0.2)]
        results.append(result_of([number], answers, distances=distances, seconds=0.001 * (i + 1)))
    return evaluation_of(*results)
