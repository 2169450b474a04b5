# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
import scipy.stats
from scipy.spatial.transform import Rotation

import sextant
from sextant.evaluation.pose_series import (
    BagCount,
    GroundTruth,
    by_distance,
    distance_of_folder,
    pose_series,
    published_sigmas,
    rotation_axes,
    series_statistics,
)

NOT_MEASURED = dict.fromkeys(("x", "y", "roll", "pitch", "yaw"))


def series(poses, distance=1.0, bag="a.bag", **arguments):
    return pose_series(distance, bag, np.arange(len(poses)), np.array(poses, dtype=float), **arguments)


def rows(column, values):
    poses = np.zeros((len(values), 6))
    poses[:, column] = values
    return poses


def test_statistics_of_known_numbers():
    """Of 1, 2, 3, 6: the mean is 3, the sum of squares 14, about the truth 2.5 it is 15."""
    found = series_statistics(series(rows(2, [1, 2, 3, 6]), distance=2.5), GroundTruth())
    assert (found.count, found.axis, found.label) == (4, "z", "2.5 m")
    assert found.truth.tolist() == [0, 0, 2.5, 0, 0, 0]
    assert found.mean.tolist() == [0, 0, 3, 0, 0, 0]
    assert found.bias[2] == pytest.approx(0.5)
    assert found.std[2] == pytest.approx(np.sqrt(14 / 3))
    assert found.rmse[2] == pytest.approx(np.sqrt(15 / 4))
    assert found.covariance[2, 2] == pytest.approx(14 / 3)


@pytest.mark.parametrize("seed", range(3))
def test_statistics_are_those_of_scipy(seed):
    random = np.random.default_rng(seed)
    root = random.normal(0.0, 0.1, (6, 6))
    poses = random.normal(size=(50, 6)) @ root + [0.1, -0.2, 1.5, 2.9, 0.2, -3.0]
    others = {"x": 0.2, "y": -0.1, "roll": 3.0, "pitch": 0.1, "yaw": -3.1}
    found = series_statistics(series(poses, distance=1.6), GroundTruth(others=others))
    truth = [0.2, -0.1, 1.6, 3.0, 0.1, -3.1]
    described = scipy.stats.describe(poses)
    assert found.mean == pytest.approx(described.mean)
    assert found.std**2 == pytest.approx(described.variance)
    assert found.covariance == pytest.approx(np.cov(poses.T))
    assert found.bias == pytest.approx(described.mean - truth)
    assert found.rmse == pytest.approx(np.sqrt(((poses - truth) ** 2).mean(axis=0)))
    assert found.rmse**2 == pytest.approx(found.bias**2 + found.std**2 * 49 / 50)


@pytest.mark.parametrize("truth", [np.pi, -np.pi, None, 3.0, -3.0])
@pytest.mark.parametrize("column, axis", [(3, "roll"), (5, "yaw")])
def test_angles_around_half_a_turn(column, axis, truth):
    """A camera that looks at a marker is rolled by half a turn: its roll jumps between pi and -pi."""
    away = np.array([-0.03, 0.05, 0.01, -0.02, 0.04])
    wrapped = (away + 2 * np.pi) % (2 * np.pi) - np.pi
    assert wrapped.min() < -3 and wrapped.max() > 3
    found = series_statistics(series(rows(column, wrapped)), GroundTruth(others={axis: truth}))
    assert found.std[column] == pytest.approx(away.std(ddof=1))
    assert np.cos(found.mean[column] - np.pi - away.mean()) == pytest.approx(1.0)
    assert np.ptp(found.poses[:, column]) == pytest.approx(0.08)
    if truth is None:
        assert np.isnan(found.bias[column]) and abs(found.mean[column]) <= np.pi
        return
    error = away + np.pi - truth % (2 * np.pi)
    assert found.bias[column] == pytest.approx(error.mean())
    assert found.rmse[column] == pytest.approx(np.sqrt(np.mean(error**2)))
    assert abs(found.mean[column] - truth) < 0.2


def test_mean_of_angles_is_the_circular_mean_where_they_are_close():
    angles = np.random.default_rng(4).vonmises(2.5, 2000.0, 100)
    found = series_statistics(series(rows(4, angles)), GroundTruth(others=NOT_MEASURED))
    assert found.mean[4] == pytest.approx(scipy.stats.circmean(angles, np.pi, -np.pi), abs=1e-4)
    assert found.std[4] == pytest.approx(scipy.stats.circstd(angles), rel=0.02)


