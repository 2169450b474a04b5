# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""From a bag of odometry and observations to a map, as its user calls it."""

import math
import re

import cv2
import numpy as np
import pytest
import rosbag
from html_page import Page
from landmark_bags import observations_message, refused, write_drive, write_world
from written_bags import WrittenBag, nanoseconds

import sextant
from sextant.commands.map_landmarks import main
from sextant.evaluation.trajectory_files import read_trajectory
from sextant.geometry.plane_poses import in_frame
from sextant.landmarks.landmark_colours import colour_of_class
from sextant.simulation.landmark_world import LandmarkWorld, LandmarkWorldParams

WORLD = LandmarkWorld(LandmarkWorldParams(seed=3, duration=60.0, landmarks=12, half_side=5.0))
THREE_SIGMA = 11.83  # of chi squared with two degrees of freedom: 99.73 %


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    """A bag, the map that was made of it, and its true poses."""
    folder = tmp_path_factory.mktemp("drive")
    truth = write_world(folder / "a.bag", WORLD, delay=0.1)
    (folder / "noise.yaml").write_text("rotation_from_rotation: 0.03\n")  # as it is drawn
    given = ["--params", str(folder / "noise.yaml"), "--plot", str(folder / "map.png")]
    out = [*given, "-o", str(folder / "map.yaml"), "--trajectory", str(folder / "poses.csv")]
    assert main([str(folder / "a.bag"), *out]) == 0
    return folder, truth


def mapped(tmp_path, bag, *options):
    """The map's text that is made of a bag."""
    out = tmp_path / f"{len(list(tmp_path.iterdir()))}.yaml"
    assert main([str(bag), "-o", str(out), *options]) == 0
    return out.read_text()


def written(tmp_path, delay=0.0, **settings):
    """A bag of the world."""
    write_world(tmp_path / "b.bag", WORLD, delay=delay, **settings)
    return tmp_path / "b.bag"


def test_the_map_is_the_worlds(drive):
    folder, _ = drive
    made = sextant.read_landmark_map(str(folder / "map.yaml"))
    truth = in_frame(WORLD.start, WORLD.positions)
    assert 9 <= len(made.landmarks) <= len(truth)
    for i, (landmark, label) in enumerate(zip(made.landmarks, made.labels)):
        at = 3 + 2 * i
        covariance = made.covariance[at : at + 2, at : at + 2]
        same = truth[[each == label.class_name for each in WORLD.classes]]
        error = min(same - landmark.position, key=np.linalg.norm)
        assert error @ np.linalg.solve(covariance, error) < THREE_SIGMA


def test_the_trajectory_is_the_robots(drive):
    folder, truth = drive
    poses = read_trajectory(folder / "poses.csv")
    assert len(poses) == len(truth) + 1  # the first is where it starts
    off = [poses[nanoseconds(seconds)][:2, 3] - pose[:2] for seconds, pose in truth.items()]
    assert np.hypot(*np.transpose(off)).max() < 0.5


def test_the_picture_has_the_classes_in_their_colours(drive):
    picture = cv2.imread(str(drive[0] / "map.png"))
    for name in set(WORLD.classes):
        colour = [round(255 * value) for value in colour_of_class(name)[::-1]]
        assert np.all(np.abs(picture.astype(int) - colour) <= 1, axis=2).sum() > 100


@pytest.mark.slow
def test_the_figures_are_those_of_the_timeline_bit_for_bit(tmp_path):
    bag, params = written(tmp_path), sextant.LandmarkTimelineParams()
    slam = sextant.LandmarkSlam(sextant.LandmarkSlamParams(), [0, 0, 0], 0.001**2 * np.eye(3))
    timeline = sextant.LandmarkTimeline(params, slam)
    poses = {}
    for topic, message in messages(bag):
        stamp = message.header.stamp
        seconds = stamp.secs + 1e-9 * stamp.nsecs
        if topic == "/odom":
            q = message.pose.pose.orientation
            norm = math.sqrt(q.z**2 + q.w**2)
            heading = math.atan2(2 * (q.z / norm) * (q.w / norm), 1 - 2 * (q.z / norm) * (q.z / norm))
            position = message.pose.pose.position
            timeline.odometry(seconds, [position.x, position.y, heading])
            poses[stamp.to_nsec()] = timeline.now.pose
        else:
            timeline.observe(seconds, [labelled(each) for each in message.observations])
    mapped(tmp_path, bag, "--online", "--trajectory", str(tmp_path / "poses.tum"))
    assert {stamp: T[:2, 3].tolist() for stamp, T in read_trajectory(tmp_path / "poses.tum").items()} == {
        stamp: pose[:2].tolist() for stamp, pose in poses.items()
    }


