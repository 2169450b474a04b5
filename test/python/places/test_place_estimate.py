# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Positions with covariances, against draws, finite differences and distances on the earth."""

import math

import numpy as np
import pytest

from sextant.place_maps.place_map import GeoCorners, MetricFrame, Overview, PlaceMap
from sextant.places.place_estimate import (
    YAW_SIGMA,
    PlaceEstimate,
    estimate,
    geographic_covariance,
    metric_pose,
    scale_of,
)

OVERVIEW = Overview("park.png", 400, 200)
FRAME = MetricFrame("town", 0.05, (7.0, -3.0, 0.6))
# a field of 1000 m x 500 m at 55 degrees north, by the radius of the earth along each axis (WGS 84)
NORTH, WEST = 55.0, 13.0
METRES = {"latitude": 111_325.0, "longitude": 63_994.0}  # a degree there
CORNERS = GeoCorners((NORTH, WEST), (NORTH - 500 / METRES["latitude"], WEST + 1000 / METRES["longitude"]))


def made(georeference):
    return PlaceMap("", OVERVIEW, (), georeference)


def test_one_place_stands_for_its_surroundings():
    found = estimate(np.array([[30.0, 40.0]]), np.array([0.8]), [0.5], np.array([10.0, 4.0]))
    assert (found.x, found.y, found.yaw) == pytest.approx((30.0, 40.0, 0.5))
    assert found.covariance == pytest.approx(np.diag([25.0, 4.0]))


def test_several_places_are_their_mean_and_scatter():
    """Of draws: a place by its probability, and a point around it."""
    positions, probabilities = np.array([[0.0, 0.0], [30.0, 0.0], [0.0, 10.0]]), np.array([0.2, 0.4, 0.1])
    rng = np.random.default_rng(1)
    at = rng.choice(3, 200_000, p=probabilities / probabilities.sum())
    draws = positions[at] + rng.normal(0, 6.0, (len(at), 2))
    found = estimate(positions, probabilities, [None] * 3, np.array([12.0, 12.0]))
    assert (found.x, found.y) == pytest.approx(draws.mean(axis=0), abs=0.1)
    assert found.covariance == pytest.approx(np.cov(draws.T), rel=0.02, abs=0.5)
    assert found.yaw is None


@pytest.mark.parametrize(
    "yaws, expected",
    [
        ([3.1, -3.1, None], math.pi),  # across the seam
        ([0.0, math.pi, 0.0], None),  # against each other
        ([0.2, 0.2, None], 0.2),
        ([None, None, 0.2], None),  # hardly any of the probability knows it
    ],
)
def test_there_is_a_yaw_if_the_photos_agree(yaws, expected):
    found = estimate(np.zeros((3, 2)), np.array([0.4, 0.4, 0.2]), yaws, np.ones(2))
    if expected is None:
        assert found.yaw is None
    else:
        assert math.remainder(found.yaw - expected, 2 * math.pi) == pytest.approx(0, abs=1e-9)


def place(yaw=0.4):
    return PlaceEstimate(120.0, 50.0, np.array([[90.0, 40.0], [40.0, 160.0]]), yaw)


def test_a_pose_lies_in_the_maps_frame():
    """By hand: 120 pixels right, 150 up, turned by 0.6 about the lower left corner."""
    T, _ = metric_pose(FRAME, OVERVIEW, place())
    expected = [
        7.0 + 6.0 * math.cos(0.6) - 7.5 * math.sin(0.6),
        -3.0 + 6.0 * math.sin(0.6) + 7.5 * math.cos(0.6),
    ]
    assert T[:2, 3] == pytest.approx(expected) and T[2, 3] == 0
    assert math.atan2(T[1, 0], T[0, 0]) == pytest.approx(1.0)


def test_the_covariance_of_a_pose_is_carried_by_the_derivative_of_the_position():
    T, covariance = metric_pose(FRAME, OVERVIEW, place())
    step = 1e-3
    J = np.empty((2, 2))
    for axis in range(2):
        moved = [FRAME.position(OVERVIEW, 120 + s * (1 - axis), 50 + s * axis) for s in (step, -step)]
        J[:, axis] = np.subtract(*moved) / (2 * step)
    assert covariance[:2, :2] == pytest.approx(J @ place().covariance @ J.T)
    assert covariance[5, 5] == YAW_SIGMA**2
    assert np.linalg.eigvalsh(covariance).min() > 0
    rng = np.random.default_rng(2)
    pixels = rng.multivariate_normal([120, 50], place().covariance, 50_000)
    drawn = np.cov(np.array([FRAME.position(OVERVIEW, x, y) for x, y in pixels]).T)
    assert covariance[:2, :2] == pytest.approx(drawn, rel=0.05, abs=0.01)


def test_an_unknown_yaw_may_be_any():
    """Uniform in a full turn: its variance is that of the uniform distribution."""
    _, covariance = metric_pose(FRAME, OVERVIEW, place(None))
    assert covariance[5, 5] == pytest.approx((2 * math.pi) ** 2 / 12)


def test_a_georeferenced_map_has_its_size_in_metres():
    assert scale_of(made(CORNERS)) == pytest.approx((1000 / 400, 500 / 200), rel=5e-3)
    assert scale_of(made(FRAME)) == (0.05, 0.05)
    assert scale_of(made(None)) is None


def test_a_geographic_covariance_is_of_metres_east_and_north():
    """100 pixels to the right are 250 m of longitude, 100 down 250 m of latitude less."""
    x, y = 120.0, 50.0
    here, east, south = (CORNERS.coordinates(OVERVIEW, *at) for at in ((x, y), (x + 100, y), (x, y + 100)))
    assert (east[1] - here[1]) * METRES["longitude"] == pytest.approx(250, rel=1e-6)
    assert (south[0] - here[0]) * METRES["latitude"] == pytest.approx(-250, rel=1e-6)
    covariance = geographic_covariance(scale_of(made(CORNERS)), place())
    expected = np.array([[90.0, -40.0], [-40.0, 160.0]]) * 2.5**2
    assert covariance[:2, :2] == pytest.approx(expected, rel=5e-3)
    assert covariance[2, 2] >= 1e6