def test_poses_as_matrices():
    given = np.array([[0.1, 0.2, 0.3, 3.1, -0.4, 1.0], [0.0, 0.0, 1.0, -3.1, 0.0, 0.0]])
    matrices = np.tile(np.eye(4), (2, 1, 1))
    matrices[:, :3, :3] = Rotation.from_euler("xyz", given[:, 3:]).as_matrix()
    matrices[:, :3, 3] = given[:, :3]
    assert series(matrices).poses == pytest.approx(given)


def test_one_pose_has_no_deviation():
    found = series_statistics(series([[0, 0, 1.1, 0, 0, 0]]), GroundTruth())
    assert found.count == 1
    assert np.isnan(found.std).all() and np.isnan(found.covariance).all()
    assert found.bias[2] == pytest.approx(0.1) and found.rmse[2] == pytest.approx(0.1)


@pytest.mark.parametrize("shape", [(0,), (0, 6), (0, 4, 4)])
def test_no_pose(shape):
    found = series_statistics(series(np.empty(shape), covariances=np.empty((0, 6, 6))), GroundTruth())
    assert found.count == 0 and found.poses.shape == (0, 6)
    for name in ("mean", "std", "bias", "rmse", "published"):
        assert np.isnan(getattr(found, name)).all(), name
    assert found.covariance.shape == (6, 6)


def test_a_stale_pose_is_left_out_and_counted():
    """One pose of another place, 6.14 m instead of 0.747 m, once made an RMSE of 11.9 cm of millimetres."""
    poses = rows(2, [6.14, 0.750, 0.746, 0.748])
    stamps = [4_000_000_000, 5_000_000_000, 5_100_000_000, 5_200_000_000]
    found = pose_series(0.747, "a.bag", stamps, poses, start=5_000_000_000)
    assert found.counts == (BagCount("a.bag", 3, stale=1, invalid=0),)
    assert found.stamps.tolist() == stamps[1:]
    assert series_statistics(found, GroundTruth()).rmse[2] < 0.002


def test_what_is_no_pose_is_left_out_and_counted():
    good = sextant.pose_from_xyz_rpy([0, 0, 1], [3, 0, 0])
    not_finite, no_rotation, mirror = good.copy(), good.copy(), good.copy()
    not_finite[0, 3] = np.nan
    no_rotation[:3, :3] = 0.0
    mirror[:3, 0] *= -1.0
    covariances = np.arange(180.0).reshape(5, 6, 6)
    found = series([not_finite, good, no_rotation, mirror, good], covariances=covariances)
    assert found.counts == (BagCount("a.bag", 2, invalid=3),)
    assert found.stamps.tolist() == [1, 4]
    assert found.covariances[:, 0, 0].tolist() == [36.0, 144.0]
    assert len(series(rows(3, [1.0, np.inf])).poses) == 1


@pytest.mark.parametrize("shape", [(2, 5), (3, 6), (2, 3, 4), (6,)])
def test_shapes_that_do_not_fit(shape):
    with pytest.raises(ValueError, match="expected \\(2, 4, 4\\) or \\(2, 6\\)"):
        pose_series(1.0, "a.bag", [1, 2], np.zeros(shape))
    with pytest.raises(ValueError, match="1 covariances of 2 poses"):
        series(rows(0, [0, 0]), covariances=np.zeros((1, 6, 6)))


def test_bags_of_one_distance_are_joined_whatever_its_folder_is_called():
    names = ["2", "1.0", "1", "+1.", "0.50"]
    bags = [series(rows(0, [i]), distance_of_folder(name), f"{i}.bag") for i, name in enumerate(names)]
    bags.append(series(np.empty((0, 6)), 2.0, "empty.bag"))
    joined = by_distance(bags)
    assert [each.distance for each in joined] == [0.5, 1.0, 2.0]
    assert joined[1].bags.tolist() == ["1.bag", "2.bag", "3.bag"]
    assert joined[1].poses[:, 0].tolist() == [1, 2, 3]
    assert [count.bag for count in joined[2].counts] == ["0.bag", "empty.bag"]
    assert by_distance([]) == []


@pytest.mark.parametrize(
    "name, value", [("0.757", 0.757), ("-0.61", -0.61), (".5", 0.5), ("3", 3.0), ("-0", 0.0)]
)
def test_folders_are_named_by_distances(name, value):
    assert distance_of_folder(name) == value
    assert by_distance([series([], distance_of_folder(name))])[0].distance == value


