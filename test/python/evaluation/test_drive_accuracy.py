# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import csv

import numpy as np
import pytest

import sextant
from sextant.evaluation.drive_accuracy import compare, drive_table, write_errors
from sextant.evaluation.trajectory_metrics import aligned, aligned_covariances, alignment

SECOND = 10**9
OFFSET = sextant.pose_from_xyz_rpy([5.0, -2.0, 0.5], [0.0, 0.0, 1.0])
SIGMA = np.array([0.02, 0.02, 0.01, 0.004, 0.004, 0.01])


def path(count=200):
    """Truth by stamp: half a metre a second round a circle of 3 m."""
    result = {}
    for k in range(count):
        angle = 0.1 * k / 6.0
        xyz = [3.0 * np.cos(angle), 3.0 * np.sin(angle), 0.1 * np.sin(3.0 * angle)]
        result[k * SECOND // 10] = sextant.pose_from_xyz_rpy(xyz, [0.0, 0.0, angle])
    return result


def noisy(truth, seed):
    """Poses (N, 4, 4), of errors with the deviations SIGMA."""
    random, poses = np.random.default_rng(seed), []
    for T in truth.values():
        error, estimate = SIGMA * random.normal(size=6), T.copy()
        estimate[:3, 3] -= error[:3]
        estimate[:3, :3] = sextant.exp_so3(-error[3:]) @ T[:3, :3]
        poses.append(estimate)
    return np.array(poses)


def covariances(count):
    return np.tile(np.diag(SIGMA**2), (count, 1, 1))


def test_a_shift_is_the_error():
    truth = path()
    poses = np.array(list(truth.values()))
    poses[:, 0, 3] += 0.03
    of = compare(truth, list(truth), poses, np.full((len(poses), 6, 6), np.nan))
    np.testing.assert_allclose(of.absolute.position, 0.03)
    np.testing.assert_allclose(of.relative.position, 0.0, atol=1e-9)
    assert of.without_truth == 0 and len(of.nees.values) == 0
    lines = "\n".join(drive_table({"shifted": of}, (1.0, "metres")))
    assert "shifted: 200 poses\n" in lines and "RMSE 0.0300" in lines
    assert "NEES" in lines and "there are no covariances" in lines


def test_honest_covariances_are_reported_as_honest():
    truth = path(1000)
    for factor, word in ((1.0, "within"), (0.25, "above"), (4.0, "below")):
        P = factor * covariances(len(truth))
        of = compare(truth, list(truth), noisy(truth, 5), P)
        assert of.nees.mean == pytest.approx(6.0 / factor, rel=0.05)
        assert f"{word} the 95 % band" in drive_table({"drive": of}, (1.0, "metres"))[-1]


def test_alignment_takes_another_frame_away_and_turns_covariances():
    truth = path(1000)
    elsewhere = {stamp: OFFSET @ T for stamp, T in zip(truth, noisy(truth, 5))}
    turned = aligned_covariances(OFFSET, dict(zip(truth, covariances(len(truth)))))
    T = alignment(truth, elsewhere)
    back = np.array(list(aligned_covariances(T, turned).values()))
    of = compare(truth, list(truth), np.array(list(aligned(T, elsewhere).values())), back)
    assert np.sqrt(np.mean(of.absolute.position**2)) == pytest.approx(np.linalg.norm(SIGMA[:3]), rel=0.05)
    assert of.nees.mean == pytest.approx(6.0, rel=0.05)
    away = compare(truth, list(truth), np.array(list(elsewhere.values())), back)
    assert np.median(away.absolute.position) > 1.0


def test_truth_at_other_times_is_interpolated_and_poses_outside_are_reported():
    truth = path()
    stamps = np.array(list(truth)) + SECOND // 20
    middle = [sextant.pose_from_xyz_rpy([0, 0, 0], [0, 0, 0])] * len(stamps)
    of = compare(truth, stamps, np.array(middle), np.zeros((len(stamps), 6, 6)))
    assert of.without_truth == 1
    np.testing.assert_allclose(of.absolute.position, 3.0, atol=2e-3)
    with pytest.raises(ValueError, match="none of 200 poses has ground truth at its time: check the clocks"):
        compare(truth, stamps + 3600 * SECOND, np.array(middle), np.zeros((len(stamps), 6, 6)))


def test_file_of_errors(tmp_path):
    truth = path(20)
    P = covariances(20)
    P[3] = 0.0
    of = compare(truth, list(truth), noisy(truth, 1), P)
    write_errors(tmp_path / "errors.csv", {"a": of})
    with open(tmp_path / "errors.csv") as file:
        rows = list(csv.DictReader(file))
    assert [row["stamp"] for row in rows[:2]] == ["0.000000000", "0.100000000"]
    assert rows[3]["nees"] == "" and len(rows) == 20
    for row, T, estimate in zip(rows, truth.values(), noisy(truth, 1)):
        error = T[:3, 3] - estimate[:3, 3]
        assert [float(row[name]) for name in ("x", "y", "z")] == pytest.approx(error, abs=1e-8)
        assert float(row["position"]) == pytest.approx(np.linalg.norm(error), abs=1e-8)
        squares = np.square([float(row[name]) for name in ("x", "y", "z", "rx", "ry", "rz")] / SIGMA)
        assert row["nees"] == "" or float(row["nees"]) == pytest.approx(squares.sum(), rel=1e-4)


def test_covariances_of_a_plane_are_reported_and_the_rest_is_computed():
    truth = path(50)
    P = covariances(50)
    P[:30, 2] = P[:30, :, 2] = 0.0  # exact in z, as of a filter in two dimensions
    of = compare(truth, list(truth), noisy(truth, 1), P)
    assert of.singular == 30 and len(of.nees.values) == 20
    assert "30 covariances are not positive" in drive_table({"a": of}, (1.0, "metres"))[-1]