def messages(bag):
    with rosbag.Bag(str(bag)) as opened:
        return [(topic, message) for topic, message, _ in opened.read_messages()]


def labelled(message):
    observation = sextant.Observation2D(
        [message.x, message.y], np.reshape(message.covariance, (3, 3))[:2, :2]
    )
    return sextant.LabelledObservation(sextant.LandmarkLabel(message.class_name), observation)


@pytest.mark.slow
def test_what_comes_late_twice_or_out_of_order_changes_nothing(tmp_path, capsys):
    def disorder(sets):
        """Every third set before the one that it followed, every fifth twice."""
        arrivals, all_of = [arrival for arrival, _ in sets], [message for _, message in sets]
        for i in range(3, len(sets), 3):
            all_of[i - 1 : i + 1] = all_of[i - 1 : i + 1][::-1]
        return [each for i, each in enumerate(zip(arrivals, all_of)) for _ in range(1 + (i % 5 == 0))]

    plain = mapped(tmp_path, written(tmp_path, delay=0.4), "--online")
    assert mapped(tmp_path, written(tmp_path, delay=0.4, arrivals=disorder), "--online") == plain
    assert "60 of 360 scans are duplicates" in capsys.readouterr().out
    assert mapped(tmp_path, written(tmp_path, delay=0.0), "--online") == plain


def test_two_sensors_may_look_at_one_moment(tmp_path, capsys):
    def halves(sets):
        """What the first of two sensors sees, and what the other one sees at the same moment."""
        for arrival, message in sets:
            for frame, seen in [
                ("base_link", message.observations[::2]),
                ("other", message.observations[1::2]),
            ]:
                yield arrival, observations_message(message.header.stamp.to_sec(), seen, frame)

    mapped(tmp_path, written(tmp_path, arrivals=halves), "--mounts", "other=0,0,0,0,0,0")
    assert "are duplicates" not in capsys.readouterr().out


def test_scans_with_too_many_observations_are_reported(tmp_path, capsys):
    def large(sets):
        """Every tenth set with one observation a hundred times and more."""
        for i, (arrival, message) in enumerate(sets):
            if i % 10 == 0 and message.observations:
                message.observations = 101 * message.observations[:1]
            yield arrival, message

    mapped(tmp_path, written(tmp_path, arrivals=large))
    assert "scans are too large: raise max_observations (100)" in capsys.readouterr().out


def test_late_observations_are_reported(tmp_path, capsys):
    bag = written(tmp_path, delay=2.5)
    late = r"warning: (\d+) of 300 scans are too late: raise lag \(1 s\)"
    mapped(tmp_path, bag)
    assert int(re.search(late, capsys.readouterr().out)[1]) > 285  # after the last odometry nothing is
    (tmp_path / "lag.yaml").write_text("lag: 4\n")
    mapped(tmp_path, bag, "--params", str(tmp_path / "lag.yaml"))
    assert "too late" not in capsys.readouterr().out


@pytest.mark.slow
def test_a_sensor_beside_the_base(tmp_path, capsys):
    """Its pose is in tf, or by --mounts.

    What it has in view makes one hypothesis more probable than another, so that there is only one.
    """
    alone = tmp_path / "alone.yaml"
    alone.write_text("hypotheses: 1\n")
    mount = np.array([0.2, -0.1, 0.5])
    T_base_sensor = sextant.pose_from_xyz_rpy([*mount[:2], 0.3], [0.0, 0.0, mount[2]])
    T_sensor_base = np.linalg.inv(T_base_sensor)
    made = sextant.read_landmark_map
    plain, moved = tmp_path / "plain.yaml", tmp_path / "moved.yaml"
    assert main([str(written(tmp_path)), "-o", str(plain), "--params", str(alone)]) == 0
    bag = written(tmp_path, frame="sensor", mount=(*T_sensor_base[:2, 3], -mount[2]))
    assert "does not connect its frame 'sensor' with 'base_link': specify its pose by --mounts" in refused(
        capsys, bag, "-o", moved
    )
    given = ["--mounts", "sensor=0.2,-0.1,0.3,0,0,0.5", "--params", str(alone)]
    assert main([str(bag), "-o", str(moved), *given]) == 0
    assert made(str(moved)).covariance == pytest.approx(made(str(plain)).covariance, rel=1e-6, abs=1e-12)
    assert "is not up" in refused(capsys, bag, "-o", "x.yaml", "--mounts", "sensor=0,0,0,-1.57,0,-1.57")


