# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""From bags to workbook, plots and parameters, as their user calls it."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import openpyxl
import pytest
import yaml
from accuracy_command import called, refused
from geometry_msgs.msg import PoseWithCovarianceStamped
from still_series import CALIBRATION, ID, SIZE, facing, noisy_corners, write_series
from written_bags import WrittenBag, header, small_drive

import sextant
from sextant.commands import simulate_series
from sextant.commands.accuracy_statistics import main
from sextant.messages.pose_messages import pose_to_message
from sextant.simulation.drive import DriveParams, SimulatedDrive

SIGMA = 0.2  # pixels
COUNT = 300
ENDINGS = (".html", ".xlsx", ".yaml", "_constant.yaml", "_errors.png", "_spread.png")
FILES = ["accuracy" + ending for ending in ENDINGS]
ROOT = Path(__file__).resolve().parents[3]
PAGE = (ROOT / "doc/how_to/accuracy.md").read_text()


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """Three distances, one of them with two bags."""
    folder = tmp_path_factory.mktemp("series")
    for seed, (name, distance) in enumerate([("0.757/a", 0.757), ("2/a", 2.0), ("2/b", 2.0), ("2.5/a", 2.5)]):
        write_series(folder / f"{name}.bag", noisy_corners(facing(distance), COUNT, SIGMA, seed))
    return folder


@pytest.fixture
def series(recorded, tmp_path, monkeypatch):
    """A copy, beside which the command runs."""
    monkeypatch.chdir(tmp_path)
    return str(shutil.copytree(recorded, tmp_path / "series"))


@pytest.mark.slow
def test_what_is_published_is_what_is_measured(series, capsys):
    code, out, _ = called(capsys, series, "--size", SIZE)
    assert code == 0 and sorted(set(os.listdir()) - {"series"}) == FILES
    rows = re.findall(r"^ +([\d.]+) m +(\d+) +" + r"([-\d.]+) +" * 8 + r"([-\d.]+)$", out, re.M)
    assert [(row[0], row[1]) for row in rows] == [("0.757", "300"), ("2", "600"), ("2.5", "300")]
    for row in rows:
        bias, std, published = np.array(row[2:], dtype=float).reshape(3, 3)
        error = bias - [1000.0 * float(row[0]) * np.tan(0.5), 0.0, 0.0]  # it stands aside
        assert np.all(np.abs(error) < 5.0 * std / np.sqrt(300) + 0.1)
        np.testing.assert_allclose(published, std, rtol=0.15, atol=0.1)
    with open("accuracy.yaml") as file:
        assert yaml.safe_load(file)["corner_sigma"] == pytest.approx(SIGMA, rel=0.05)
    with open("accuracy_constant.yaml") as file:
        assert len(yaml.safe_load(file)["constant_covariance"]) == 36
    book = openpyxl.load_workbook("accuracy.xlsx")
    assert book.sheetnames == ["errors", "summary", "covariance", "bags", "0.757 m", "2 m", "2.5 m"]
    assert book["2 m"].max_row > 600


@pytest.mark.slow
def test_modes_at_distances(series, capsys):
    """One marker: nearest and average have the same pose."""
    code, out, _ = called(capsys, series, "--mode", "nearest,average")
    rows = re.findall(r"^ *(nearest|average) ([\d.]+ m .*)$", out, re.M)
    assert code == 0 and len(rows) == 6 and [row for _, row in rows[:3]] == [row for _, row in rows[3:]]
    assert Path("accuracy_comparison.png").exists() and not Path("accuracy_errors.png").exists()
    assert "no constant covariance: several methods were compared" in out
    sheets = openpyxl.load_workbook("accuracy.xlsx").sheetnames
    assert sheets[:2] == ["errors", "nearest summary"] and sheets[-1] == "average 2.5 m"


@pytest.mark.slow
def test_two_processes_print_the_same(series, capsys):
    one = called(capsys, series, "-o", "run_1")[1].replace("run_1", "")
    two = called(capsys, series, "-o", "run_2", "--jobs", "2")[1].replace("run_2", "")
    assert one == two
    assert Path("run_1.yaml").read_text() == Path("run_2.yaml").read_text()
    books = [openpyxl.load_workbook(f"{name}.xlsx").worksheets for name in ("run_1", "run_2")]
    for sheets in zip(*books):
        assert list(sheets[0].values) == list(sheets[1].values)


@pytest.mark.slow
def test_the_executable_with_two_processes(series):
    command = [sys.executable, str(ROOT / "scripts/accuracy_statistics"), series, "--jobs", "2"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stderr) == (0, "")
    assert sorted(set(os.listdir()) - {"series"}) == FILES


