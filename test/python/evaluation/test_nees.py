# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
from random_drives import pose, random_drive
from scipy.stats import chi2

import sextant
from sextant.evaluation.nees import nees, nees_band
from sextant.evaluation.trajectory_metrics import aligned, aligned_covariances


def perturbed_drive(seed, count, scale):
    """Poses whose errors have the returned covariance, times scale."""
    random = np.random.default_rng(seed)
    truth = random_drive(random, count)
    estimate, covariances = {}, {}
    for stamp, T in truth.items():
        root = random.normal(0.0, 0.02, (6, 6))
        covariances[stamp] = root @ root.T + 1e-6 * np.eye(6)
        xi = np.linalg.cholesky(scale * covariances[stamp]) @ random.normal(size=6)
        estimate[stamp] = sextant.perturbed(T, -xi)
    return truth, estimate, covariances


@pytest.mark.parametrize("seed", range(3))
def test_honest_covariances_are_consistent(seed):
    truth, estimate, covariances = perturbed_drive(seed, 200, 1.0)
    found = nees(truth, estimate, covariances)
    assert found.values.shape == (200,)
    assert 0.0005 < chi2.cdf(200 * found.mean, 1200) < 0.9995
    assert not nees(*perturbed_drive(seed, 200, 2.0)).consistent
    assert not nees(*perturbed_drive(seed, 200, 0.5)).consistent


def test_nees_of_known_errors():
    truth = {1: pose(1.0), 2: pose(rotvec=(0.0, 0.0, 0.3)), 3: pose()}
    estimate = {1: pose(0.8), 2: pose(), 3: pose(9.0), 4: pose()}
    covariances = {1: np.diag([0.01] * 6), 2: np.diag([1.0] * 5 + [0.04]), 4: np.eye(6)}
    assert nees(truth, estimate, covariances).values == pytest.approx([4.0, 2.25])
    nothing = nees({}, {}, {})
    assert np.isnan([nothing.mean, *nothing.band]).all() and not nothing.consistent


def test_nees_does_not_depend_on_the_frame():
    truth, estimate, covariances = perturbed_drive(5, 20, 1.0)
    T = pose(1.0, 2.0, 3.0, (0.4, -1.0, 2.0))
    moved = nees(aligned(T, truth), aligned(T, estimate), aligned_covariances(T, covariances))
    assert moved.values == pytest.approx(nees(truth, estimate, covariances).values)


@pytest.mark.parametrize("covariance", [np.zeros((6, 6)), -np.eye(6), np.full((6, 6), np.nan)])
def test_nees_of_no_covariance(covariance):
    with pytest.raises(ValueError, match="the covariance at 7 ns is not positive"):
        nees({7: pose()}, {7: pose()}, {7: covariance})


def test_band():
    assert nees_band(1) == pytest.approx((chi2.ppf(0.025, 6), chi2.ppf(0.975, 6)))
    low, high = nees_band(50)
    assert chi2.cdf(50 * high, 300) - chi2.cdf(50 * low, 300) == pytest.approx(0.95)