def test_the_robot_is_found_in_a_map(drive, tmp_path, capsys):
    folder, truth = drive
    given = [str(folder / "a.bag"), "--start-map", str(folder / "map.yaml"), "--lost", "--read-only"]
    assert main([*given, "--trajectory", str(tmp_path / "poses.tum")]) == 0
    poses = read_trajectory(tmp_path / "poses.tum")
    assert len(truth) > len(poses) > 0.5 * len(truth)  # lost at first
    off = [poses[nanoseconds(s)][:2, 3] - pose[:2] for s, pose in truth.items() if nanoseconds(s) in poses]
    assert np.hypot(*np.transpose(off)).max() < 0.5
    assert "m in 60.0 s, lost for 2." in capsys.readouterr().out and not (tmp_path / "map.yaml").exists()


def test_a_second_drive_goes_on_with_the_map(drive, tmp_path, capsys):
    write_world(tmp_path / "later.bag", WORLD, begin=500.0)
    first = str(drive[0] / "a.bag")
    assert main([str(tmp_path / "later.bag"), first, "-o", str(tmp_path / "m.yaml")]) == 0
    out = capsys.readouterr().out
    assert "later.bag: begins 439 s later: read as another drive" in out and "2 drives" in out
    made = sextant.read_landmark_map(str(tmp_path / "m.yaml"))
    assert len(made.landmarks) <= 12
    assert "overlaps" in refused(capsys, first, first, "-o", tmp_path / "n.yaml")


def test_bags_that_are_read_in_parallel_give_the_same_map(tmp_path, capsys):
    """The second half of a split recording has its static transforms in the first."""
    world = LandmarkWorld(LandmarkWorldParams(seed=5, duration=20.0, landmarks=12, half_side=5.0))
    with WrittenBag(tmp_path / "1.bag") as first, WrittenBag(tmp_path / "2.bag") as second:
        first.transforms([("base_link", "sensor", np.eye(4))])
        write_drive(lambda seconds: first if seconds < 10.0 else second, world, frame="sensor")
    (tmp_path / "damaged.bag").write_bytes(b"no bag")
    both, damaged = [str(tmp_path / name) for name in ("2.bag", "1.bag")], str(tmp_path / "damaged.bag")
    maps = []
    for jobs, bags in (("1", both), ("2", [damaged, *both])):
        out = tmp_path / f"{jobs}.yaml"
        assert main([*bags, "-o", str(out), "--jobs", jobs, "--skip"]) == 0
        maps.append(out.read_text())
        assert Page((tmp_path / f"{jobs}.html").read_text()).rows
    assert maps[0] == maps[1] and "class: " in maps[0]
    out = capsys.readouterr().out
    assert f"skipped: {damaged}: " in out and "another drive" not in out
    assert "damaged.bag" in refused(capsys, *both, damaged, "-o", tmp_path / "n.yaml")


def test_the_report_is_of_maps_by_all_observations_only(drive, tmp_path, capsys):
    report = (drive[0] / "map.html").read_text()
    assert "Landmark map" in report and "blue_pillar" in report
    given = [drive[0] / "a.bag", "-o", tmp_path / "m.yaml", "--online"]
    assert "by all observations" in refused(capsys, *given, "--report", tmp_path / "m.html")
    assert main(list(map(str, given))) == 0 and not (tmp_path / "m.html").exists()


@pytest.mark.slow
@pytest.mark.parametrize("factor, size", [(0.15, "too small. Raise"), (6.0, "too large. Lower")])
def test_wrong_noise_is_reported(tmp_path, capsys, factor, size):
    def with_noise(sets):
        for _, message in sets:
            for each in message.observations:
                each.covariance = (factor * np.array(each.covariance)).tolist()
        return sets

    mapped(tmp_path, written(tmp_path, arrivals=with_noise))
    assert (
        f"the noise that is set is {size} translation_from_translation, rotation_from_translation"
        in capsys.readouterr().out
    )
