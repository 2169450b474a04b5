# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses of drives against their truth, as their user calls it."""

import re
from pathlib import Path

import numpy as np
import pytest
from accuracy_command import called, refused
from geometry_msgs.msg import PoseWithCovarianceStamped
from written_bags import WrittenBag, header

import sextant
from sextant.messages.pose_messages import pose_to_message


def write_drive(path, bias, seed, count=200):
    """A bag of poses that are off, of their truth in tf, and lines of a TUM file of it."""
    random, lines = np.random.default_rng(seed), []
    path.parent.mkdir(exist_ok=True)
    with WrittenBag(path) as bag:
        for k in range(count):
            second, place = 0.1 * k, [0.05 * k, 0.3 * np.sin(0.05 * k), 0.0]
            T = sextant.pose_from_xyz_rpy(place, [0.0, 0.0, 0.0])
            bag.transforms([("map", "truth", T)], second, topic="/tf")
            lines.append(f"{1600000000 + second:.3f} {place[0]} {place[1]} 0 0 0 0 1")
            message = PoseWithCovarianceStamped(header=header(second, "map"))
            estimate = sextant.pose_from_xyz_rpy(0.02 * random.normal(size=3), 0.01 * random.normal(size=3))
            estimate[:3, 3] += T[:3, 3] + [0.0, bias, 0.0]
            message.pose.pose = pose_to_message(estimate)
            message.pose.covariance = np.diag([0.02**2] * 3 + [0.01**2] * 3).ravel()
            bag.write("/pose", message, second)
            bag.odometry("/truth", T, second, frame="map")
    return lines


def write_topics(path, count=100):
    """A bag of a robot on a circle: poses in map without error, and odometry from its start that drifts."""
    T_map_odom = sextant.pose_from_xyz_rpy([1.0, 2.0, 0.0], [0.0, 0.0, 0.7])
    lines = []
    with WrittenBag(path) as bag:
        for k in range(count):
            second, angle = 0.1 * k, 0.05 * k
            motion = [np.sin(angle), 1.0 - np.cos(angle), 0.0]
            T = T_map_odom @ sextant.pose_from_xyz_rpy(motion, [0.0, 0.0, angle])
            message = PoseWithCovarianceStamped(header=header(second, "map"))
            message.pose.pose = pose_to_message(T)
            message.pose.covariance = (1e-4 * np.eye(6)).ravel()
            bag.write("/pose", message, second)
            drifted = np.array([motion[0] + 0.001 * k, motion[1], 0.0])
            bag.odometry("/odom", sextant.pose_from_xyz_rpy(drifted, [0.0, 0.0, angle]), second)
            place, q = message.pose.pose.position, message.pose.pose.orientation
            lines.append(f"{1600000000 + second:.3f} {place.x} {place.y} 0 0 0 {q.z} {q.w}")
    Path("truth.tum").write_text("\n".join(lines))


@pytest.mark.slow
def test_several_topics_in_one_plot(tmp_path, monkeypatch, capsys):
    """Odometry is put on the first true pose: its error is the drift, 1 mm per pose."""
    monkeypatch.chdir(tmp_path)
    write_topics(tmp_path / "drive.bag")
    topics = ["drive.bag", "--pose", "/odom,/pose", "--align-start", "/odom"]
    code, out, _ = called(capsys, *topics, "--truth", "truth.tum", "-o", "true")
    drift = 0.001 * np.arange(100)
    assert code == 0 and rmse_of(out) == pytest.approx([np.sqrt(np.mean(drift**2)), 0.0], abs=1e-4)
    assert "drive.bag /odom: 100 poses" in out and "drive.bag /pose: 100 poses" in out
    names = {line.split(",")[0] for line in Path("true.csv").read_text().splitlines()[1:]}
    assert names == {"drive.bag /odom", "drive.bag /pose"}
    code, out, _ = called(capsys, *topics, "-o", "free")
    assert code == 0 and "drive.bag /odom: 100 poses in 9.9 s" in out
    written = sorted(path.name for path in tmp_path.glob("*.[pc]*"))
    assert written == ["free_bands.png", "true.csv", "true.png", "true_bands.png"]


@pytest.mark.parametrize(
    "arguments, reason",
    [
        ([], "not all in one frame: /odom in 'odom', /pose in 'map'; align odometry with --align-start"),
        (["--align-start", "/wheels"], "--align-start /wheels: is not a topic of --pose"),
        (["--align"], "--align has no effect without ground truth"),
        (["--rpe", "2", "metres"], "--rpe has no effect without ground truth"),
        (["--mode", "nearest"], "--mode has no effect with --pose"),
    ],
)
def test_topics_that_cannot_be_compared(tmp_path, monkeypatch, capsys, arguments, reason):
    monkeypatch.chdir(tmp_path)
    write_topics(tmp_path / "drive.bag", 10)
    assert reason in refused(capsys, "drive.bag", "--pose", "/odom,/pose", *arguments)


