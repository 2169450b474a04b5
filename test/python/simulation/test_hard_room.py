# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Furniture and objects without a class that a camera can see, and that look like none of a class."""

import numpy as np
import pytest

import sextant
from sextant.simulation.camera import camera_calibration, camera_mount
from sextant.simulation.hard_room import furniture, hard_light, hard_scene, random_colour, stray_object

PLACE = np.array([1.0, -0.5])
SHAPES = sextant.ArenaObject.Shape


def seen_in(scene, pitch=0.3):
    camera = sextant.ArenaCamera(
        sextant.ArenaCameraParams(), sextant.CameraModel(camera_calibration(160, 120))
    )
    return camera.take(scene, camera_mount([-1.0, 0.0, 0.5], [0.0, pitch, 0.0]), 0)


def test_a_scene_is_that_of_its_seed():
    one, same, other = (
        seen_in(hard_scene(np.random.default_rng(seed), (6.0, 5.0), 2.5))[0] for seed in (3, 3, 4)
    )
    np.testing.assert_array_equal(one, same)
    assert np.mean(one != other) > 0.5


@pytest.mark.parametrize("seed", range(8))
def test_furniture_stands_on_the_floor_and_can_be_seen(seed):
    random = np.random.default_rng(seed)
    scene = hard_scene(random, (6.0, 5.0), 2.5)
    scene.set_light(hard_light(random))
    parts = furniture(random, PLACE)
    scene.set_objects(parts)
    assert min(each.position[2] for each in parts) == 0.0
    assert all(np.linalg.norm(each.position[:2] - PLACE) < 1.2 for each in parts)
    seen = seen_in(scene)[1]
    assert sum(each.pixels for each in seen) > 50


def is_like_a_pillar(each):
    """Pillars are cylinders, or look like them, of 1.25 to 10 times their width."""
    width = 2.0 * each.radius if each.shape == SHAPES.pillar else min(each.sides)
    return each.shape != SHAPES.ball and 1.25 < each.height / width < 10.0 and width < 0.2


@pytest.mark.parametrize("largest", [np.inf, 0.06])
def test_no_stray_object_is_one_of_a_class(largest):
    random, kinds = np.random.default_rng(0), set()
    for _ in range(300):
        each = stray_object(random, PLACE, largest)
        kinds.add(each.shape)
        assert not is_like_a_pillar(each) and each.reach <= largest + 1e-9 and 0.0 <= each.dirt <= 1.0
        if each.shape == SHAPES.ball:  # the ball's colour has much more green than blue and is not green
            assert not (
                each.colour[0] > 0.4 and each.colour[1] > 3.0 * each.colour[2] and each.colour[1] > 0.2
            )
            assert each.position[2] == each.radius
    assert kinds == {SHAPES.ball, SHAPES.pillar, SHAPES.box}


def test_no_furniture_has_a_pillar_in_the_colour_of_one():
    random = np.random.default_rng(0)
    for _ in range(100):
        for each in furniture(random, PLACE):
            vivid = max(each.colour) > 3.0 * np.median(each.colour)
            assert not (each.shape == SHAPES.pillar and is_like_a_pillar(each) and vivid)


def test_colours_are_reflectances():
    random = np.random.default_rng(0)
    colours = np.array([random_colour(random) for _ in range(300)])
    assert colours.min() >= 0.0 and colours.max() <= 1.0 and colours.std(axis=0).min() > 0.1