@pytest.mark.parametrize(
    "name, axis, reason",
    [
        ("raw", "z", "folder 'raw': its name is not a distance"),
        ("1e3", "z", "its name is not a distance"),
        ("0,757", "z", "its name is not a distance, expected a number like 0.757"),
        ("nan", "z", "its name is not a distance"),
        ("1_0", "z", "its name is not a distance"),
        ("٣", "z", "its name is not a distance"),
        ("", "z", "its name is not a distance"),
        ("757", "z", "more than 100 m; is it in m?"),
        ("45", "yaw", "more than 3.142 rad; is it in rad?"),
    ],
)
def test_folders_that_are_named_by_no_distance(name, axis, reason):
    with pytest.raises(ValueError, match=reason.replace("?", r"\?")):
        distance_of_folder(name, axis)


def test_labels():
    def label(distance, axis="z"):
        return series_statistics(series([], distance), GroundTruth(axis)).label

    assert [label(1.0), label(0.757), label(-0.0), label(100.0)] == ["1 m", "0.757 m", "0 m", "100 m"]
    assert [label(1.25, "yaw"), label(-0.61, "x")] == ["1.25 rad", "-0.61 m"]


def test_truths_of_any_axis():
    truth = GroundTruth("x", {"z": 1.5, "roll": np.pi, "yaw": None}).at(-0.61)
    assert truth[:5].tolist() == [-0.61, 0.0, 1.5, np.pi, 0.0] and np.isnan(truth[5])
    found = series_statistics(series(rows(5, [0.1, 0.2])), GroundTruth(others={"yaw": None}))
    assert np.isnan(found.bias[5]) and np.isnan(found.rmse[5])
    assert found.std[5] == pytest.approx(0.1 / np.sqrt(2)) and found.mean[5] == pytest.approx(0.15)


@pytest.mark.parametrize(
    "truths, reason",
    [
        (GroundTruth("Rz"), "'Rz' is not an axis, allowed are x, y, z, roll, pitch, yaw"),
        (GroundTruth(others={"w": 1.0}), "'w' is not an axis"),
        (GroundTruth("x", {"x": 1.0}), "the true x is the distance"),
        (GroundTruth(others={"y": np.nan}), "the true y is nan, not finite"),
    ],
)
def test_truths_that_cannot_be(truths, reason):
    with pytest.raises(ValueError, match=reason):
        truths.at(1.0)
    with pytest.raises(ValueError, match="the true z is inf"):
        GroundTruth().at(np.inf)


def test_published_sigmas():
    covariances = np.tile(np.diag([0.01, 0.04, 0.09, 0.16, 0.25, 0.36]), (5, 1, 1))
    covariances[1] = 0.0
    covariances[2] = np.nan
    covariances[3, 0, 0] = -1.0
    found = series(np.zeros((5, 6)), covariances=covariances)
    sigmas = published_sigmas(found)
    assert sigmas[0] == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    assert np.isnan(sigmas[1:3]).all()
    assert np.isnan(sigmas[3, 0]) and sigmas[3, 1] == pytest.approx(0.2)
    assert series_statistics(found, GroundTruth()).published == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    assert np.isnan(published_sigmas(series(np.zeros((2, 6))))).all()


def test_published_rotations_are_about_fixed_axes():
    """A camera that is turned by a quarter: its roll is a rotation about the reference's y."""
    covariances = np.diag([1, 1, 1, 0.01, 0.04, 0.09])[np.newaxis]
    sigmas = published_sigmas(series([[0, 0, 1, 0.3, 0, np.pi / 2]], covariances=covariances))
    assert sigmas[0, 3:] == pytest.approx([0.2, 0.1, 0.3])
    pitched = series([[0, 0, 1, 0, np.pi / 2, 0]], covariances=covariances)
    assert np.isnan(published_sigmas(pitched)[0, 3:]).all()


@pytest.mark.parametrize("rpy", [(0.1, 0.2, 0.3), (3.1, -0.8, -2.0), (-1.6, 0.0, 1.5)])
def test_rotation_axes_are_the_derivative(rpy):
    def rotation(angles):
        return sextant.pose_from_xyz_rpy(np.zeros(3), angles)[:3, :3]

    step = 1e-6
    expected = [
        sextant.log_so3(rotation(rpy + step * unit) @ rotation(rpy - step * unit).T) / (2 * step)
        for unit in np.eye(3)
    ]
    assert rotation_axes(np.array(rpy)) == pytest.approx(np.array(expected).T, abs=1e-8)
