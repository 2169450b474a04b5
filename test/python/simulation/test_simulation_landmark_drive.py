# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A simulated robot among landmarks: its measurements are the truth with the published noise."""

import itertools

import numpy as np
import pytest
from scipy import stats

from sextant.geometry.plane_poses import composed, in_frame, relative
from sextant.simulation.landmark_world import LandmarkDrive, LandmarkWorld, LandmarkWorldParams, class_name
from sextant.simulation.odometry import SteppedOdometry

EXACT = dict(
    rotation_from_rotation=0.0,
    rotation_from_translation=0.0,
    translation_from_translation=0.0,
    translation_from_rotation=0.0,
    lateral_from_translation=0.0,
)


def drive_of(**params):
    world = LandmarkWorld(LandmarkWorldParams(**params))
    return world, LandmarkDrive(world)


def steps_of(drive, seconds, rate=20.0, command=None):
    return [drive.advance(command) for _ in range(round(seconds * rate))]


def in_band(squares, width):
    """Whether the sum of squares of so many standard normal numbers is likely (99.8 %)."""
    return stats.chi2.ppf(0.001, width) < np.sum(squares) < stats.chi2.ppf(0.999, width)


def test_a_command_leads_around_a_circle():
    world, drive = drive_of(odometry_rate=1000.0, **EXACT)
    steps = steps_of(drive, 2.0, 1000.0, command=(0.4, 0.8))
    x, y, turn = relative(world.start, steps[-1].pose)
    np.testing.assert_allclose([x, y, turn], [0.5 * np.sin(1.6), 0.5 * (1 - np.cos(1.6)), 1.6], atol=1e-3)
    assert (steps[-1].speed, steps[-1].turn_rate) == (0.4, 0.8)


def test_a_drive_without_commands_is_that_of_the_world_and_stays_in_it():
    world, drive = drive_of(seed=3, duration=200.0)
    for step, expected in itertools.zip_longest(steps_of(drive, 200.0), world.steps()):
        np.testing.assert_array_equal(step.pose, expected.pose)
        np.testing.assert_array_equal(step.odometry_step, expected.odometry_step)
        assert np.hypot(*step.pose[:2]) < 8.0


def test_odometry_without_noise_is_the_way_times_its_scale():
    _, drive = drive_of(scale=1.25, **EXACT)
    for step in steps_of(drive, 5.0, command=(0.4, -0.2)):
        np.testing.assert_allclose(step.odometry_step, [1.25 * 0.4 / 20, 0.0, -0.2 / 20], atol=1e-12)


@pytest.mark.parametrize("command, variances", [((1, 0), [0.09, 0.01, 0.04]), ((0, 1), [0.16, 0, 0.25])])
def test_odometry_errs_by_way_and_by_turn(command, variances):
    """One metre, or one radian, many times: every number alone, with the variance that it names."""
    noise = dict(
        translation_from_translation=0.3,
        lateral_from_translation=0.1,
        rotation_from_translation=0.2,
        translation_from_rotation=0.4,
        rotation_from_rotation=0.5,
    )
    _, drive = drive_of(odometry_rate=1.0, sensor_rate=1.0, landmarks=0, **noise)
    true = np.array([command[0], 0.0, command[1]], float)
    steps = steps_of(drive, 500, 1.0, command)
    np.testing.assert_allclose(steps[0].noise, np.diag(variances), atol=1e-12)
    back = relative(true, np.zeros(3))  # the step's inverse
    felt = np.array([composed(step.odometry_step, back) for step in steps])
    for values, variance in zip(felt.T, variances):
        assert in_band(values**2 / variance, 500) if variance else np.allclose(values, 0.0)


def test_observations_err_as_their_covariances_state():
    world, drive = drive_of(seed=1, field_of_view=6.0)
    squares = []
    for step in steps_of(drive, 60.0):
        for seen in step.scan.observations if step.scan else []:
            off = seen.position - in_frame(step.pose, world.positions[seen.truth])
            squares.append(off @ np.linalg.solve(seen.covariance, off))
            assert seen.class_name == world.classes[seen.truth]
    assert len(squares) > 500 and in_band(squares, 2 * len(squares))


def is_binomial(successes, trials, probability):
    """False if so many or so few successes have a probability of less than 0.001."""
    count = stats.binom(trials, probability)
    return min(count.cdf(successes), count.sf(successes - 1)) > 0.0005


