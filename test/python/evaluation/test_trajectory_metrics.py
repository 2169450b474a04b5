# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Against closed forms, other implementations, and the results of evo for the same files (test/data/evo)."""

import json
from pathlib import Path

import numpy as np
import pytest
from random_drives import SECOND, pose, random_drive
from scipy.spatial.transform import Rotation

from sextant.evaluation.trajectory_files import read_trajectory
from sextant.evaluation.trajectory_metrics import (
    aligned,
    alignment,
    interpolated_truth,
    relative_errors,
    start_alignment,
    summarize,
    trajectory_errors,
)

EVO = Path(__file__).resolve().parents[2] / "data" / "evo"


def associate(truths, poses, tolerance):
    """The TUM benchmark's associate.py: all differences, the smallest first."""
    matches = sorted((abs(a - b), a, b) for a in truths for b in poses if abs(a - b) <= tolerance)
    pairs, truths, poses = {}, set(truths), set(poses)
    for _, a, b in matches:
        if a in truths and b in poses:
            truths.remove(a), poses.remove(b)
            pairs[b] = a
    return pairs


@pytest.fixture(scope="module")
def golden():
    truth, estimate = (read_trajectory(EVO / name) for name in ("truth.tum", "estimate.tum"))
    pairs = associate(truth, estimate, 0.02 * SECOND)
    of_poses = {stamp: truth[pairs[stamp]] for stamp in sorted(pairs)}
    return of_poses, estimate, json.loads((EVO / "evo.json").read_text())


def check(values, expected):
    mine = summarize(values)
    assert len(values) == expected["count"]
    assert [mine.rmse, mine.mean, mine.median, mine.worst] == pytest.approx(
        [expected[name] for name in ("rmse", "mean", "median", "max")], rel=1e-9
    )


def test_absolute_errors_are_those_of_evo(golden):
    truth, estimate, expected = golden
    T = alignment(truth, estimate)
    assert pytest.approx(np.array(expected["T_truth_estimate"]), abs=1e-9) == T
    for name, trajectory in (("raw", estimate), ("aligned", aligned(T, estimate))):
        errors = trajectory_errors(truth, trajectory)
        check(errors.position, expected["ape"][name]["position"])
        check(errors.angle, expected["ape"][name]["angle"])


@pytest.mark.parametrize("unit, delta", [("frames", 5), ("metres", 0.5)])
def test_relative_errors_are_those_of_evo(golden, unit, delta):
    truth, estimate, expected = golden
    of_evo = expected["rpe"][f"{unit.replace('metres', 'meters')} {delta} all"]
    errors = relative_errors(truth, estimate, delta, unit)
    check(errors.position, of_evo["position"])
    check(errors.angle, of_evo["angle"])


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-3, 1.0, np.pi - 1e-6])
def test_angle(angle):
    axis = np.array([1.0, -2.0, 2.0]) / 3.0
    truth = pose(rotvec=(0.1, 0.2, 0.3))
    errors = trajectory_errors({0: truth}, {0: truth @ pose(rotvec=angle * axis)})
    assert errors.angle[0] == pytest.approx(angle, abs=1e-12)


def test_errors_do_not_depend_on_where_the_robot_is():
    truth = {1: pose(5.0, -3.0, 1.0, (0.3, -0.8, 2.0)), 2: pose(), 3: pose(1.0)}
    offset = pose(0.03, 0.0, 0.04, (0.0, 0.0, -0.1))
    errors = trajectory_errors(truth, {2: truth[2] @ offset, 1: truth[1] @ offset})
    assert errors.stamps.tolist() == [1, 2]
    assert errors.position == pytest.approx([0.05, 0.05])
    assert errors.angle == pytest.approx([0.1, 0.1])
    assert errors.frames == 3


def test_a_pose_without_truth_is_refused():
    with pytest.raises(ValueError, match="1 poses without ground truth, the first at 7 ns"):
        trajectory_errors({1: pose()}, {1: pose(), 7: pose()})


def test_summary_of_known_numbers():
    summary = summarize(np.arange(101.0))
    assert (summary.mean, summary.p95, summary.worst) == (50.0, 95.0, 100.0)


