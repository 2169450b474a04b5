# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Objects in simulated images whose positions are known."""

import numpy as np
import pytest

import sextant
from sextant.objects.object_kinds import ObjectKind
from sextant.simulation.ball_ground import Pillar
from sextant.simulation.ball_simulation import BallSimulation, BallSimulationParams
from sextant.simulation.ball_world import BallWorld
from sextant.simulation.rgbd_camera import RgbdParams

WORLD = BallWorld(
    (8.0, 6.0),
    [Pillar(1.2, 0.35, 0.05, "blue_pillar"), Pillar(1.6, -0.4, 0.05, "red_pillar")],
    np.array([1.1, 0.0]),
    np.array([-0.2, 0.0, 0.0]),
)
TRUTH = {"ball": (1.3, 0.0), "blue_pillar": (1.4, 0.35), "red_pillar": (1.8, -0.4)}  # from the robot


@pytest.fixture(scope="module")
def taken():
    simulation = BallSimulation(WORLD, BallSimulationParams(seed=5, camera=RgbdParams(depth_scale=1.0)))
    return simulation.camera, simulation.take_images()


def test_objects_are_detected_with_their_boxes(taken):
    camera, images = taken
    found = sextant.detect_objects(images.colour)
    assert {each.class_name for each in found} == set(TRUTH)
    assert [each.score for each in found] == sorted((each.score for each in found), reverse=True)
    names = ["blue_pillar", "red_pillar", "ball"]
    for seen in images.seen:
        box = next(each.box for each in found if each.class_name == names[seen.object])
        np.testing.assert_allclose(box, [*seen.low, *seen.high], atol=8)
    assert len(sextant.detect_objects(images.colour, max_objects=1)) == 1


def test_objects_are_located_on_the_floor(taken):
    camera, images = taken
    colour, depth = sextant.CameraModel(camera.colour), sextant.CameraModel(camera.depth)
    T_camera_depth = np.linalg.inv(camera.T_base_colour) @ camera.T_base_depth
    arguments = (images.colour, images.depth, colour, camera.T_base_colour, depth, T_camera_depth)
    found = sextant.locate_objects(*arguments)
    for each in found:
        error = each.position - TRUTH[each.class_name]
        assert np.linalg.norm(error) < 0.05
        assert error @ np.linalg.solve(each.covariance, error) < 20
    kinds = {"ball": ObjectKind("ball", 0.05)}
    found = sextant.locate_objects(*arguments, kinds=kinds)
    assert {each.class_name for each in found if each.position is not None} == {"ball"}


def test_images_that_do_not_fit_are_refused(taken):
    camera, images = taken
    colour = sextant.CameraModel(camera.colour)
    with pytest.raises(ValueError, match="the image has 640 × 479 pixels, its camera 640 × 480"):
        sextant.locate_objects(images.colour[:-1], images.depth, colour, camera.T_base_colour)
    with pytest.raises(ValueError, match="uint8"):
        sextant.detect_objects(images.colour[:, :, 0])
    with pytest.raises(ValueError, match="settings: .*confidense"):
        sextant.detect_objects(images.colour, confidense=0.5)
    with pytest.raises(OSError, match="nowhere.onnx"):
        sextant.detect_objects(images.colour, "nowhere.onnx")
