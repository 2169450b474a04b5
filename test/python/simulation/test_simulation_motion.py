# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

from sextant.simulation.motion import FigureEight, Motion, Unicycle, free_floor
from sextant.simulation.room_markers import default_map, room_for

EIGHT = FigureEight()


@pytest.mark.parametrize("t", np.linspace(0.0, 20.0, 23))
def test_speeds_of_the_eight_are_its_derivatives(t):
    h = 1e-5
    before, motion, after = EIGHT.at(t - h), EIGHT.at(t), EIGHT.at(t + h)
    velocity = np.array([after.x - before.x, after.y - before.y]) / (2.0 * h)
    assert velocity == pytest.approx(
        motion.speed * np.array([np.cos(motion.yaw), np.sin(motion.yaw)]), abs=1e-6
    )
    turn = np.remainder(after.yaw - before.yaw + np.pi, 2.0 * np.pi) - np.pi
    assert turn / (2.0 * h) == pytest.approx(motion.turn_rate, abs=1e-5)


def test_eight_crosses_itself_and_closes():
    start, crossing, end = EIGHT.at(0.0), EIGHT.at(10.0), EIGHT.at(20.0)
    assert [crossing.x, crossing.y] == pytest.approx([start.x, start.y], abs=1e-12)
    assert np.cos(crossing.yaw - start.yaw) < 0.9
    assert [end.x, end.y, end.yaw] == pytest.approx([start.x, start.y, start.yaw], abs=1e-12)


def test_eight_turns_both_ways():
    rates = [EIGHT.at(t).turn_rate for t in np.linspace(0.0, 20.0, 50)]
    assert min(rates) < -0.2 and max(rates) > 0.2


@pytest.mark.parametrize("turn_rate", [0.0, 1e-9, 0.7, -3.0])
def test_arc_is_the_limit_of_small_steps(turn_rate):
    start, steps = Motion(1.0, 2.0, 0.0, 0.3, 0.5, turn_rate), 20000
    yaws = start.yaw + turn_rate * (np.arange(steps) + 0.5) / steps
    expected = [1.0 + 0.5 * np.mean(np.cos(yaws)), 2.0 + 0.5 * np.mean(np.sin(yaws)), 0.3 + turn_rate]
    moved = start.after(1.0)
    assert [moved.x, moved.y, moved.yaw] == pytest.approx(expected, abs=1e-7)
    assert moved.after(-1.0).pose == pytest.approx(start.pose)


def test_unicycle_obeys_until_the_wall_and_can_turn_there():
    robot = Unicycle(Motion(), free_floor(room_for(default_map(), obstacles=False), 0.2))
    for _ in range(100):
        motion = robot.drive(1.0, 0.0, 0.1)
    stopped = motion.x
    assert (
        2.7 - 1e-6 < stopped < 2.8 + 1e-6 and motion.speed == 0.0
    )  # 0.2 m and less than a step before the wall
    motion = robot.drive(1.0, np.pi, 1.0)
    assert motion.yaw == pytest.approx(np.pi) and motion.turn_rate == np.pi
    motion = robot.drive(1.0, 0.0, 0.5)
    assert motion.x == pytest.approx(stopped - 0.5) and motion.speed == 1.0


def test_obstacles_need_room_for_the_robot():
    room = room_for(default_map())
    box = room.obstacles[0]
    is_free = free_floor(room, 0.2)
    edge = box.center[0] + 0.5 * box.size[0]
    assert not is_free(edge + 0.19, box.center[1]) and is_free(edge + 0.21, box.center[1])
    assert is_free(0.0, 0.0) and not is_free(2.81, 0.0)


def test_default_eight_is_free():
    is_free = free_floor(room_for(default_map()), 0.3)
    assert all(is_free(EIGHT.at(t).x, EIGHT.at(t).y) for t in np.linspace(0.0, 20.0, 500))