def rmse_of(out):
    """Metres, of every drive."""
    return [float(each) for each in re.findall(r"ATE, m +RMSE ([\d.]+)", out)]


@pytest.mark.slow
def test_a_drive_against_its_truth(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("truth.tum").write_text("\n".join(write_drive(tmp_path / "drive.bag", 0.0, 1)))
    truths = {"file": ["--truth", "truth.tum"], "frame": ["--truth-frame", "truth"]}
    truths["topic"] = ["--truth-topic", "/truth"]
    for name, truth in truths.items():
        arguments = ["drive.bag", "--pose", "pose", *truth, "-o", name, "--rpe", 2, "seconds"]
        code, out, _ = called(capsys, *arguments)
        assert code == 0 and "drive.bag: 200 poses\n" in out
        assert rmse_of(out) == [pytest.approx(0.02 * np.sqrt(3.0), rel=0.1)]
        assert re.search(r"NEES +mean ([\d.]+) of 6, within", out)
        assert "RPE over 2 seconds, m" in out
        assert sorted(path.name for path in tmp_path.glob(f"{name}*")) == [
            *(f"{name}.csv", f"{name}.png", f"{name}_bands.png")
        ]
    assert len({Path(f"{name}.csv").read_text() for name in truths}) == 1


def test_true_poses_in_another_frame_have_to_be_aligned(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_topics(tmp_path / "drive.bag", 50)
    arguments = ["drive.bag", "--pose", "/pose", "--truth-topic", "/odom"]
    assert "/odom is in 'odom', the poses in 'map'; add --align" in refused(capsys, *arguments)
    assert called(capsys, *arguments, "--align")[0] == 0
    arguments = ["drive.bag", "--pose", "/odom", "--truth-topic", "/pose"]
    code, out, error = called(capsys, *arguments, "--align-start", "/odom", "--force")
    assert code == 0, error


@pytest.mark.slow
def test_several_drives_of_one_name_and_time(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for folder, bias in (("a", 0.0), ("b", 0.3)):
        write_drive(tmp_path / folder / "run.bag", bias, 1)
    arguments = ["a/run.bag", "b/run.bag", "--pose", "pose", "--truth-frame", "truth"]
    code, out, _ = called(capsys, *arguments)
    small = 0.02 * np.sqrt(3.0)
    assert code == 0 and rmse_of(out) == pytest.approx([small, np.hypot(small, 0.3)], rel=0.1)
    assert "a/run.bag: 200 poses" in out and "b/run.bag: 200 poses" in out
    assert sorted(path.name for path in tmp_path.glob("acc*")) == [
        "accuracy.csv",
        *(f"accuracy_{number}{end}" for number in (1, 2) for end in (".png", "_bands.png")),
    ]
    assert "run.bag: is given twice" in refused(capsys, *arguments, "./a/run.bag", "-o", "other")


@pytest.mark.slow
def test_a_drive_that_cannot_be_compared_is_refused_or_skipped(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_drive(tmp_path / "good.bag", 0.0, 1)
    with WrittenBag(tmp_path / "blind.bag") as bag:
        bag.odometry("/pose", np.eye(4), 1.0)
    arguments = ["good.bag", "blind.bag", "--pose", "pose", "--truth-frame", "truth"]
    assert "blind.bag: tf does not connect" in refused(capsys, *arguments)
    code, out, _ = called(capsys, *arguments, "--skip")
    assert code == 0 and "skipped: blind.bag: tf does not" in out and len(rmse_of(out)) == 1
    assert [path.name for path in tmp_path.glob("*[12].png")] == ["accuracy_1.png"]
    assert called(capsys, *reversed(arguments[:2]), *arguments[2:], "--skip", "-o", "other")[0] == 0
    assert [path.name for path in tmp_path.glob("other*[12].png")] == ["other_2.png"]  # the second is drawn


@pytest.mark.parametrize(
    "arguments, reason",
    [
        ([], "set a marker map"),
        (["--pose", "pose", "--rpe", "far", "metres"], "--rpe far metres: allowed is"),
        (["--pose", "pose", "--rpe", "1", "furlongs"], "--rpe 1 furlongs: allowed is"),
        (["--pose", "pose", "--rpe", "1.5", "frames"], "--rpe 1.5 frames: allowed is"),
        (["--pose", "pose", "--map", "absent.yaml"], "absent.yaml"),
        (["--pose", "pose", "--map", "absent.yaml", "--align"], "absent.yaml"),
        (["--pose", "pose", "--every", "2"], "--every has no effect with --pose"),
        (["--pose", "pose", "--axis", "x"], "--axis has no effect for drives"),
        (["--pose", "pose", "-o", "."], "is not a prefix of file names"),
    ],
)
def test_options_of_drives_that_cannot_be(tmp_path, monkeypatch, capsys, arguments, reason):
    monkeypatch.chdir(tmp_path)
    Path("truth.tum").write_text("\n".join(write_drive(tmp_path / "drive.bag", 0.0, 1, count=20)))
    assert reason in refused(capsys, "drive.bag", "--truth", "truth.tum", *arguments)