def test_missed_detections_and_false_alarms():
    world, drive = drive_of(
        detection_probability=0.7, false_alarm_probability=0.2, field_of_view=6.2832, max_range=100.0
    )
    scans = [step.scan.observations for step in steps_of(drive, 60.0) if step.scan]
    true = sum(seen.truth is not None for scan in scans for seen in scan)
    assert is_binomial(true, len(scans) * len(world.positions), 0.7)
    assert is_binomial(sum(map(len, scans)) - true, true, 0.2)


@pytest.mark.parametrize("delay, offset", [(0.0, 0.0), (0.3, 0.0), (0.25, 0.15), (0.1, -0.4)])
def test_looks_come_late_with_the_stamp_of_their_clock(delay, offset):
    world, drive = drive_of(delay=delay, clock_offset=offset, bearing_noise=1e-9, range_noise=(1e-9, 0.0))
    poses, scans = {}, 0
    for step in steps_of(drive, 20.0):
        poses[round(step.stamp, 3)] = step.pose
        if step.scan:
            scans, taken = scans + 1, step.scan.stamp + offset
            assert step.stamp == pytest.approx(taken + delay)
            for seen in step.scan.observations:
                expected = in_frame(poses[round(taken, 3)], world.positions[seen.truth])
                np.testing.assert_allclose(seen.position, expected, atol=1e-6)
    assert scans == 20 * 5 - np.ceil(delay * 5)


def test_who_is_carried_away_does_not_feel_it():
    _, drive = drive_of(seed=2, **EXACT)
    before = steps_of(drive, 1.0)[-1].pose
    distance = drive.kidnap()
    after = drive.advance((0.0, 0.0))
    assert distance == pytest.approx(np.hypot(*(after.pose - before)[:2]), abs=1e-9) and distance > 0.5
    np.testing.assert_array_equal(after.odometry_step, np.zeros(3))


@pytest.mark.slow
def test_odometry_in_its_frame_is_as_uncertain_as_it_states():
    """Of many drives along one bent way, each with noise of its own."""
    noise = dict(
        translation_from_translation=0.05,
        lateral_from_translation=0.03,
        rotation_from_translation=0.03,
        translation_from_rotation=0.02,
        rotation_from_rotation=0.05,
    )
    command, distances = (0.5, 0.4), []
    true = np.array([0.5 / 0.4 * np.sin(1.6), 0.5 / 0.4 * (1 - np.cos(1.6)), 1.6])  # after 4 s
    for seed in range(150):
        _, drive = drive_of(seed=seed, landmarks=0, odometry_rate=50.0, **noise)
        odometry = SteppedOdometry()
        for step in steps_of(drive, 4.0, 50.0, command):
            reading = odometry.add(step.odometry_step, step.noise, 0.02)
        off = np.array([reading.motion.x, reading.motion.y, reading.motion.yaw]) - true
        distances.append(off @ np.linalg.solve(reading.covariance, off))
    assert in_band(distances, 3 * len(distances))
    assert reading.motion.speed == pytest.approx(step.odometry_step[0] / 0.02)
    assert reading.turn_rate_variance == pytest.approx(step.noise[2, 2] / 0.02**2)


def test_classes_have_names_of_their_own():
    names = [class_name(number) for number in range(30)]
    assert len(set(names)) == 30 and names[:3] == ["blue_pillar", "red_pillar", "yellow_pillar"]
    assert set(LandmarkWorld(LandmarkWorldParams(landmarks=9, classes=2)).classes) == set(names[:2])


def test_what_cannot_be_is_refused():
    with pytest.raises(ValueError, match=r"translation_from_rotation: must be within \[0, 1\], is -0.1"):
        LandmarkWorldParams(translation_from_rotation=-0.1)
    with pytest.raises(ValueError, match="do not fit into a square of 2 m"):
        LandmarkWorld(LandmarkWorldParams(landmarks=50, half_side=1.0))


def test_odometry_leads_the_motion_where_it_is_the_command():
    _, drive = drive_of(lead=0.2, scale=1.25, turn_scale=1.5, **EXACT)
    commands = [(0.1 * number, 0.2) for number in range(40)]
    steps = [drive.advance(command) for command in commands]
    for step, (speed, turn_rate) in zip(steps, commands):
        np.testing.assert_allclose(
            step.odometry_step, [1.25 * speed / 20, 0.0, 1.5 * turn_rate / 20], atol=1e-12
        )
    assert [step.speed for step in steps] == [0.0] * 4 + [speed for speed, _ in commands[:-4]]