@pytest.mark.slow
def test_files_that_are_there_stay(series, capsys):
    Path("accuracy_spread.png").write_text("mine")
    assert "accuracy_spread.png: already exists; --force overwrites it" in refused(capsys, series)
    assert called(capsys, series, "--force")[0] == 0
    assert Path("accuracy_spread.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
@pytest.mark.parametrize("what", ["no images", "no number", "cut off", "no bag"])
def test_what_cannot_be_read_is_named_and_refused_or_skipped(series, capsys, what):
    if what == "no images":
        with WrittenBag(f"{series}/2/c.bag") as bag:
            bag.odometry("/odom", np.eye(4), 0.0)
        named, reason = "2/c.bag", "neither images nor recorded markers"
    elif what == "no number":
        os.rename(f"{series}/2.5", f"{series}/far")
        named, reason = "'far'", "its name is not a distance"
    elif what == "cut off":
        whole = Path(f"{series}/0.757/a.bag").read_bytes()
        Path(f"{series}/0.757/a.bag").write_bytes(whole[: len(whole) // 2])
        named, reason = "0.757/a.bag", "rosbag reindex"
    else:
        os.mkdir(f"{series}/6.5")
        named, reason = "'6.5'", "there is no bag in it"
    errors = refused(capsys, series)
    assert named in errors and reason in errors
    code, out, _ = called(capsys, series, "--skip")
    [line] = [line for line in out.splitlines() if line.startswith("skipped: ")]
    assert code == 0 and named in line and reason in line
    assert f"{COUNT} " in out and sorted(set(os.listdir()) - {"series"}) == FILES


@pytest.mark.slow
def test_a_distance_from_which_nothing_was_seen_is_in_the_workbook(series, capsys):
    write_series(Path(series) / "7/a.bag", [])
    with WrittenBag(f"{series}/7/a.bag") as bag:
        for k in range(3):
            bag.markers("/markers", [], CALIBRATION, 0.1 * k)
    code, out, _ = called(capsys, series)
    assert code == 0 and re.search(r"^ +7 m +0 +- +- +-", out, re.M)
    assert "7 m" in openpyxl.load_workbook("accuracy.xlsx").sheetnames


@pytest.mark.slow
def test_other_truths(series, capsys):
    code, out, _ = called(capsys, series, "--true", "x=0.01", "y=unknown")
    assert code == 0
    row = next(line.split() for line in out.splitlines() if line.startswith("   0.757 m"))
    assert float(row[3]) == pytest.approx(757.0 * np.tan(0.5) - 10.0, abs=0.5) and row[4] == "-"


@pytest.mark.parametrize(
    "arguments, reason",
    [
        (["--true", "w=1"], "'w' is not an axis"),
        (["--true", "z=1"], "the true z is the distance"),
        (["--true", "x=left"], "'left' is neither a number nor unknown"),
        (["--axis", "w"], "invalid choice: 'w'"),
        (["--marker", "600"], "marker 600 was not seen: check --family"),
        (["--size", "0"], "size must be in (0, 100] m"),
        (["--map", "absent.yaml"], "absent.yaml"),
        (["--corner-sigma", "0"], "corner_sigma"),
        (["--pose", "/pose"], "there is no pose on /pose"),
        (["-o", "absent/accuracy"], "there is no folder absent"),
        (["another"], "a series is one folder"),
        (["--base-frame", "robot"], "--base-frame has no effect for a series"),
        (["--align"], "--align has no effect for a series"),
        (["--pose", "/pose", "--corner-sigma", "1"], "--corner-sigma has no effect with --pose"),
        (["--family", "tag99"], "tag99"),
        (["--pose", "/pose", "--size", "0.3"], "--size has no effect without a map"),
    ],
)
def test_options_that_cannot_be(series, capsys, arguments, reason):
    assert reason in refused(capsys, series, *arguments)


@pytest.mark.slow
def test_several_markers_need_a_name(series, capsys):
    Path(f"{series}/2/b.bag").unlink()
    with WrittenBag(f"{series}/2/b.bag") as bag:
        for k, corners in enumerate(noisy_corners(facing(2.0), COUNT, SIGMA, 9)):
            pair = [sextant.Detection("tag36h11", id, corners + 30.0 * (id - ID)) for id in (ID, ID + 1)]
            bag.markers("/markers", pair, CALIBRATION, 0.05 * k)
    assert "7 of tag36h11, 8 of tag36h11; set the measured" in refused(capsys, series)
    assert called(capsys, series, "--marker", ID)[0] == 0


@pytest.mark.slow
def test_the_family_selects_one_of_two_of_one_id(series, capsys):
    Path(f"{series}/2/b.bag").unlink()
    with WrittenBag(f"{series}/2/b.bag") as bag:
        for k, corners in enumerate(noisy_corners(facing(2.0), COUNT, SIGMA, 9)):
            pair = [sextant.Detection(family, ID, corners) for family in ("tag36h11", "tag25h9")]
            bag.markers("/markers", pair, CALIBRATION, 0.05 * k)
    assert "7 of tag25h9, 7 of tag36h11; set the measured" in refused(capsys, series, "--family", "tag16h5")
    code, out, _ = called(capsys, series, "--marker", ID, "--family", "tag25h9")
    counts = re.findall(r"^ +([\d.]+) m +(\d+) ", out, re.M)
    assert code == 0 and counts == [("0.757", "0"), ("2", str(COUNT)), ("2.5", "0")]


@pytest.mark.slow
def test_too_few_images_for_the_noise(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_series(tmp_path / "series/1/a.bag", noisy_corners(facing(1.0), 10, SIGMA, 1))
    assert "there are 9; set --corner-sigma" in refused(capsys, "series")
    assert called(capsys, "series", "--corner-sigma", "0.2")[0] == 0


def test_poses_in_two_frames_are_not_mixed(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name in ("map", "odom"):
        path = tmp_path / f"series/1/{name}.bag"
        path.parent.mkdir(parents=True, exist_ok=True)
        with WrittenBag(path) as bag:
            message = PoseWithCovarianceStamped(header=header(1.0, name))
            message.pose.pose.orientation.w = 1.0
            bag.write("/pose", message, 1.0)
    errors = refused(capsys, "series", "--pose", "/pose")
    assert "not all in one frame: 'map' in 1/map.bag, 'odom' in 1/odom.bag" in errors


@pytest.mark.slow
def test_poses_that_the_robot_published(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "series/1.5").mkdir(parents=True)
    random = np.random.default_rng(1)
    with WrittenBag(tmp_path / "series/1.5/a.bag") as bag:
        stale = PoseWithCovarianceStamped(header=header(0.5, "map"))
        stale.pose.pose = pose_to_message(sextant.pose_from_xyz_rpy([9.0, 9.0, 9.0], [0, 0, 0]))
        bag.write("/pose", stale, 1.0)
        for k in range(100):
            message = PoseWithCovarianceStamped(header=header(1.0 + 0.1 * k, "map"))
            place, rpy = [1.52, 0.0, 0.0] + 0.01 * random.normal(size=3), 0.01 * random.normal(size=3)
            message.pose.pose = pose_to_message(sextant.pose_from_xyz_rpy(place, rpy))
            message.pose.covariance = np.diag([0.02**2] * 6).ravel()
            bag.write("/pose", message, 1.0 + 0.1 * k)
    code, out, _ = called(capsys, "series", "--pose", "/pose", "--axis", "x")
    assert code == 0
    row = next(line.split() for line in out.splitlines() if line.startswith("     1.5 m"))
    assert row[2] == "100"  # and not the one that was stamped before the bag
    assert float(row[3]) == pytest.approx(20.0, abs=3.0) and float(row[6]) == pytest.approx(10.0, rel=0.2)
    assert row[4:6] == ["-", "-"] and float(row[9]) == pytest.approx(20.0)
    assert "1.5/a.bag: left out: 1 poses stamped before the bag began" in out
    assert not os.path.exists("accuracy.yaml") and os.path.exists("accuracy_constant.yaml")
    Path("accuracy.yaml").write_text("corner_sigma: 0.2")
    again = called(capsys, "series", "--pose", "/pose", "--axis", "x", "--force")[1]
    assert "accuracy.yaml: left from an earlier run" in again
    assert Path("accuracy.yaml").read_text() == "corner_sigma: 0.2"


@pytest.mark.slow
def test_images_of_a_camera_on_a_robot(tmp_path, monkeypatch, capsys):
    """tf and odometry of a robot change nothing: the poses are the camera's."""
    monkeypatch.chdir(tmp_path)
    drive = SimulatedDrive(DriveParams(noise_sigma=4.0, obstacles=False))
    T_map_marker = drive.map.find("tag36h11", 0).T_map_marker
    (tmp_path / "series/1.2").mkdir(parents=True)
    scene = sextant.RoomScene(drive.room, drive.map)
    camera = sextant.CameraModel(drive.calibration)
    renderer = sextant.RoomRenderer(drive.params.renderer_params(), scene, camera)
    with WrittenBag(tmp_path / "series/1.2/a.bag") as bag:
        bag.transforms([("base_link", "camera", drive.T_base_camera)])
        for k in range(30):
            bag.info("/cam/camera_info", drive.calibration, 0.1 * k)
            image = renderer.render([T_map_marker @ facing(1.2, 0.4)], k)
            bag.compressed("/cam/image_raw/compressed", image, 0.1 * k)
            bag.odometry("/odom", np.eye(4), 0.1 * k)
    code, out, _ = called(capsys, "series", "--marker", "0")
    row = next(line.split() for line in out.splitlines() if line.startswith("     1.2 m"))
    assert code == 0 and row[2] == "30"
    assert float(row[3]) == pytest.approx(1200.0 * np.tan(0.4), abs=3.0) and abs(float(row[5])) < 2.0


def test_a_bag_of_pictures_without_markers(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "series/1.0").mkdir(parents=True)
    small_drive(tmp_path / "series/1.0/a.bag", images=30)
    assert "no marker was seen: check --family" in refused(capsys, "series")


def test_options_are_those_of_the_page(capsys):
    options = set()
    for command in (main, simulate_series.main):
        with pytest.raises(SystemExit):
            command(["--help"])
        options |= set(re.findall(r"^  .*?(--[a-z-]+)", capsys.readouterr().out, re.M)) - {"--help"}
    assert set(re.findall(r"(--[a-z][a-z-]+)", PAGE)) == options
