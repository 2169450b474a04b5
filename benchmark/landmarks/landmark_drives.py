# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Conversions of the simulated world to types of the core."""

from typing import List

import numpy as np

import sextant
from landmarks.textbook_filter import TextbookFilter
from sextant.geometry.plane_poses import wrapped
from sextant.simulation.landmark_world import LandmarkWorldParams, SimulatedObservation

EXACT = 1e-8 * np.eye(3)  # covariance of a known pose: square metres and radians


def make_filter(form: str, pose: np.ndarray, covariance: np.ndarray):
    """sextant.LandmarkFilter, or for the form additive the textbook's filter."""
    if form == "additive":
        return TextbookFilter(pose, covariance)
    return sextant.LandmarkFilter(sextant.LandmarkFilterParams(), pose, covariance)


def slam_params(world: LandmarkWorldParams):
    """sextant.LandmarkSlamParams with the sensor of the world, which has no occlusion."""
    params = sextant.LandmarkSlamParams()
    params.sensor.max_range, params.sensor.field_of_view = world.max_range, world.field_of_view
    params.sensor.detection_probability = min(world.detection_probability, 0.99)
    params.sensor.false_alarm_probability = max(world.false_alarm_probability, 0.001)
    params.sensor.landmark_width = 0.0
    return params


def observation_2d(seen: SimulatedObservation):
    """sextant.Observation2D."""
    return sextant.Observation2D(seen.position, seen.covariance)


def labelled(observations: List[SimulatedObservation]) -> list:
    """sextant.LabelledObservation of each."""
    return [
        sextant.LabelledObservation(sextant.LandmarkLabel(seen.class_name), observation_2d(seen))
        for seen in observations
    ]


def pose_error(truth: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """(3,) x, y, heading in the map frame; the heading in [-pi, pi)."""
    error = truth - pose
    error[2] = wrapped(error[2])
    return error


def nees(error: np.ndarray, covariance: np.ndarray) -> float:
    """Normalized estimation error squared."""
    return float(error @ np.linalg.solve(covariance, error))


def rms(squares: np.ndarray) -> float:
    """Root of the mean of squared lengths."""
    return float(np.sqrt(np.mean(squares)))