def test_the_mount_turns_all_observations():
    fine = {"bearing_noise": 1e-9, "range_noise": (1e-9, 0.0)}
    pairs = []
    for offset in (0.0, 0.3):
        world, drive = drive_of(seed=2, bearing_offset=offset, **fine)
        pairs.append([seen for step in steps_of(drive, 20.0) if step.scan for seen in step.scan.observations])
    assert len(pairs[0]) > 20
    for plain, turned in zip(*pairs):
        angle = np.subtract(*(np.arctan2(seen.position[1], seen.position[0]) for seen in (turned, plain)))
        assert np.remainder(angle, 2 * np.pi) == pytest.approx(0.3, abs=1e-6)


def test_gross_errors_are_of_the_range_and_as_frequent_as_set():
    fine = {"bearing_noise": 1e-9, "range_noise": (1e-9, 0.0)}
    world, drive = drive_of(seed=1, gross_error_probability=0.2, gross_error=2.0, **fine)
    errors = []
    for step in steps_of(drive, 400.0):
        for seen in step.scan.observations if step.scan else []:
            truth = in_frame(step.pose, world.positions)[seen.truth]
            off = seen.position - truth
            assert abs(np.cross(off, truth)) < 1e-5 * np.hypot(*truth) ** 2
            errors.append(np.hypot(*off))
    gross = np.array(errors)[np.array(errors) > 1e-6]
    least, most = stats.binom.interval(0.999, len(errors), 0.2)
    assert least <= len(gross) <= most
    assert gross.max() < 2.0
    assert gross.mean() == pytest.approx(1.0, abs=0.15)


def test_nothing_is_detected_in_gaps():
    params = dict(seed=4, field_of_view=6.28, max_range=100.0, sensor_rate=5.0)
    _, drive = drive_of(gap_probability=2.0, shortest_gap=3.0, longest_gap=12.0, **params)
    empty = [not step.scan.observations for step in steps_of(drive, 3000.0) if step.scan]
    ends = np.flatnonzero(np.diff([0, *empty, 0]))
    gaps = (ends[1::2] - ends[::2]) / 5.0
    # Two gaps that overlap are one, so that there are fewer and longer ones.
    assert 50 < len(gaps) < 110
    assert gaps.min() >= 2.9
    assert np.median(gaps) == pytest.approx(6.0, abs=1.5)  # the middle of a log-uniform distribution


def test_a_detection_jumps_towards_a_neighbour_of_its_class_only():
    fine = {"bearing_noise": 1e-9, "range_noise": (1e-9, 0.0), "jump_probability": 0.5, "jump_distance": 3.0}
    world, drive = drive_of(seed=5, **fine)
    jumps = 0
    for step in steps_of(drive, 300.0):
        positions = in_frame(step.pose, world.positions)
        for seen in step.scan.observations if step.scan else []:
            own, same = positions[seen.truth], [name == seen.class_name for name in world.classes]
            others = positions[same]
            distances = np.hypot(*(others - own).T)
            nearest = others[np.argsort(distances)[1]]
            off = np.hypot(*(seen.position - own))
            jumps += off > 1e-6
            if off > 1e-6:
                apart = np.hypot(*(nearest - own))
                assert apart <= 3.0
                assert off + np.hypot(*(seen.position - nearest)) == pytest.approx(apart, abs=1e-6)
    assert jumps > 100


def test_worlds_without_faults_do_not_depend_on_them():
    _, one = drive_of(seed=6)
    _, other = drive_of(seed=6, longest_gap=100.0, jump_distance=5.0, gross_error=1.0)
    for a, b in zip(steps_of(one, 20.0), steps_of(other, 20.0)):
        np.testing.assert_array_equal(a.pose, b.pose)
        if a.scan:
            assert [each.position.tolist() for each in a.scan.observations] == [
                each.position.tolist() for each in b.scan.observations
            ]


def test_a_longest_gap_below_the_shortest_is_refused():
    with pytest.raises(ValueError, match="longest_gap: must be at least shortest_gap"):
        LandmarkWorldParams(shortest_gap=5.0, longest_gap=4.0)
