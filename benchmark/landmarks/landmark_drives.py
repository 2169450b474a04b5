# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Drives in the simulated world, as the core takes them."""

from typing import List

import numpy as np

import sextant
from landmarks.textbook_filter import TextbookFilter
from sextant.geometry.plane_poses import wrapped
from sextant.simulation.landmark_world import LandmarkWorldParams, SeenLandmark

EXACT = 1e-8 * np.eye(3)  # covariance of a pose that is known: square metres and radians


def begun_filter(form: str, pose: np.ndarray, covariance: np.ndarray):
    """sextant.LandmarkFilter, or for the form additive that of textbooks."""
    if form == "additive":
        return TextbookFilter(pose, covariance)
    return sextant.LandmarkFilter(sextant.LandmarkFilterParams(), pose, covariance)


def slam_params(world: LandmarkWorldParams):
    """sextant.LandmarkSlamParams with the world's sensor: no landmark hides another there."""
    params = sextant.LandmarkSlamParams()
    params.sensor.max_range, params.sensor.field_of_view = world.max_range, world.field_of_view
    params.sensor.detection = min(1 - world.missed, 0.99)
    params.sensor.phantom = max(world.phantoms, 0.001)
    params.sensor.width = 0.0
    return params


def plane_sighting(seen: SeenLandmark):
    """sextant.PlaneSighting."""
    return sextant.PlaneSighting(seen.position, seen.covariance)


def labelled(sightings: List[SeenLandmark]) -> list:
    """sextant.LabelledSighting of each."""
    return [
        sextant.LabelledSighting(sextant.LandmarkLabel(seen.class_name), plane_sighting(seen))
        for seen in sightings
    ]


def pose_error(truth: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """(3,) x, y, heading in the map's axes; the heading in [-pi, pi)."""
    error = truth - pose
    error[2] = wrapped(error[2])
    return error


def nees(error: np.ndarray, covariance: np.ndarray) -> float:
    """Normalized estimation error squared."""
    return float(error @ np.linalg.solve(covariance, error))


def rms(squares: np.ndarray) -> float:
    """Root of the mean of squared lengths."""
    return float(np.sqrt(np.mean(squares)))
