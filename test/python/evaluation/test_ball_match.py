# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The whole chain without ROS in one world: pictures in, commands out, judged by the simulation's truth."""

import numpy as np
import pytest
from PIL import Image

from sextant.ball.ball_player import BallPlayerParams
from sextant.evaluation.ball_film import BallFilm
from sextant.evaluation.ball_match import HARD, USUAL, mount_of, play, simulation_of
from sextant.objects.colour_detector import ColourDetector, ColourParams
from sextant.objects.object_locator import ObjectLocatorParams
from sextant.simulation.ball_world import random_world

TASK, SEED = 2, 3
PARAMS = BallPlayerParams(locator=ObjectLocatorParams(depth_scale=1.04))


@pytest.fixture(scope="module")
def played(tmp_path_factory):
    """Its result, its film, what the robot knew, and how the ball moved."""
    film = BallFilm(tmp_path_factory.mktemp("film") / "film.png")
    balls, known = [], []

    def watch(simulation, player, action, picture):
        film.watch(simulation, player, action, picture)
        balls.append(simulation.ground.ball.copy())
        known.append([landmark.position for landmark in player.timeline.slam.filter.landmarks])

    result = play(TASK, SEED, ColourDetector(ColourParams()), PARAMS, watch=watch)
    return result, film, known[-1], np.array(balls)


def in_goal_frame(point):
    """Metres before the goal's line and beside its middle, by arithmetic of this test's own."""
    world = random_world(TASK, SEED)
    left, right = (np.array(post[:2]) for post in world.pillars[:2])
    middle, along = 0.5 * (left + right), (right - left) / np.linalg.norm(right - left)
    out = np.array([-along[1], along[0]])
    out = out if (world.ball - middle) @ out > 0.0 else -out
    return (point - middle) @ out, abs((point - middle) @ along)


@pytest.mark.slow
def test_the_ball_is_through_and_the_robot_stands_before_the_line(played):
    result, _, _, balls = played
    assert result.through and result.pillars == 0 and result.walls == 0
    assert result.stop == pytest.approx(0.2, abs=0.05)
    places = np.array([in_goal_frame(ball) for ball in balls])
    assert places[0, 0] > 0.4 and places[-1, 0] < 0.0
    crossing = np.flatnonzero(places[:, 0] < 0.0)[0]
    assert places[crossing, 1] < 0.5 * 1.2
    assert 5.0 < result.goal_seconds < result.seconds < 60.0


def test_the_goal_is_mapped_as_wide_as_it_is(played):
    world = random_world(TASK, SEED)
    x, y, heading = world.robot
    c, s = np.cos(heading), np.sin(heading)
    found = []
    for post in world.pillars[:2]:
        off = np.array(post[:2]) - [x, y]  # the robot's map begins where it did, and turns as its wheels slip
        expected = np.array([c * off[0] + s * off[1], c * off[1] - s * off[0]])
        found.append(min(played[2], key=lambda each: np.linalg.norm(each - expected)))
    width = np.linalg.norm(np.subtract(*(post[:2] for post in world.pillars[:2])))
    assert np.linalg.norm(found[0] - found[1]) == pytest.approx(width, abs=0.03)


@pytest.mark.slow
def test_a_film_strip_is_a_picture(played):
    film = played[1]
    film.write()
    with Image.open(film._path) as picture:
        assert picture.format == "PNG" and picture.width > 3 * picture.height


def test_a_film_is_a_strip_or_an_animation(tmp_path):
    with pytest.raises(ValueError, match="a film is .png or .gif"):
        BallFilm(tmp_path / "film.mp4")


def test_difficulties_reach_the_world_and_the_software():
    usual, hard = (simulation_of(TASK, SEED, 0, each) for each in (USUAL, HARD))
    assert len(usual.ground.pillars) == len(usual.world.pillars)
    assert len(hard.ground.pillars) == len(hard.world.pillars) + 4
    assert hard.ground.drive.slip == 0.1 and usual.ground.drive.slip == 0.02
    turn = np.array([0.0, HARD.mount_error, 0.0])  # cameras lower their view by 2 degrees
    wrong, right = mount_of(hard, turn), mount_of(hard)
    down = np.rad2deg(
        [np.arctan2(-each[2, 2], each[0, 2]) for each in (wrong.T_base_colour, right.T_base_colour)]
    )
    assert down[0] - down[1] == pytest.approx(2.0, abs=1e-6)
    np.testing.assert_array_equal(wrong.T_base_colour[:, 3], right.T_base_colour[:, 3])


@pytest.mark.slow
def test_images_arrive_later_in_a_hard_world():
    """By the time of the first processed image, seconds."""
    ages = []

    class Ended(Exception):
        pass

    def watch(simulation, player, action, picture):
        ages.append((simulation.ground.stamp, picture is not None))
        if picture is not None:
            raise Ended

    for difficulty in (USUAL, HARD):
        with pytest.raises(Ended):
            play(TASK, SEED, ColourDetector(ColourParams()), PARAMS, watch=watch, difficulty=difficulty)
    first = [stamp for stamp, there in ages if there]
    assert first[1] - first[0] == pytest.approx(0.15)
