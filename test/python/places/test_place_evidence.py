# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Scores as deviations and as likelihood ratios, against normal distributions and by hand."""

import numpy as np
import pytest
from scipy.stats import norm

from sextant.places.place_evidence import (
    FEW_PLACES,
    UNRELATED,
    EvidenceParams,
    UnknownPlaces,
    absolute_log_ratios,
    deviations,
    image_features,
    relative_log_ratios,
)


def test_deviations_of_normal_noise_are_its_standard_deviations():
    noise = np.random.default_rng(1).normal(5.0, 0.1, 99)
    expected = (noise - np.median(noise)) / 0.1
    assert deviations(noise) == pytest.approx(expected, rel=0.3)


def test_scale_and_origin_do_not_matter():
    scores = np.random.default_rng(2).exponential(size=200)
    assert deviations(7 + 3 * scores) == pytest.approx(deviations(scores))


@pytest.mark.parametrize("scores", [np.zeros(5), np.full(4, 0.7), np.array([3.0])])
def test_the_same_of_all_gives_no_evidence(scores):
    assert not deviations(scores).any()


def test_rounding_gives_no_evidence():
    scores = np.full(50, 0.9, np.float32) + np.random.default_rng(3).choice([0, 6e-8], 50)
    assert np.abs(deviations(np.append(scores, 0.1))).max() < 1  # and does not blow up what differs


def test_a_right_photo_stands_out_as_much_of_a_thousandfold_map():
    rng = np.random.default_rng(4)
    found = [deviations(np.append(rng.exponential(size=n), 15.0))[-1] for n in (100, 100_000)]
    assert found[0] > 10 and found[1] > 4


def test_votes_for_few_of_many_photos_are_compared_with_one_another():
    votes = np.zeros(10_000)
    votes[:60] = 1.0 + np.random.default_rng(4).uniform(-0.5, 0.5, 60)
    votes[7] = 40.0
    found = deviations(votes)
    assert found.argmax() == 7 and found[7] > 20
    assert np.delete(found, 7).max() < 3


# three photos, each compared with the others; the last two are near each other
SCORES = np.array([[np.nan, 2.0, 4.0], [1.0, np.nan, 9.0], [5.0, 9.0, np.nan]])
NEAR = np.array([[1, 0, 0], [0, 1, 1], [0, 1, 1]], bool)


def test_unknown_places_are_photos_without_their_neighbours():
    excess = [4 - 3, 1 - 5, 5 - 7]  # the highest of those elsewhere minus the median of all
    found = UnknownPlaces.of_map(SCORES, NEAR)
    assert found == pytest.approx((np.mean(excess), np.std(excess)))


@pytest.mark.parametrize("near", [np.ones((3, 3), bool), np.zeros((0, 3), bool)])
def test_without_photos_elsewhere_the_distribution_is_that_of_few_places(near):
    assert UnknownPlaces.of_map(SCORES[: len(near)], near) == FEW_PLACES


def test_features_are_the_margin_and_the_excess():
    scores, near = np.array([3.0, 9.0, 8.0, 4.0, 1.0]), np.array([0, 1, 1, 0, 0], bool)
    assert image_features(scores, near, UnknownPlaces(2.0, 0.5)).tolist() == [9 - 4, (9 - 4 - 2) / 0.5]


def test_a_map_of_one_place_is_compared_with_unrelated_photos():
    found = image_features(np.array([19.0, 21.0]), np.ones(2, bool), UnknownPlaces(2.0, 0.5), 2)
    assert found.tolist() == [21 - 2 * UNRELATED, (21 - 2 * UNRELATED - 2) / 0.5]


def test_absolute_evidence_is_the_odds_times_the_relative_likelihood():
    params = EvidenceParams(slope=0.7, margin=0.5, excess=2.0, offset=4.0, limit=12.0)
    scores, shares = np.array([0.0, 1.0, 2.0]), np.array([0.5, 0.25, 0.25])
    found = absolute_log_ratios(scores, np.array([3.0, 1.5]), shares, params)
    assert np.log(shares @ np.exp(found)) == pytest.approx(0.5 * 3 + 2 * 1.5 - 4)
    assert np.diff(found) == pytest.approx([0.7, 0.7])
    for sign in (1, -1):
        limited = absolute_log_ratios(scores, sign * np.array([1e3, 1e3]), shares, params)
        assert np.log(shares @ np.exp(limited)) == pytest.approx(12 * sign)


def equally(count):
    return np.full(count, 1 / count)


def test_relative_evidence_of_two_photos_is_that_of_two_normal_densities():
    scores, shift = np.random.default_rng(5).normal(5.0, 0.1, 99), 1.5
    ratios, z = relative_log_ratios(scores, shift, equally(99)), deviations(scores)
    right, wrong = norm.logpdf(z, shift), norm.logpdf(z)
    assert ratios - ratios[7] == pytest.approx(right - wrong - (right - wrong)[7])


@pytest.mark.parametrize("shift", [0.5, 1.0, 3.0, 100.0])
@pytest.mark.parametrize("winner", [0.0, 5.0, 1e6])
def test_relative_evidence_is_none_for_or_against_an_unknown_place(shift, winner):
    rng = np.random.default_rng(6)
    scores, shares = np.append(rng.normal(size=40), winner), rng.dirichlet(np.ones(41))
    assert shares @ np.exp(relative_log_ratios(scores, shift, shares)) == pytest.approx(1.0)


def test_the_same_of_all_is_no_relative_evidence():
    assert relative_log_ratios(np.full(9, 0.3), 1.5, equally(9)) == pytest.approx(np.zeros(9))


@pytest.mark.parametrize(
    "changed, reason", [({"limit": 0.0}, "limit: must be"), ({"slope": -1.0}, "slope: must be")]
)
def test_parameters_out_of_range_are_refused(changed, reason):
    with pytest.raises(ValueError, match=reason):
        EvidenceParams(**changed)
