# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Bags and options that map_landmarks cannot use: it prints what is wrong, and what to do."""

import re
from io import BytesIO

import numpy as np
import pytest
from genpy.dynamic import generate_dynamic
from landmark_bags import observation_message, observations_message, refused, write_world
from written_bags import WrittenBag, time

from sextant.commands.map_landmarks import main
from sextant.msg import LandmarkObservations
from sextant.simulation.landmark_world import LandmarkWorld, LandmarkWorldParams

WORLD = LandmarkWorld(LandmarkWorldParams(seed=3, duration=6.0, landmarks=12, half_side=5.0))
PILLAR = observation_message("pillar", [1.0, 0.0], 0.01 * np.eye(2))


def test_damaged_messages_are_skipped_and_reported(tmp_path, capsys):
    def damaged(sets):
        for index, (_, message) in enumerate(sets):
            for each in message.observations[:1]:
                if index % 3 == 1:
                    each.x = np.nan
                if index % 3 == 2:
                    each.covariance = [0.0] * 9
        return sets

    write_world(tmp_path / "a.bag", WORLD, arrivals=damaged)
    assert main([str(tmp_path / "a.bag"), "-o", str(tmp_path / "m.yaml")]) == 0
    out = capsys.readouterr().out
    assert re.search("messages were left out: the observation of '.+': a number is not finite", out)
    assert re.search("left out: the observation of '.+': the covariance is not positive definite", out)


def write_odometry(bag, **settings):
    for index in range(5):
        bag.odometry("/odom", np.eye(4), 1.0 + index, **settings)


def write_both(bag, observations=(PILLAR,), frame="base_link", stamp=2.0, **settings):
    write_odometry(bag, **settings)
    bag.write("/landmarks", observations_message(stamp, list(observations), frame), 2.0)


def write_two_topics(bag):
    write_both(bag)
    bag.write("/others", observations_message(2.0, [PILLAR]), 2.0)


def write_raw(bag, data, message_type=LandmarkObservations):
    write_odometry(bag)
    raw = (LandmarkObservations._type, data, message_type._md5sum, None, message_type)
    bag._bag.write("/landmarks", raw, time(2.0), raw=True)


def write_older(bag):
    """Observations of a version that had another name for a field."""
    text = LandmarkObservations._full_text.replace("float64 heading", "float64 yaw")
    data = BytesIO()
    observations_message(2.0, [PILLAR]).serialize(data)
    older = generate_dynamic(LandmarkObservations._type, text)[LandmarkObservations._type]
    write_raw(bag, data.getvalue(), older)


def write_again(bag):
    write_both(bag)
    bag.odometry("/odom", np.eye(4), 1.5, received=6.0)


@pytest.mark.parametrize(
    "write, options, reason",
    [
        (lambda bag: None, [], "there is no message in it"),
        (write_odometry, [], "it contains neither landmarks (sextant/LandmarkObservations) nor markers"),
        (write_odometry, ["--landmarks", "/odom"], "there is no sextant/LandmarkObservations on /odom"),
        (write_odometry, ["--odometry", "/wheels"], "there is no nav_msgs/Odometry on /wheels"),
        (write_both, ["--odometry", "none"], "it contains no nav_msgs/Odometry, or --odometry is none"),
        (write_odometry, ["--markers", "/cam/markers"], "there is no sextant/MarkerArray on /cam/markers"),
        (
            lambda bag: bag.transforms([]),
            [],
            "it contains no nav_msgs/Odometry, or --odometry is none; its topics are: /tf_static",
        ),
        (
            write_two_topics,
            [],
            "several topics of sextant/LandmarkObservations: /landmarks, /others; specify one by",
        ),
        (write_again, [], "the clock of /odom jumps back by 3.500 s at 5.000 s; was a bag played twice?"),
        (
            lambda bag: write_raw(bag, b"cut off"),
            [],
            "nothing on /landmarks can be used: the message is damaged",
        ),
        (
            lambda bag: write_both(bag, child=""),
            [],
            "does not name its child_frame_id; specify the frame of the robot by",
        ),
        (write_older, [], "were recorded by another version of Sextant"),
        (lambda bag: write_both(bag, frame=""), [], "can be used: it has no frame_id (1 times)"),
        (lambda bag: write_both(bag, stamp=None), [], "can be used: the stamp is zero (1 times)"),
        (lambda bag: write_both(bag, [observation_message("", [1, 0], np.eye(2))]), [], "has no class_name"),
        (
            lambda bag: write_both(bag, frame="arm"),
            [],
            "its frame 'arm' with 'base_link': specify its pose by",
        ),
    ],
)
def test_bags_that_cannot_be_used(tmp_path, capsys, write, options, reason):
    with WrittenBag(tmp_path / "bad.bag") as bag:
        write(bag)
    error = refused(capsys, tmp_path / "bad.bag", "-o", tmp_path / "m.yaml", *options)
    assert reason in error and error.count("\n") == 1 and not (tmp_path / "m.yaml").exists()


@pytest.mark.parametrize(
    "options, reason",
    [
        ([], "specify the map to write"),
        (["-o", "m.txt"], "the file name of a landmark map must end in .yaml"),
        (["-o", "nowhere/m.yaml"], "there is no folder nowhere"),
        (["-o", "m.yaml", "--lost"], "specify the map to localize in by --start-map"),
        (["--read-only"], "--start-map or --marker-map"),
        (["-o", "m.yaml", "--trajectory", "t.bag"], "t.bag: its ending must be one of .csv, .tum, .txt"),
        (["-o", "m.yaml", "--plot", "t"], "t: its ending must be one of .png"),
        (["-o", "m.yaml", "--start-map", "none.yaml"], "none.yaml"),
        (["-o", "m.yaml", "--params", "none.yaml"], "none.yaml: No such file"),
        (["-o", "m.yaml", "--mounts", "sensor=1,2"], "--mounts sensor is '1,2'"),
        (["-o", "m.yaml", "--start", "3", "--end", "2"], "start is 3.0 and end 2.0"),
    ],
)
def test_options_that_cannot_be(tmp_path, capsys, monkeypatch, options, reason):
    monkeypatch.chdir(tmp_path)
    error = refused(capsys, "a.bag", *options)
    assert reason in error and error.count("\n") == 1 and list(tmp_path.iterdir()) == []


def test_ctrl_c_ends_with_one_line(tmp_path, capsys, monkeypatch):
    def interrupted(*args):
        raise KeyboardInterrupt

    monkeypatch.setattr("sextant.commands.map_landmarks.read_bags", interrupted)
    assert main(["a.bag", "-o", str(tmp_path / "m.yaml")]) == 130
    assert capsys.readouterr().err == "map_landmarks: interrupted\n" and list(tmp_path.iterdir()) == []


def test_unused_options_and_messages_are_reported(tmp_path, capsys):
    with WrittenBag(tmp_path / "a.bag") as bag:
        write_both(bag)
        bag.write("/landmarks", observations_message(0.5, [PILLAR]), 1.5)
    given = ["--mounts", "arm=0,0,0,0,0,0"]
    assert main([str(tmp_path / "a.bag"), "-o", str(tmp_path / "m.yaml"), *given]) == 0
    out = capsys.readouterr().out
    assert "no message has the frame 'arm' of mounts; the frames are: base_link" in out
    assert "1 of 2 scans are older than the first odometry" in out and "too late" not in out
