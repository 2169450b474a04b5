# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

from sextant.objects.circle_fit import TangentPlanes, candidate_ranges, extends_beyond, fit_circle

RADIUS, SIGMA = 0.05, 0.004
NO_PLANES = {k: TangentPlanes(np.zeros((0, k)), np.zeros(0)) for k in (2, 3)}


def surface(middle, n=400, radius=RADIUS):
    """Points of a circle (k = 2) or sphere (3) as a camera in the origin sees them, evenly over its width."""
    middle = np.asarray(middle, float)
    k, far = len(middle), np.linalg.norm(middle)
    toward = middle / far
    aside = np.linalg.svd(toward[np.newaxis])[2][1:]
    offsets = np.random.default_rng(2).uniform(-radius, radius, (4 * n, k - 1))
    rays = far * toward + offsets @ aside
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    along = rays @ middle
    square = radius**2 - far**2 + along**2
    seen = square > 0
    return (rays[seen] * (along[seen] - np.sqrt(square[seen]))[:, np.newaxis])[:n]


def tangents(middle, sigma=0.005):
    """Both that touch a circle."""
    far = np.linalg.norm(middle)
    bearing, half = np.arctan2(middle[1], middle[0]), np.arcsin(RADIUS / far)
    left, right = bearing + half, bearing - half
    normals = np.array([[np.sin(left), -np.cos(left)], [-np.sin(right), np.cos(right)]])
    return TangentPlanes(normals, np.full(2, sigma))


@pytest.mark.parametrize("middle", [(0.6, 0.1), (2.0, -0.8), (0.7, 0.1, -0.2), (2.0, 0.5, -0.25)])
def test_exact_points_give_the_exact_centre(middle):
    start = np.array(middle) * 1.01
    found = fit_circle(surface(middle), start, RADIUS, NO_PLANES[len(middle)], SIGMA, 1.0)
    np.testing.assert_allclose(found.position, middle, atol=1e-6)


@pytest.mark.parametrize("middle", [(1.0, 0.2), (2.5, -1.0), (1.5, 0.3, -0.25)])
def test_ranges_are_those_of_objects_on_the_line_of_sight(middle):
    far = np.linalg.norm(middle)
    before, behind = (surface(np.array(middle) * share, 150) for share in (0.6, 1.5))
    points = np.vstack([before[:50], surface(middle), behind])
    found = candidate_ranges(points, np.array(middle) / far, RADIUS, SIGMA, 20)
    np.testing.assert_allclose(found[:2], [far, 1.5 * far], rtol=1e-3)
    assert candidate_ranges(points[:10], np.array(middle) / far, RADIUS, SIGMA, 20) == []


def test_other_objects_do_not_bias_the_fit():
    middle = np.array([1.5, 0.4])
    floor = np.random.default_rng(1).uniform([0.8, 0.2], [2.5, 0.6], (150, 2))
    points = np.vstack([surface(middle), surface(middle * 0.7, 100), floor])
    found = fit_circle(points, middle * 1.01, RADIUS, tangents(middle), SIGMA, 1.0)
    np.testing.assert_allclose(found.position, middle, atol=0.004)


def test_one_side_and_a_strip_of_it_suffice():
    middle = np.array([1.5, 0.4])
    whole = tangents(middle)
    points = surface(middle)
    strip = points[points @ whole.normals[0] < 0.4 * RADIUS]
    one = TangentPlanes(whole.normals[:1], whole.sigmas[:1])
    found = fit_circle(strip, middle + [0.03, 0.03], RADIUS, one, SIGMA, 1.0)
    np.testing.assert_allclose(found.position, middle, atol=0.002)
    both = fit_circle(points, middle, RADIUS, whole, SIGMA, 1.0)
    assert found.covariance.trace() > both.covariance.trace()


@pytest.mark.parametrize("middle", [(0.8, 0.1), (2.0, -0.5)])
def test_the_covariance_is_that_of_many_fits(middle):
    random, errors, nees = np.random.default_rng(4), [], []
    far, planes = np.linalg.norm(middle), tangents(middle)
    for _ in range(400):
        points = surface(middle, 60)
        noise = SIGMA * far**2 * random.standard_normal(60)
        points = points * (1.0 + noise / np.linalg.norm(points, axis=1))[:, np.newaxis]
        shifts = planes.sigmas * random.standard_normal(2)  # of a tangent: it turns about the camera
        turns = shifts / far
        normals = np.array(
            [[[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]] @ n for a, n in zip(turns, planes.normals)]
        )
        fit = fit_circle(points, np.array(middle), RADIUS, TangentPlanes(normals, planes.sigmas), SIGMA, 1.0)
        errors.append(fit.position - middle)
        nees.append(errors[-1] @ np.linalg.solve(fit.covariance, errors[-1]))
    assert abs(np.mean(errors, axis=0)).max() < 0.002 * far
    assert 0.7 < np.mean(nees) / 2 < 1.3


def test_correlated_noise_increases_the_covariance():
    points = surface((1.5, 0.4))
    alone, lumps = (
        fit_circle(points, points[0], RADIUS, NO_PLANES[2], SIGMA, correlated) for correlated in (1.0, 49.0)
    )
    np.testing.assert_allclose(lumps.covariance, 49.0 * alone.covariance, rtol=1e-6)


def test_a_wall_extends_beyond_its_tangents_and_a_pillar_does_not():
    middle = np.array([1.5, 0.0])
    wall = np.column_stack([np.full(400, 1.45), np.linspace(-0.3, 0.3, 400)])
    for points, is_wall in ((wall, True), (surface(middle), False)):
        fit = fit_circle(points, middle, RADIUS, tangents(middle), SIGMA, 1.0)
        assert extends_beyond(points, fit, RADIUS, tangents(middle), SIGMA) == is_wall
    assert fit_circle(wall + [1.0, 0.0], middle, RADIUS, tangents(middle), SIGMA, 1.0) is None
    assert tangents(middle).agree(middle, RADIUS) and not tangents(middle).agree(middle + [0.0, 0.1], RADIUS)