def test_interpolation_between_two_truths():
    truth = {0: pose(0.0, 1.0), SECOND // 5: pose(2.0, 1.0, 4.0, (0.0, 0.0, 1.0)), 2 * SECOND: pose()}
    stamps = [0, SECOND // 20, SECOND // 5, SECOND, 2 * SECOND, 3 * SECOND, -1]
    result = interpolated_truth(truth, stamps)
    assert list(result) == [0, SECOND // 20, SECOND // 5, 2 * SECOND]
    assert pytest.approx(pose(0.5, 1.0, 1.0, (0.0, 0.0, 0.25))) == result[SECOND // 20]
    np.testing.assert_array_equal(result[0], truth[0])
    around = {0: pose(rotvec=(0, 0, 3.0)), 100: pose(rotvec=(0, 0, -3.0))}
    assert interpolated_truth(around, [50])[50] == pytest.approx(pose(rotvec=(0, 0, np.pi)), abs=1e-12)


def test_interpolation_without_truths():
    assert interpolated_truth({}, [1, 2]) == {}
    assert list(interpolated_truth({1: pose()}, [0, 1, 2])) == [1]
    assert interpolated_truth({1: pose(), 3: pose()}, []) == {}


def test_alignment_finds_the_frame():
    truth = random_drive(np.random.default_rng(1), 30)
    T = pose(3.0, -1.0, 2.0, (0.3, -2.0, 1.0))
    estimate = aligned(np.linalg.inv(T), truth)
    assert alignment(truth, estimate) == pytest.approx(T)
    assert np.max(trajectory_errors(truth, aligned(T, estimate)).position) < 1e-12


def test_alignment_of_a_flat_drive_is_no_mirror():
    random = np.random.default_rng(2)
    truth = {i: pose(*random.normal(size=2)) for i in range(20)}
    estimate = {i: pose(*(T[:3, 3] + random.normal(0.0, 0.01, 3))) for i, T in truth.items()}
    T = alignment(truth, estimate)
    assert np.linalg.det(T[:3, :3]) == pytest.approx(1.0)
    expected, _ = Rotation.align_vectors(*(centred(each) for each in (truth, estimate)))
    assert T[:3, :3] == pytest.approx(expected.as_matrix())


def centred(trajectory):
    positions = np.array([trajectory[stamp][:3, 3] for stamp in sorted(trajectory)])
    return positions - positions.mean(axis=0)


@pytest.mark.parametrize(
    "truth, reason",
    [
        ({0: pose(), 1: pose(1.0)}, "2 poses with ground truth"),
        ({i: pose(i, 2.0 * i) for i in range(9)}, "positions are collinear"),
        ({i: pose(1.0) for i in range(9)}, "positions are collinear or equal"),
        ({i: pose(np.nan if i == 4 else i, i**2) for i in range(9)}, "the pose at 4 ns is not finite"),
    ],
)
def test_what_cannot_be_aligned(truth, reason):
    with pytest.raises(ValueError, match=reason):
        alignment(truth, truth)


def test_relative_errors_of_a_constant_drift():
    """A robot drives straight at 1 m/s; its odometry believes in 2 % more, or that it turns by 0.01 rad/s."""
    stamps = [i * SECOND // 10 for i in range(101)]
    truth = {stamp: pose(stamp / SECOND) for stamp in stamps}
    estimate = {t: pose(1.02 * t / SECOND) for t in stamps}
    for delta, unit in ((20, "frames"), (2.0, "seconds"), (2.0, "metres")):
        errors = relative_errors(truth, estimate, delta, unit)
        assert len(errors.position) in (81, 83)  # seconds, metres: the last two are up to a tenth shorter
        assert errors.stamps[0].tolist() == [0, 2 * SECOND]
        assert errors.position[:81] == pytest.approx(np.full(81, 0.04))
    turning = {t: pose(t / SECOND, rotvec=(0, 0, 0.01 * t / SECOND)) for t in stamps}
    angle = relative_errors(truth, turning, 3.0, "seconds").angle[:71]
    assert angle == pytest.approx(np.full(71, 0.03))


def test_relative_errors_do_not_depend_on_frames():
    random = np.random.default_rng(3)
    truth = random_drive(random, 40)
    estimate = {stamp: T @ pose(*random.normal(0.0, 0.1, 3)) for stamp, T in truth.items()}
    first = relative_errors(truth, estimate, 0.7, "metres")
    moved = relative_errors(truth, aligned(pose(1.0, 2.0, 3.0, (1.0, 2.0, 0.5)), estimate), 0.7, "metres")
    assert len(first.position) > 10
    assert moved.position == pytest.approx(first.position)
    assert moved.angle == pytest.approx(first.angle, abs=1e-7)


def test_pairs_far_from_delta_are_left_out():
    truth = {stamp * SECOND: pose(stamp) for stamp in (0, 1, 2, 10, 11)}
    pairs = relative_errors(truth, truth, 2.0, "seconds").stamps // SECOND
    assert pairs.tolist() == [[0, 2]]


def test_pauses_of_the_robot():
    truth = {i: pose(x) for i, x in enumerate([0.0, 0.0, 1.0, 1.0, 1.0, 2.0, 2.0])}
    pairs = relative_errors(truth, truth, 1.0, "metres").stamps.tolist()
    assert pairs == [[0, 2], [1, 2], [2, 5], [3, 5], [4, 5]]


@pytest.mark.parametrize("unit", ["frames", "seconds", "metres"])
@pytest.mark.parametrize("count", [0, 1, 2])
def test_a_drive_that_is_too_short_has_no_relative_errors(unit, count):
    truth = {i: pose(i) for i in range(count)}
    errors = relative_errors(truth, truth, 5, unit)
    assert errors.stamps.shape == (0, 2) and len(errors.position) == len(errors.angle) == 0
    assert np.isnan(summarize(errors.position).rmse)


@pytest.mark.parametrize(
    "arguments, reason",
    [
        ((1, "miles"), "the unit is 'miles', allowed are frames, seconds, metres"),
        ((0, "frames"), "delta is 0 frames"),
        ((1.5, "frames"), "delta is 1.5 frames, not a whole number"),
        ((np.nan, "metres"), "delta is nan metres"),
    ],
)
def test_relative_errors_of_nothing_that_is_known(arguments, reason):
    with pytest.raises(ValueError, match=reason):
        relative_errors({0: pose()}, {0: pose()}, *arguments)


def test_the_first_pose_with_a_reference_is_put_on_it():
    T_map_odom = pose(1.0, 2.0, 3.0, (0.1, 0.2, 0.3))
    truth = {k * SECOND // 10: pose(0.1 * k) for k in range(30)}
    reference = {stamp: T for stamp, T in truth.items() if stamp >= SECOND}
    estimate = {stamp: np.linalg.inv(T_map_odom) @ T for stamp, T in truth.items()}
    assert start_alignment(reference, estimate) == pytest.approx(T_map_odom)
    with pytest.raises(ValueError, match="no pose can be aligned"):
        start_alignment(reference, {0: np.eye(4)})
