# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Figures of a recognition, on answers whose figures can be computed by hand."""

import numpy as np
import pytest
import scipy.stats

from sextant.places.place_metrics import (
    calibration_error,
    perfect_calibration_error,
    perfect_frequencies,
    precision_recall,
    reliability,
)


def test_the_area_of_right_answers_only_is_one():
    curve = precision_recall([0.1, 0.9, 0.5], [True, True, True])
    assert curve.area == pytest.approx(1.0)


def test_the_area_is_that_of_the_trapezoids():
    curve = precision_recall([0.9, 0.8, 0.7, 0.6], [True, False, True, False])
    assert curve.precision == pytest.approx([1, 1 / 2, 2 / 3, 1 / 2])
    assert curve.recall == pytest.approx([1 / 4, 1 / 4, 2 / 4, 2 / 4])
    assert curve.area == pytest.approx(1 / 4 + 1 / 4 * (1 / 2 + 2 / 3) / 2)


def test_the_order_of_equal_confidences_does_not_matter():
    one, other = (precision_recall([1, 1, 0], right) for right in ([True, False, True], [False, True, True]))
    assert one.precision.tolist() == other.precision.tolist()
    assert one.area == other.area


def test_bins_have_equal_mass():
    p = np.repeat(np.arange(10) / 10, 4) + np.tile([0, 0.01, 0.02, 0.03], 10)
    right = np.tile([0, 0, 0, 1], 10)
    bins = reliability(p, right)
    assert [tuple(each) for each in bins] == [pytest.approx((k / 10 + 0.015, 0.25, 4)) for k in range(10)]
    error = np.mean([abs(k / 10 + 0.015 - 0.25) for k in range(10)])
    assert calibration_error(p, right) == pytest.approx(error)


def test_a_perfect_forecaster_stays_below_its_bound_in_19_of_20_cases():
    rng = np.random.default_rng(3)
    p = rng.uniform(size=400)
    bound = perfect_calibration_error(p)
    below = [calibration_error(p, rng.random(400) < p) <= bound for _ in range(400)]
    assert 0.92 < np.mean(below) < 0.98
    assert calibration_error(p, rng.random(400) < p**3) > bound


def test_few_answers_leave_bins_out():
    assert len(reliability([0.5, 0.6], [1, 0])) == 2


def test_recall_is_of_all_queries_that_can_be_found():
    curve = precision_recall([0.9, 0.8], [True, True], findable=4)
    assert curve.recall == pytest.approx([1 / 4, 2 / 4])
    assert curve.area == pytest.approx(1 / 2)


def test_frequencies_of_a_perfect_forecaster_are_binomial():
    p = np.arange(10) / 10
    low, high = perfect_frequencies(np.repeat(p, 100))
    assert low[0] == high[0] == 0.0  # where scipy before 1.7 errs
    assert low[1:] == pytest.approx(scipy.stats.binom.ppf(0.025, 100, p[1:]) / 100, abs=0.011)
    assert high[1:] == pytest.approx(scipy.stats.binom.ppf(0.975, 100, p[1:]) / 100, abs=0.011)
