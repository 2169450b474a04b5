# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The network that comes with the package."""

import importlib.util

import numpy as np
import pytest

from sextant.detection_scores.average_precision import overlaps
from sextant.objects.object_kinds import KINDS
from sextant.objects.shipped_model import shipped_model
from sextant.objects.yolo_detector import YoloDetector, YoloParams
from sextant.simulation.ball_ground import Pillar
from sextant.simulation.ball_simulation import BallSimulation, BallSimulationParams
from sextant.simulation.ball_world import BallWorld

pytestmark = pytest.mark.skipif(not shipped_model().exists(), reason="no model is shipped")
needs_onnxruntime = pytest.mark.skipif(
    importlib.util.find_spec("onnxruntime") is None, reason="no onnxruntime (optional)"
)
BACKENDS = ["opencv", pytest.param("onnxruntime", marks=needs_onnxruntime)]

PILLARS = [
    Pillar(1.0, 0.25, 0.05, "blue_pillar"),
    Pillar(1.5, -0.2, 0.05, "red_pillar"),
    Pillar(1.8, 0.7, 0.05, "green_pillar"),
]


def picture(seed):
    """What the simulated camera sees of three pillars and a ball."""
    world = BallWorld((8.0, 6.0), PILLARS, np.array([1.2, 0.0]), np.array([-0.2, 0.0, 0.0]))
    simulation = BallSimulation(world, BallSimulationParams(seed=seed))
    return simulation.take_images(), simulation.class_names


def detector(backend, **settings):
    return YoloDetector(YoloParams(str(shipped_model()), backend, **settings), 1)


def test_it_is_small_and_knows_the_kinds():
    assert shipped_model().stat().st_size <= 4e6
    assert detector("opencv").classes == list(KINDS)


@pytest.mark.slow
@pytest.mark.parametrize("backend", BACKENDS)
def test_it_finds_all_that_is_there(backend):
    network, right, detected, total = detector(backend), 0, 0, 0
    for seed in range(10):
        taken, names = picture(seed)
        found = network.detect(taken.colour)
        true = np.array([[*each.low, *each.high] for each in taken.seen])
        classes = [network.classes.index(names[each.object]) for each in taken.seen]
        hit = (overlaps(found.boxes, true) >= 0.5) & (found.classes[:, np.newaxis] == classes)
        right, detected, total = (
            right + hit.any(axis=0).sum(),
            detected + len(found.scores),
            total + len(true),
        )
    assert total >= 40 and right >= 0.95 * total and detected <= 1.05 * total


@needs_onnxruntime
def test_both_runtimes_return_the_same():
    for seed in range(3):
        one, other = (
            detector(name, confidence=0.05).detect(picture(seed)[0].colour)
            for name in ("opencv", "onnxruntime")
        )
        assert one.boxes == pytest.approx(
            other.boxes, abs=4e-3
        )  # 1e-3 pixels of the input, four of the image
        assert one.scores == pytest.approx(other.scores, abs=1e-3)
        assert one.classes.tolist() == other.classes.tolist()
