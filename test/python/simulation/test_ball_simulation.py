# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is seen is what lies on the floor at that moment."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from sextant.objects.object_kinds import KINDS
from sextant.simulation.arena_looks import random_light, random_paint
from sextant.simulation.ball_ground import Pillar, RobotParams
from sextant.simulation.ball_simulation import BallSimulation, BallSimulationParams
from sextant.simulation.ball_world import BallWorld, random_world
from sextant.simulation.rgbd_camera import RgbdParams

SMALL = RgbdParams(width=320, height=240)
PILLARS = [Pillar(1.5, 0.4, 0.05, "blue_pillar"), Pillar(1.5, -0.4, 0.05, "blue_pillar")]
HUES = {"ball": (12, 35), "blue_pillar": (95, 130), "green_pillar": (50, 85), "red_pillar": (170, 10)}


def simulation_of(params=None, ball=(1.0, 0.0), pillars=PILLARS):
    world = BallWorld((7.0, 6.0), list(pillars), np.array(ball), np.zeros(3))
    return BallSimulation(world, params or BallSimulationParams(camera=SMALL))


def seen_by_name(simulation, picture):
    return {simulation.class_names[each.object]: each for each in picture.seen}


def share_of_hue(picture, seen, name):
    """Of the pixels in the middle of a box."""
    low, high = (
        np.array(0.75 * seen.low + 0.25 * seen.high, int),
        np.array(0.25 * seen.low + 0.75 * seen.high, int) + 1,
    )
    hues = cv2.cvtColor(picture.colour[low[1] : high[1], low[0] : high[0]], cv2.COLOR_RGB2HSV)[..., 0]
    least, most = HUES[name]
    return np.mean((hues >= least) & (hues <= most) if least < most else (hues >= least) | (hues <= most))


@pytest.mark.slow
@pytest.mark.parametrize("task", [2, 3])
def test_boxes_hold_what_has_the_colour_of_their_class(task):
    names = set()
    for seed in range(8):
        simulation = BallSimulation(
            random_world(task, seed), BallSimulationParams(seed=seed, drive=RobotParams(acceleration=100.0))
        )
        simulation.ground.command(0.0, 2.0)
        for _ in range(6):
            simulation.ground.advance(0.5)
            picture = simulation.take_images()
            for each in picture.seen:
                name, size = simulation.class_names[each.object], each.high - each.low
                if each.pixels > 0.7 * np.prod(size) and size.min() > 8:  # upright and not hidden
                    names.add(name)
                    assert share_of_hue(picture, each, name) > 0.9, (task, seed, name)
    assert names == set(KINDS)


def test_the_picture_follows_the_ball():
    simulation = simulation_of()
    places = []
    for _ in range(2):
        ball, camera = simulation.ground.ball, simulation.camera
        seen = seen_by_name(simulation, simulation.take_images())["ball"]
        at = np.linalg.inv(camera.T_base_colour) @ [*ball, 0.05, 1.0]
        expected = (camera.colour.K @ at[:3])[:2] / at[2]
        np.testing.assert_allclose((seen.low + seen.high - 1) / 2.0, expected, atol=1.0)
        places.append(expected)
        simulation.ground.ball_velocity = np.array([0.5, 0.3])
        simulation.ground.advance(1.0)
    assert np.linalg.norm(places[1] - places[0]) > 20


def test_a_kick_is_seen_and_touched():
    simulation = simulation_of(ball=(0.6, 0.0))
    simulation.ground.command(0.5, 0.0)
    simulation.ground.advance(3.0)
    assert [touch.what for touch in simulation.ground.touches][0] == "ball"
    assert simulation.ground.ball[0] > 1.2


@pytest.mark.slow
def test_light_changes_with_time_and_only_so_much():
    levels = []
    for flicker in (0.0, 0.3):
        simulation = simulation_of(BallSimulationParams(flicker=flicker, seed=3, camera=SMALL))
        levels.append([])
        for _ in range(15):
            levels[-1].append(simulation.take_images().colour.mean())
            simulation.ground.advance(1.0)
    assert np.ptp(levels[0]) < 0.3  # noise
    # of light 0.7 to 1.3 at most, through the curve of the camera
    ratio = max(levels[1]) / min(levels[1])
    assert 1.05 < ratio <= (1.3 / 0.7) ** (1.0 / 2.2) + 0.02


def test_all_follows_its_seed():
    def picture(seed):
        taken = BallSimulation(
            random_world(3, 1), BallSimulationParams(seed=seed, camera=SMALL)
        ).take_images()
        return taken.colour, taken.depth

    for one, same, other in zip(picture(1), picture(1), picture(2)):
        np.testing.assert_array_equal(one, same)
        assert np.mean(one != other) > 0.4


def test_paint_and_light_are_drawn_within_what_can_be():
    random = np.random.default_rng(0)
    lights = [random_light(random) for _ in range(200)]
    for each in lights:
        each.validate()
    brightness = [each.brightness for each in lights]
    assert 0.45 <= min(brightness) < 0.5 and 1.3 < max(brightness) <= 1.4
    for name in KINDS:
        paints = np.array([random_paint(name, random) for _ in range(100)])
        assert np.all((paints >= 0.0) & (paints <= 1.0)) and np.ptp(paints, axis=0).min() > 0.0


def hard_simulation(seed):
    world = random_world(3, seed, strays=4)
    return BallSimulation(world, BallSimulationParams(seed=seed, camera=SMALL, hard=True))


def test_a_hard_world_has_obstacles_that_are_none_of_the_seen_objects():
    for seed in range(3):
        simulation = hard_simulation(seed)
        strays = simulation.ground.pillars[len(simulation.world.pillars) :]
        assert len(strays) == 4 and all(0.0 < each.radius <= 0.06 + 1e-9 for each in strays)
        for _ in range(4):
            assert all(each.object < len(simulation.class_names) for each in simulation.take_images().seen)
            simulation.ground.command(0.0, 2.0)
            simulation.ground.advance(0.8)


def test_a_hard_world_looks_other_than_a_usual_one_but_has_the_same_objects():
    world = random_world(3, 2)._replace(robot=np.array([0.0, 0.0, 0.3]))
    usual, hard = (
        BallSimulation(world, BallSimulationParams(seed=2, camera=SMALL, hard=is_hard))
        for is_hard in (False, True)
    )
    one, other, again = usual.take_images(), hard.take_images(), hard.take_images()
    assert np.mean(one.colour != other.colour) > 0.5 and np.mean(other.colour != again.colour) > 0.1  # noise
    assert [(each.object, *each.low, *each.high) for each in one.seen] == [
        (each.object, *each.low, *each.high) for each in other.seen
    ]


def test_images_of_a_turning_robot_are_blurred_by_its_turn_during_the_exposure():
    images = []
    for turn_rate in (0.0, 3.0):
        simulation = hard_simulation(1)
        post = np.array(simulation.world.pillars[0][:2])
        at, yaw = post * (1.0 - 0.8 / np.linalg.norm(post)), np.arctan2(post[1], post[0])
        robot = replace(simulation.ground.robot, x=at[0], y=at[1], yaw=yaw, turn_rate=turn_rate)
        simulation.ground.robot = robot
        images.append(np.mean([simulation.take_images().colour for _ in range(12)], axis=0)[20:-20, 20:-20])
    focal_length = simulation.camera.colour.K[0, 0]
    length = int(round(3.0 * 0.01 * focal_length))
    expected = cv2.blur(images[0], (length, 1))
    assert length > 5
    assert np.abs(images[1] - expected).mean() < 0.7 * np.abs(images[1] - images[0]).mean()
