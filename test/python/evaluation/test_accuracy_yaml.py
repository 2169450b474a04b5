# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
import yaml

import sextant
from sextant.evaluation.accuracy_yaml import (
    ConstantCovariance,
    CornerNoise,
    constant_covariance,
    write_constant_covariance,
    write_corner_noise,
)
from sextant.evaluation.pose_series import GroundTruth, pose_series, series_statistics

FACING = {"roll": np.pi}


def statistics(distance, poses, truths=None):
    series = pose_series(distance, "a.bag", range(len(poses)), poses)
    return series_statistics(series, truths or GroundTruth(others=FACING))


def noisy(distance, sigma, count=50, bias=0.0, seed=0):
    random = np.random.default_rng(seed)
    poses = np.array([0, 0, distance + bias, np.pi, 0, 0]) + random.normal(0.0, sigma, (count, 6))
    return statistics(distance, poses)


def load(path):
    """As rosparam does, into the locator's parameters."""
    loaded = yaml.safe_load(path.read_text())
    params = sextant.LocatorParams()
    for name, value in loaded.items():
        setattr(params, name, value)
    params.validate()
    return loaded


def test_the_locator_takes_corner_noise(tmp_path):
    write_corner_noise(tmp_path / "a.yaml", CornerNoise(1e-5, "from 312 markers\nof the front camera"))
    assert load(tmp_path / "a.yaml") == {"corner_sigma": 1e-5}
    assert "# from 312 markers of the front camera\n" in (tmp_path / "a.yaml").read_text()


def test_the_locator_takes_a_covariance(tmp_path):
    covariance = constant_covariance([noisy(1.0, 1e-6)])
    write_constant_covariance(tmp_path / "a.yaml", covariance)
    loaded = load(tmp_path / "a.yaml")
    assert list(loaded) == ["constant_covariance"]
    assert all(isinstance(value, float) for value in loaded["constant_covariance"])
    assert np.array_equal(np.reshape(loaded["constant_covariance"], (6, 6)), covariance.matrix)
    text = (tmp_path / "a.yaml").read_text()
    assert "# From 50 poses at z = 1 m; the worst of 1 m by the trace of the position; about" in text
    assert max(map(len, text.splitlines())) < 160


@pytest.mark.parametrize("matrix", [-np.eye(6), np.full((6, 6), np.nan), np.triu(np.ones((6, 6))), np.eye(5)])
def test_what_the_locator_would_not_take_is_not_written(tmp_path, matrix):
    path = tmp_path / "a.yaml"
    path.write_text("as it was")
    with pytest.raises(ValueError, match="constant_covariance must be"):
        write_constant_covariance(path, ConstantCovariance(matrix, ""))
    with pytest.raises(ValueError, match="corner_sigma"):
        write_corner_noise(path, CornerNoise(0.0, ""))
    assert path.read_text() == "as it was"
    assert len(list(tmp_path.iterdir())) == 1


def test_comments_cannot_break_the_file(tmp_path):
    remark = "bag: \x07\x00 'x'\ncorner_sigma: 9 # " + "ü" * 300
    write_corner_noise(tmp_path / "a.yaml", CornerNoise(0.3, remark))
    assert load(tmp_path / "a.yaml") == {"corner_sigma": 0.3}


def test_the_worst_distance_is_taken():
    all_of_them = [noisy(1.0, 0.01), noisy(3.0, 0.03), noisy(2.0, 0.02)]
    all_of_them += [noisy(4.0, 9.0, count=6), noisy(5.0, 9.0, count=0)]
    worst = constant_covariance(all_of_them)
    assert worst.measured.startswith("From 50 poses at z = 3 m; the worst of 1 m, 3 m, 2 m by the trace")


def test_a_bias_makes_a_distance_the_worst():
    both = [noisy(1.0, 0.02, bias=0.5), noisy(3.0, 0.03)]
    assert "z = 1 m" in constant_covariance(both).measured


def test_about_the_truth_is_the_mean_square():
    found = noisy(2.0, 0.1, bias=0.3)
    assert np.sqrt(np.diag(constant_covariance([found]).matrix)[:3]) == pytest.approx(found.rmse[:3])


def test_axes_without_a_truth_have_no_bias_in_it():
    poses = np.random.default_rng(1).normal(0.2, 0.01, (20, 6))
    some = statistics(0.2, poses, GroundTruth(others={"x": None, "yaw": None, "y": 0.0}))
    constant = constant_covariance([some])
    assert constant.measured.endswith("with bias, except of x, yaw, whose true values are unknown.")
    assert constant.matrix[0, 0] == pytest.approx(some.covariance[0, 0] * 19 / 20)
    assert constant.matrix[1, 1] == pytest.approx(some.rmse[1] ** 2)


@pytest.mark.parametrize("rpy", [(np.pi, 0.0, 0.0), (-np.pi / 2, 0.0, 2.0), (0.3, -0.7, 1.2)])
def test_rotations_are_those_of_the_pose_error(rpy):
    """The second moment of sextant.pose_error(), which is what a covariance of ours describes."""
    random = np.random.default_rng(3)
    truth = sextant.pose_from_xyz_rpy([0.1, 0.2, 1.0], rpy)
    root = 1e-4 * random.normal(size=(6, 6))
    offset = 1e-4 * random.normal(size=6)
    poses = [sextant.perturbed(truth, root @ random.normal(size=6) + offset) for _ in range(30)]
    errors = np.array([sextant.pose_error(truth, pose) for pose in poses])
    others = {"x": 0.1, "y": 0.2, "roll": rpy[0], "pitch": rpy[1], "yaw": rpy[2]}
    found = constant_covariance([statistics(1.0, np.array(poses), GroundTruth(others=others))])
    assert found.matrix == pytest.approx(errors.T @ errors / 30, rel=1e-2, abs=1e-11)


def test_too_few_poses_have_no_covariance():
    with pytest.raises(ValueError, match="a covariance needs at least 7 poses at one distance"):
        constant_covariance([noisy(1.0, 0.1, count=6)])
