# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Votes and similarities on one scale."""

import numpy as np
import pytest
from scipy import integrate, stats

from sextant.places.place_fusion import deviations, fused_scores

PHOTOS, TRIALS = 401, 400


def drawn(rng, separation):
    """(photos,) scores of which the first one's is higher."""
    scores = rng.normal(size=PHOTOS)
    scores[0] += separation
    return scores


def probability_of_being_the_best(separation):
    """Of one normal draw that far above many others."""

    def density(x):
        return stats.norm.pdf(x - separation) * stats.norm.cdf(x) ** (PHOTOS - 1)

    return integrate.quad(density, -8, 16)[0]


def test_deviations_of_normal_noise_are_its_standard_deviations():
    noise = np.random.default_rng(1).normal(5.0, 0.1, 100_000)
    assert deviations(noise) == pytest.approx((noise - 5.0) / 0.1, abs=0.1)


def test_scale_and_origin_do_not_matter():
    scores = np.random.default_rng(2).exponential(size=200)
    assert deviations(7 + 3 * scores) == pytest.approx(deviations(scores))


@pytest.mark.parametrize("scores", [np.zeros(5), np.full(4, 0.7), np.array([3.0])])
def test_the_same_of_all_says_nothing(scores):
    assert not deviations(scores).any()


def test_rounding_says_nothing():
    scores = np.full(50, 0.9, np.float32) + np.random.default_rng(3).choice([0, 6e-8], 50)
    assert np.abs(deviations(np.append(scores, 0.1))).max() < 1  # and does not blow up what differs


def test_votes_for_few_of_many_photos_are_compared_with_one_another():
    votes = np.zeros(10_000)
    votes[:300] = 1.0 + np.random.default_rng(4).uniform(-0.5, 0.5, 300)
    votes[7] = 40.0
    found = deviations(votes)
    assert found.argmax() == 7 and found[7] == pytest.approx(40 / 1.4826, rel=0.1)
    assert np.delete(found, 7).max() < 1.1


def test_one_chance_vote_of_a_large_map_decides_nothing():
    votes, similarities = np.zeros(PHOTOS), drawn(np.random.default_rng(5), 6)
    votes[9] = 5.0
    assert fused_scores(votes, similarities, 1.0).argmax() == 0


def test_who_says_nothing_leaves_it_to_the_other():
    scores = drawn(np.random.default_rng(6), 4)
    nothing = np.zeros(PHOTOS)
    assert np.array_equal(fused_scores(nothing, scores, 0.5), 0.5 * deviations(scores))
    assert np.array_equal(fused_scores(scores, nothing, 0.5), deviations(scores))
    assert np.array_equal(fused_scores(scores, scores[::-1], 0.0), deviations(scores))


def test_both_together_find_as_many_as_independent_evidence_can():
    rng, separation = np.random.default_rng(7), 2.5
    right = []
    for _ in range(TRIALS):
        votes, similarities = 30 + 9 * drawn(rng, separation), 0.4 + 0.01 * drawn(rng, separation)
        right.append([each.argmax() == 0 for each in (votes, fused_scores(votes, similarities, 1.0))])
    alone, fused = np.mean(right, axis=0)
    for found, expected in ((alone, separation), (fused, np.sqrt(2) * separation)):
        chance = probability_of_being_the_best(expected)
        assert found == pytest.approx(chance, abs=3 * np.sqrt(chance * (1 - chance) / TRIALS))
