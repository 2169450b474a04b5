# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The simulated building and rounds through it, by what is drawn on the plan."""

import numpy as np
import pytest

from sextant.geometry.plane_poses import composed, relative, wrapped
from sextant.simulation.building import (
    LENGTH,
    LOWER,
    UPPER,
    Building,
    landmark_map,
    observed_markers,
    observed_pillars,
)
from sextant.simulation.building_round import BuildingRound, RoundParams

BUILDING = Building(1)


def steps(**settings):
    return list(BuildingRound(BUILDING, RoundParams(**{"duration": 120.0, "kidnappings": 1, **settings})))


@pytest.mark.parametrize(
    "point, inside",
    [
        ((10, 4), True),
        ((10, 10), False),  # between the corridors
        ((20, 10), True),
        ((7, 1), True),
        ((7, 2.9), True),  # in the door
        ((9, 2.9), False),  # in the wall beside it
        ((7, 19), True),
        ((-1, 4), False),
    ],
)
def test_where_the_robot_can_be(point, inside):
    assert BUILDING.is_inside(np.array(point, dtype=float)) == inside


def test_walls_hide_what_is_behind_them():
    targets = np.array([[12.0, 4.0], [10.0, 16.0], [7.0, 0.0], [20.0, 12.0]])
    assert BUILDING.sees(np.array([10.0, 4.0]), targets).tolist() == [True, False, False, False]
    assert BUILDING.sees(np.array([7.0, 4.0]), targets).tolist() == [True, False, True, False]


def test_walls_are_between_inside_and_outside():
    """Their lengths: outside of the corridors but doors, two blocks between them, eight rooms with doors."""
    walls = BUILDING.walls()
    lengths = [np.linalg.norm(wall.right - wall.left) for wall in walls]
    rooms = 8 * (2 * 6 + 2 * 5.8 - 1.2 + 2 * 0.2)
    assert sum(lengths) == pytest.approx(2 * (40 - 4 * 1.2) + 2 * 14 + 2 * 54 + rooms)
    for wall, length in zip(walls, lengths):
        across = (wall.right - wall.left) / length
        front = np.array([across[1], -across[0]])
        for share in (0.01, 0.5, 0.99):
            at = (1 - share) * wall.left + share * wall.right
            assert BUILDING.is_inside(at + 0.02 * front) and not BUILDING.is_inside(at - 0.02 * front)


def test_the_twin_of_a_pose_looks_the_same():
    rng = np.random.default_rng(0)
    for node in BUILDING.nodes:
        twin = BUILDING.twin(np.array([*node, 0.3]))
        assert BUILDING.is_inside(twin[:2])
        directions = rng.uniform(-np.pi, np.pi, 30)
        for direction in directions:
            ahead = 3.0 * np.array([np.cos(direction), np.sin(direction)])
            there = BUILDING.sees(twin[:2], (twin[:2] - ahead)[None])[0]
            assert BUILDING.sees(node, (node + ahead)[None])[0] == there
    assert BUILDING.twin(np.array([0.0, LOWER, 0.0])) == pytest.approx([LENGTH, UPPER, np.pi])


def test_a_marker_is_read_from_its_front():
    (first,) = (marker for marker in BUILDING.markers if marker.id == 0)
    front = composed(first.pose, np.array([2.0, 0.0, np.pi]))
    assert [marker.id for marker in BUILDING.visible_markers(front)] == [0]
    assert BUILDING.visible_markers(np.array([*front[:2], first.pose[2]])) == []  # looks away
    far = composed(first.pose, np.array([6.0, 0.0, np.pi]))
    assert BUILDING.visible_markers(far) == []


def test_observations_have_the_noise_that_they_state():
    rng, distances = np.random.default_rng(3), []
    landmarks, labels, covariance = landmark_map(BUILDING, rng, sigma=1e-9)
    assert len(covariance) == 3 + sum(2 if each.heading is None else 3 for each in landmarks)
    for step in steps(duration=400.0)[::7]:
        for seen in observed_pillars(BUILDING, step.pose, rng) + observed_markers(BUILDING, step.pose, rng):
            same = [each for each, label in zip(landmarks, labels) if label == seen.label]
            expected = [relative(step.pose, np.array([*each.position, 0.0]))[:2] for each in same]
            off = min((seen.observation.position - each for each in expected), key=np.linalg.norm)
            distances.append(off @ np.linalg.solve(seen.observation.covariance[:2, :2], off))
    assert len(distances) > 200 and np.mean(distances) / 2 == pytest.approx(1.0, abs=0.15)


def test_the_robot_stays_inside_and_is_carried_once():
    done = steps(seed=4)
    assert all(BUILDING.is_inside(step.pose[:2]) for step in done)
    jumps = [np.hypot(*(b.pose - a.pose)[:2]) > 0.2 for a, b in zip(done, done[1:])]
    assert sum(jumps) <= 1 == sum(step.is_kidnapped for step in done)
    assert [b.is_kidnapped for b in done[1:]] == jumps or not any(jumps)


def test_odometry_is_off_by_its_scale():
    done = steps(seed=5, kidnappings=0, duration=300.0)
    true = sum(np.hypot(*(b.pose - a.pose)[:2]) for a, b in zip(done, done[1:]))
    measured = sum(np.hypot(*(b.T_odom_base - a.T_odom_base)[:2]) for a, b in zip(done, done[1:]))
    assert measured / true == pytest.approx(1.05, abs=0.03)


def test_the_answers_of_photos_are_calibrated():
    claimed, right = [], []
    for seed in range(8):
        for step in steps(seed=seed, duration=300.0, kidnappings=0):
            if step.places:
                pose, _, probability = step.places[0]
                claimed.append(probability)
                is_near = np.hypot(*(pose - step.pose)[:2]) < 2.0
                right.append(is_near and abs(wrapped(pose[2] - step.pose[2])) < 0.5)
                assert sum(place[2] for place in step.places) <= 1.0
    assert np.mean(claimed) == pytest.approx(np.mean(right), abs=0.08)


def test_a_round_is_the_same_each_time():
    for a, b in zip(steps(seed=9), steps(seed=9)):
        assert np.array_equal(a.pose, b.pose) and np.array_equal(a.T_odom_base, b.T_odom_base)
