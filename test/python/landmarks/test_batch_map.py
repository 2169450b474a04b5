# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps by all observations of simulated drives, whose truth is known."""

import numpy as np
import pytest

import sextant
from sextant.geometry.plane_poses import composed, in_frame, relative
from sextant.landmarks.batch_map import batch_map
from sextant.landmarks.slam_run import SlamRun
from sextant.simulation.landmark_world import LandmarkWorld, LandmarkWorldParams

SEEDS = range(6)


def run_on(world, params=None, begin=0.0, run=None):
    """A SlamRun on a drive, and the robot's true poses (3,) by stamp in nanoseconds."""
    run = run or SlamRun(params or sextant.LandmarkSlamNodeParams())
    odometry, truth = np.zeros(3), {}
    run.odometry(round(1e9 * begin), odometry)
    for step in world.steps():
        stamp, odometry = round(1e9 * (begin + step.stamp)), composed(odometry, step.odometry_step)
        run.odometry(stamp, odometry)
        truth[stamp] = relative(world.start, step.pose)
        if step.scan:
            run.observe(stamp, [labelled(each) for each in step.scan.observations], np.zeros(3))
    return run, truth


def labelled(seen):
    observation = sextant.Observation2D(seen.position, seen.covariance)
    return sextant.LabelledObservation(sextant.LandmarkLabel(seen.class_name), observation)


def world_of(seed, **settings):
    return LandmarkWorld(LandmarkWorldParams(seed=seed, **{"duration": 120.0, "landmarks": 12, **settings}))


def errors_of(landmark_map, world):
    """(m, 2) of each landmark from the nearest true one of its class."""
    truth, errors = in_frame(world.start, world.positions), []
    for landmark, label in zip(landmark_map.landmarks, landmark_map.labels):
        same = truth[[name == label.class_name for name in world.classes]]
        errors.append(min(same - landmark.position, key=np.linalg.norm))
    return np.array(errors)


def rms(errors):
    return float(np.sqrt(np.mean(np.square(errors))))


@pytest.fixture(scope="module")
def drives():
    """(world, filter's result, result by all observations, true poses) of each seed."""
    params = sextant.LandmarkSlamNodeParams()
    params.rotation_from_rotation = 0.03  # as it is drawn
    results = []
    for seed in SEEDS:
        world = world_of(seed)
        run, truth = run_on(world, params)
        results.append((world, run.result(), batch_map(run), truth))
    return results


def test_landmarks_are_where_they_are(drives):
    online, batch = [], []
    for world, filtered, made, _ in drives:
        online.extend(errors_of(filtered.map, world))
        batch.extend(errors_of(made.map, world))
        assert len(made.map.landmarks) <= len(world.positions)
        assert len(made.observations) == len(made.map.landmarks) and min(made.observations) > 0
    assert rms(batch) < min(0.2, rms(online))


def test_the_robots_path_is_better_than_online(drives):
    online, batch = [], []
    for _, filtered, made, truth in drives:
        for result, errors in ((filtered, online), (made, batch)):
            robot = result.segments[0].robot
            errors += [pose[:2] - truth[stamp][:2] for stamp, pose in robot.items() if stamp in truth]
    assert rms(batch) < 0.8 * rms(online)


def test_the_covariance_is_that_of_the_errors(drives):
    nees = []
    for world, _, made, _ in drives:
        for index, error in enumerate(errors_of(made.map, world)):
            at = 3 + 2 * index
            nees.append(error @ np.linalg.solve(made.map.covariance[at : at + 2, at : at + 2], error))
    assert 0.5 < np.mean(nees) / 2 < 1.5


def test_landmarks_that_were_known_stay_first_and_hold_the_frame():
    world = world_of(3)
    truth = in_frame(world.start, world.positions)
    params = sextant.LandmarkSlamNodeParams()
    run = SlamRun(params)
    labels = [sextant.LandmarkLabel(name) for name in world.classes[:5]]
    known = [sextant.Landmark2D(position) for position in truth[:5]]
    run.timeline.set_map(np.zeros(3), known, labels, 1e-6 * np.eye(3 + 2 * 5))
    run.first_map, run.first_keys = run.session.map, run.timeline.slam.keys
    run_on(world, run=run)
    made = batch_map(run).map
    assert made.labels[:5] == labels and len(made.landmarks) > 5
    for landmark, position in zip(made.landmarks[:5], truth):
        assert landmark.position == pytest.approx(position, abs=0.01)


def test_a_single_reading_of_odometry_after_a_jump_is_left_out():
    world = world_of(3, duration=30.0)
    run, _ = run_on(world)
    assert run.odometry(round(40e9), np.array([500.0, 0.0, 0.0]))
    made = batch_map(run)
    assert len(made.segments) == 2 and made.segments[0].robot and not made.segments[1].robot


def test_a_robot_that_never_knew_its_pose_gives_no_map():
    params = sextant.LandmarkSlamNodeParams()
    run = SlamRun(params)
    with pytest.raises(RuntimeError, match="lost all the time"):
        batch_map(run)
