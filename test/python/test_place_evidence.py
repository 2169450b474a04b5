# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Scores as deviations and as likelihood ratios, against normal distributions and by hand."""

import numpy as np
import pytest

from sextant.places.place_evidence import (
    EvidenceParams,
    absolute_log_ratios,
    deviations,
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
def test_the_same_of_all_says_nothing(scores):
    assert not deviations(scores).any()


def test_rounding_says_nothing():
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


def test_few_photos_do_not_make_a_deviation_small():
    scores = np.array([1.0, 1.01, 1.02, 1.5])
    assert deviations(scores, 0.1).max() == pytest.approx((1.5 - 1.015) / 0.1015)


def test_absolute_evidence_is_its_formula_between_the_limits():
    params = EvidenceParams(deviation=0.5, score=2.0, size=3.0, offset=4.0, limit=12.0)
    scores = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
    z = (scores - 2.0) / (1.4826 * 1.5)  # of the four others that differ, medians of 1, 1, 2, 2
    expected = 0.5 * z[1:] + 2.0 * np.log(scores[1:]) + 3.0 * np.log(5) - 4.0
    found = absolute_log_ratios(scores, params)
    assert found[0] == -12.0
    assert found[1:] == pytest.approx(expected)
    assert absolute_log_ratios(1e6 * scores, params)[-1] == 12.0


def test_relative_evidence_is_the_ratio_of_two_normal_densities():
    rng, shift = np.random.default_rng(5), 1.5
    ratios = np.exp(np.concatenate([relative_log_ratios(rng.normal(size=99), shift) for _ in range(200)]))
    assert ratios.mean() == pytest.approx(1.0, abs=0.15)  # of a likelihood ratio, where it is not true
    assert relative_log_ratios(np.zeros(9), shift) == pytest.approx(-0.5 * shift**2)


@pytest.mark.parametrize(
    "changed, reason", [({"limit": 0.0}, "limit is 0.0"), ({"score": -1.0}, "score is -1.0")]
)
def test_parameters_out_of_range_are_refused(changed, reason):
    with pytest.raises(ValueError, match=reason):
        EvidenceParams(**changed).validate()
