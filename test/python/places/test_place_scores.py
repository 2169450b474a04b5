# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Photos compared with one another, all of them or candidates."""

import numpy as np
import pytest
from made_photos import index_of, picture, shifted, written_photos

import sextant
from sextant.places import place_scores
from sextant.places.photo_features import KeypointExtractor
from sextant.places.place_scores import compared_photos, photo_scores

COUNT = 8


@pytest.fixture(scope="module")
def place_map(tmp_path_factory):
    return written_photos(tmp_path_factory.mktemp("map"), COUNT)


def kinds_of(index, image):
    return index.encode(KeypointExtractor(index.params).extract(image))


def test_scores_are_of_the_photos_that_are_given(place_map):
    index = index_of(place_map)
    kinds = kinds_of(index, shifted(picture(5), 6, 2))
    assert photo_scores(index, np.arange(COUNT), kinds).logs.argmax() == 5
    assert photo_scores(index, np.array([7, 5, 0]), kinds).logs.argmax() == 1


@pytest.mark.skipif(not sextant.has_faiss(), reason="built without faiss")
def test_candidates_are_those_with_most_votes_and_the_others_score_as_the_least(place_map, monkeypatch):
    monkeypatch.setattr("sextant.places.place_index.EXHAUSTIVE", COUNT - 1)
    monkeypatch.setattr(place_scores, "CANDIDATES", 3)
    index, exact = index_of(place_map), index_of(place_map)
    exact.descriptors = None
    kinds = kinds_of(index, shifted(picture(5), 6, 2))
    found = photo_scores(index, np.arange(COUNT), kinds).logs
    assert found.argmax() == 5
    assert (found == found.min()).sum() == COUNT - 2  # the last candidate and all that are none
    assert photo_scores(index, np.array([7, 5, 0]), kinds).logs.argmax() == 1


def test_compared_photos_do_not_know_themselves(place_map, monkeypatch):
    monkeypatch.setattr(place_scores, "COMPARED", 5)
    index = index_of(place_map)
    found = compared_photos(index)
    assert found.scores.shape == (1, 5, COUNT) and len(set(found.rows)) == 5
    (scores,) = found.scores
    assert [np.flatnonzero(np.isnan(row)).tolist() for row in scores] == [[row] for row in found.rows]
    row, others = found.rows[2], np.delete(np.arange(COUNT), found.rows[2])
    expected = photo_scores(index, others, [kind.of(row) for kind in index.keypoints]).total
    assert scores[2, others] == pytest.approx(expected, rel=1e-6)
