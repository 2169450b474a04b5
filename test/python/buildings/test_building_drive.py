# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Drives through the building: by the plan of the building and by the commands."""

import numpy as np
import pytest

from sextant.buildings.building_drive import CARRIED, BuildingDrive, BuildingDriveParams
from sextant.geometry.plane_poses import composed, in_frame, relative, wrapped
from sextant.simulation.building import CAMERA_RANGE, CLASSES, Building
from sextant.simulation.odometry import OdometryNoise

BUILDING = Building()
EXACT = OdometryNoise(0.0, 0.0, 0.0)


def drive(**settings):
    return BuildingDrive(BuildingDriveParams(**settings), BUILDING)


def planar(motion):
    return np.array([motion.x, motion.y, motion.yaw])


def test_the_rounds_stay_inside_and_odometry_measures_them():
    robot = drive(seed=3, odometry=EXACT)
    steps = [robot.step() for _ in range(400)]
    poses = np.array([planar(step.truth) for step in steps])
    assert BUILDING.is_inside(poses[:, :2]).all()
    assert np.hypot(*np.diff(poses[:, :2], axis=0).T).sum() > 5.0
    moved = relative(poses[0], poses[-1])
    measured = relative(*(planar(step.odometry.motion) for step in (steps[0], steps[-1])))
    np.testing.assert_allclose(measured[:2], moved[:2], atol=0.05)
    assert wrapped(measured[2] - moved[2]) == pytest.approx(0.0, abs=1e-6)


def test_commands_move_the_robot_up_to_a_wall():
    robot = drive(seed=1)
    start = robot.pose
    for _ in range(20):
        robot.step((0.0, 0.5))
    assert robot.pose == pytest.approx([*start[:2], start[2] + 0.5])
    for _ in range(2000):
        step = robot.step((1.0, 0.0))
    assert step.truth.speed == 0.0
    x, y, _ = composed(robot.pose, np.array([0.05, 0.0, 0.0]))
    assert robot.is_free(*robot.pose[:2]) and not robot.is_free(x, y)


def test_kidnapping_does_not_move_odometry():
    robot = drive(seed=2)
    before = robot.step()
    distance = robot.carry()
    after = robot.step()
    assert distance > CARRIED
    assert np.hypot(*(planar(after.truth) - planar(before.truth))[:2]) == pytest.approx(distance, abs=0.1)
    np.testing.assert_allclose(planar(after.odometry.motion), planar(before.odometry.motion), atol=0.1)
    assert BUILDING.is_inside(robot.pose[:2])


def test_pillars_are_observed_where_they_are():
    robot = drive(seed=4, images_every=5)
    steps = [robot.step() for _ in range(600)]
    assert [step.pillars is not None for step in steps[:10]] == [True, False, False, False, False] * 2
    found = 0
    for step in steps:
        for seen in step.pillars or []:
            true = in_frame(planar(step.truth), BUILDING.pillars)
            nearest = np.linalg.norm(true - seen.observation.position, axis=1).argmin()
            off = true[nearest] - seen.observation.position
            covariance = np.array(seen.observation.covariance)[:2, :2]
            assert off @ np.linalg.solve(covariance, off) < 25.0
            assert np.hypot(*true[nearest]) < CAMERA_RANGE and seen.label.class_name in CLASSES
            found += 1
    assert found > 20


def test_the_same_seed_gives_the_same_drive():
    one, same, other = (drive(seed=seed) for seed in (5, 5, 6))
    for _ in range(30):
        steps = [each.step() for each in (one, same, other)]
    assert steps[0].truth == steps[1].truth != steps[2].truth
    np.testing.assert_array_equal(one.image(), same.image())
    assert one.image().shape == (480, 640)
