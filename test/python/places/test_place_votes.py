# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Votes of neighbours that are counted by hand."""

import numpy as np
import pytest

from sextant.places.place_votes import count_votes, lnbnn_scores, lnbnn_weights, match_statistics

#        nearest two neighbours of five descriptors
DISTANCES = np.array([[1.0, 4.0], [2.0, 4.0], [3.0, 5.0], [2.0, 3.0], [12.0, 13.0]])
OWNERS = np.array([[7, 2], [7, 7], [2, 7], [7, 2], [1, 2]])


def test_matches_farther_than_the_mean_have_no_vote():
    photos, probabilities = count_votes(DISTANCES, OWNERS, 1, 10)  # the mean is 4
    assert photos.tolist() == [7, 2]
    assert probabilities == pytest.approx([3 / 4, 1 / 4])


def test_only_the_best_are_reported():
    photos, probabilities = count_votes(DISTANCES, OWNERS, 1, 1)
    assert photos.tolist() == [7] and probabilities == pytest.approx([0.75])


def test_the_only_one_has_them_all():
    photos, probabilities = count_votes(DISTANCES[:2], OWNERS[:2], 1, 10)
    assert photos.tolist() == [7] and probabilities == pytest.approx([1.0])


@pytest.mark.parametrize("count", [0, 3])
def test_too_few_votes_are_none(count):
    assert len(count_votes(DISTANCES[:count], OWNERS[:count], 4, 10)[0]) == 0


def test_where_all_are_as_far_all_vote():
    image_ids = np.zeros((1000, 1), int)
    for distance in np.random.default_rng(1).uniform(50, 500, 50):
        distances = np.full((1000, 1), distance, np.float32)
        assert len(count_votes(distances, image_ids, 1000, 1)[0]) == 1
        assert match_statistics(distances[:, 0], image_ids[:, 0] >= 0).kept == 1000


def test_descriptors_without_a_neighbour_do_not_vote():
    assert len(count_votes(DISTANCES, np.full_like(OWNERS, -1), 1, 10)[0]) == 0


def test_statistics_are_those_of_the_nearest():
    nearest, all_of_them = DISTANCES[:, 0], np.ones(5, bool)
    assert match_statistics(nearest, all_of_them) == (5, 5, 4, 1.0, 4.0, 12.0, 20.0)
    assert match_statistics(nearest[:0], all_of_them[:0]) == (0, 0, 0, 0.0, 0.0, 0.0, 0.0)


def test_a_weight_is_the_part_that_a_neighbour_is_nearer_than_the_last():
    distances = np.array([[1.0, 2.0, 4.0], [1.0, 1.5, 2.0], [1.0, 4.0, 0.0], [0.0, 0.0, 0.0]])
    image_ids = np.array([[0, 1, 2], [1, 1, 0], [2, 1, -1], [-1, -1, -1]])  # the last two: there are no more
    weights = [[0.75, 0.5, 0.0], [0.5, 0.0, 0.0], [0.75, 0.0, 0.0], [0.0, 0.0, 0.0]]
    assert lnbnn_weights(distances, image_ids).tolist() == weights


@pytest.mark.filterwarnings("error")
def test_what_is_not_there_is_infinitely_far():
    distances = np.array([[1.0, 2.0, np.inf], [2.0, np.inf, np.inf], [np.inf] * 3])
    image_ids = np.array([[0, 1, -1], [1, -1, -1], [-1] * 3])
    assert lnbnn_weights(distances, image_ids).tolist() == [[0.5, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
    assert count_votes(distances, image_ids, 1, 10)[0].tolist() == [0]
    assert match_statistics(distances[:, 0], image_ids[:, 0] >= 0).total == 3.0


def test_scores_are_sums_of_weights():
    weights = np.array([[4.0, 3.0, 0.0], [1.0, 0.0, 0.0]])
    assert lnbnn_scores(weights, np.array([[0, 1, 2], [1, 1, -1]]), 4).tolist() == [4.0, 4.0, 0.0, 0.0]


def test_an_image_without_descriptors_scores_nothing():
    none = np.zeros((0, 3)), np.zeros((0, 3), int)
    assert lnbnn_scores(lnbnn_weights(*none), none[1], 2).tolist() == [0.0, 0.0]
