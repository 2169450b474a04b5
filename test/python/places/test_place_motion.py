# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Motion along photos on a line, whose steps are known."""

import numpy as np
import pytest

from sextant.places.place_belief import BeliefParams, PlaceBelief
from sextant.places.place_motion import LAYERS, VELOCITIES, PlaceMotion, layer_prior

COUNT, SPACING = 40, 3.0
LINE = np.c_[SPACING * np.arange(COUNT), np.zeros(COUNT)]


def moved(persistence=1.0, distance=None, begin=20):
    """Where a robot at a place goes, by layer: (LAYERS, COUNT)."""
    layers = np.zeros((LAYERS, COUNT))
    layers[:, begin] = 1.0
    return PlaceMotion(LINE, 4.0, persistence, 0.1).predict(layers, distance)


def test_each_layer_moves_by_its_velocity():
    means = moved() @ np.arange(COUNT)
    assert means == pytest.approx([*(20 + VELOCITIES), 20], abs=0.1)


def test_odometry_replaces_the_velocities_and_keeps_their_directions():
    layers = moved(distance=5 * SPACING)
    assert layers[:-1] @ np.arange(COUNT) == pytest.approx(20 + 5 * np.sign(VELOCITIES), abs=0.1)
    standing, moving = layers[:-1][VELOCITIES == 0][0], layers[[0, -2]]
    assert standing == pytest.approx(moving.mean(axis=0))
    assert layers[-1, [15, 25]].sum() > 0.5 and layers[-1, 20] < 1e-3


@pytest.mark.parametrize("distance", [None, 0.0, 7.0, 1000.0])
def test_nothing_is_lost(distance):
    assert moved(0.9, distance).sum() == pytest.approx(LAYERS)


def test_layers_change_with_the_probability_that_remains():
    layers = np.zeros((LAYERS, COUNT))
    layers[2, 20] = 1.0
    shares = PlaceMotion(LINE, 4.0, 0.79, 0.1).predict(layers, None).sum(axis=1)
    assert shares == pytest.approx(0.21 * layer_prior() + np.where(np.arange(LAYERS) == 2, 0.79, 0.0))


def test_slow_motion_is_more_probable():
    prior = layer_prior()
    assert prior.sum() == pytest.approx(1) and (prior > 0).all()
    order = np.argsort(np.abs(VELOCITIES), kind="stable")
    assert (np.diff(prior[:-1][order]) <= 0).all()


def test_a_velocity_is_learned_from_images():
    """After some images of a drive with one place per image, the belief moves on without images."""
    belief = PlaceBelief(LINE, BeliefParams(evidence_exponent=1.0, evidence_penalty=0.0))
    for step, expected in ((1, 28), (-1, 12)):
        belief.reset()
        for place in range(20 - 8 * step, 20 + step, step):
            belief.predict()
            ratios = np.zeros(COUNT)
            ratios[place] = 6.0
            belief.update(ratios)
        for _ in range(8):
            belief.predict()
        assert belief.places.argmax() == pytest.approx(expected, abs=1)


def test_drives_are_not_connected_by_the_gap_between_them():
    """Two drives far apart: a step from the end of the first one does not lead to the second one."""
    apart = np.r_[LINE, LINE + [0, 500]]
    layers = np.zeros((LAYERS, 2 * COUNT))
    layers[:, COUNT - 1] = 1.0
    assert PlaceMotion(apart, 4.0, 0.95, 0.1).predict(layers, None)[:, COUNT:].sum() < 1e-6
