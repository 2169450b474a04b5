# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""From bags of a robot that stands at surveyed points to workbook and page, as their user calls it."""

import os
import re
from pathlib import Path

import numpy as np
import openpyxl
import pytest
from accuracy_command import called, refused
from geometry_msgs.msg import PoseWithCovarianceStamped
from html_page import Page
from still_series import CALIBRATION, exact_corners
from written_bags import WrittenBag, header

import sextant
from sextant.messages.pose_messages import pose_to_message
from sextant.simulation.camera import camera_mount
from sextant.simulation.room_markers import default_map

MOUNT = camera_mount([0.1, 0.0, 1.0], [0.0, 0.0, 0.0])
POINTS = {"p1.bag": (0.0, 0.0, 0.785), "p2": (-0.61, 0.61, 0.785)}  # x, y, yaw
BLIND = 10  # images of p1 without a marker
COUNT = 30
MODES = "nearest,average,joint"
ARGUMENTS = ["--points", "points.csv", "--map", "map.yaml", "--mode", MODES]


def seen(T_map_camera, random, sigma):
    """Detections of the markers of the room: exact corners plus noise of sigma pixels."""
    found = []
    for marker in default_map().markers:
        T_marker_camera = np.linalg.inv(marker.T_map_marker) @ T_map_camera
        ahead = np.linalg.inv(T_marker_camera)[2, 3] > 0.2
        corners = exact_corners(T_marker_camera)
        if ahead and np.all((corners > 2.0) & (corners < [CALIBRATION.width - 2, CALIBRATION.height - 2])):
            noise = sigma * random.normal(size=(4, 2))
            found.append(sextant.Detection(marker.family, marker.id, corners + noise))
    return found


def write_point(path, point, seed, mount=MOUNT, sigma=0.2, blind=0):
    """A bag of recorded markers; mount None: the bag has no tf."""
    path.parent.mkdir(exist_ok=True)
    x, y, yaw = point
    T_map_base = sextant.pose_from_xyz_rpy([x, y, 0.0], [0.0, 0.0, yaw])
    random = np.random.default_rng(seed)
    with WrittenBag(path) as bag:
        if mount is not None:
            bag.transforms([("base_link", "camera", mount)])
        T_map_camera = T_map_base @ (MOUNT if mount is None else mount)
        for k in range(COUNT + blind):
            markers = seen(T_map_camera, random, sigma) if k < COUNT else []
            bag.markers("/markers", markers, CALIBRATION, 0.05 * k)


def write_table(rows):
    Path("points.csv").write_text("bag,x,y,z,yaw\n" + "".join(f"{','.join(map(str, row))}\n" for row in rows))


@pytest.fixture
def survey(tmp_path, monkeypatch):
    """Two points, one of them a folder; the command runs beside the table."""
    monkeypatch.chdir(tmp_path)
    write_point(tmp_path / "p1.bag", POINTS["p1.bag"], 1, blind=BLIND)
    write_point(tmp_path / "p2/a.bag", POINTS["p2"], 2)
    sextant.write_marker_map(default_map(), "map.yaml")
    write_table([(name, x, y, 0.0, yaw) for name, (x, y, yaw) in POINTS.items()])
    return tmp_path


def table_of(out):
    """{method and place: (mean, deviation, 95 %, worst in cm, poses)} as printed."""
    rows = re.findall(r"^(\w*) ?(point \d|all) +([\d.]+) +([\d.]+) +([\d.]+) +([\d.]+)   (\d+) ", out, re.M)
    return {f"{method} {place}".strip(): tuple(map(float, values)) for method, place, *values in rows}


def together(method=None):
    """{method: cells} of the page's table of all points; of a method: {axis: cells} of its errors."""
    rows = Page(Path("accuracy.html").read_text()).rows
    if method is None:
        return {row[0]: row[1:] for row in rows if len(row) == 6 and row[1][:1].isdigit()}
    return {row[1]: row[3:] for row in rows if len(row) == 7 and row[0] == method}


@pytest.mark.slow
def test_modes_side_by_side(survey, capsys):
    before = set(os.listdir())
    code, out, _ = called(capsys, *ARGUMENTS)
    endings = (".html", ".xlsx", ".yaml", "_comparison.png", "_points.png")
    assert code == 0 and set(os.listdir()) - before == {f"accuracy{ending}" for ending in endings}
    table = table_of(out)
    assert set(table) == {f"{mode} {at}" for mode in MODES.split(",") for at in ("point 1", "point 2", "all")}
    assert table["joint point 1"][0] < 0.7 * table["average point 1"][0]  # it sees two markers
    assert table["joint all"][2] < 5.0
    assert "joint point 1" in out and f"{COUNT} of {COUNT + BLIND} (75.0 %)" in out
    assert together()["joint"][0] == f"{2 * COUNT} of {2 * COUNT + BLIND} (85.7 %)"
    book = openpyxl.load_workbook("accuracy.xlsx")
    rows = {tuple(row[:2]): row for row in book["errors"].values if row[5] == "position"}
    row = rows["joint", "point 2"]
    assert row[2:5] == (COUNT, COUNT, 1.0)
    assert 100.0 * np.array(row[7:]) == pytest.approx(table["joint point 2"][:4], abs=0.006)
    raw = np.array([row[3:6] for row in book["joint point 2"].values][1:], dtype=float)
    errors = np.linalg.norm(raw - [*POINTS["p2"][:2], 0.0], axis=1)
    expected = [errors.mean(), errors.std(ddof=1), np.percentile(errors, 95), errors.max()]
    assert row[7:] == pytest.approx(expected)


@pytest.mark.slow
def test_two_processes_print_the_same(survey, capsys):
    one = called(capsys, *ARGUMENTS, "-o", "run_1")[1].replace("run_1", "")
    assert one == called(capsys, *ARGUMENTS, "-o", "run_2", "--jobs", "2")[1].replace("run_2", "")
    assert Path("run_1.html").read_text() == Path("run_2.html").read_text()


@pytest.mark.slow
def test_an_error_of_the_survey_is_the_error(survey, capsys):
    """With exact corners, the errors are those of the table."""
    write_point(survey / "p1.bag", POINTS["p1.bag"], 1, sigma=0.0)
    write_table([("p1.bag", 0.03, -0.04, 0.0, 0.785)])
    one_mode = [*ARGUMENTS[:4], "--corner-sigma", "0.2", "--true", "roll=0"]
    code, out, _ = called(capsys, *one_mode)
    assert code == 0 and table_of(out)["all"] == pytest.approx((5.0, 0.0, 5.0, 5.0, COUNT), abs=0.01)
    means = {axis: cells[0] for axis, cells in together("all").items()}
    assert means == {"x": "-3.00", "y": "4.00", "z": "0.00", "roll": "0.00", "yaw": "0.00"}
    names = ("accuracy_errors.png", "accuracy_spread.png", "accuracy_points.png")
    assert all(Path(name).exists() for name in names)


@pytest.mark.slow
def test_the_yaw_of_a_camera_without_a_robot_is_its_viewing_direction(survey, capsys):
    x, y, yaw = POINTS["p1.bag"]
    write_point(survey / "p1.bag", POINTS["p1.bag"], 1, mount=None, sigma=0.0)
    place = [x + 0.1 * np.cos(yaw), y + 0.1 * np.sin(yaw), 1.0]  # of the lens
    write_table([("p1.bag", *place, yaw)])
    code, out, _ = called(capsys, *ARGUMENTS[:4], "--corner-sigma", "0.2")
    assert code == 0 and table_of(out)["all"][3] < 0.01
    assert together("all")["yaw"][-1] == "0.00"


def test_topics_side_by_side(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    with WrittenBag(tmp_path / "p1.bag") as bag:
        for topic, shift in (("/pose", 0.02), ("/ekf/pose", 0.01)):
            for k in range(10):
                message = PoseWithCovarianceStamped(header=header(0.1 * k, "map"))
                place = [1.0 + shift, 0.0, 0.0]
                message.pose.pose = pose_to_message(sextant.pose_from_xyz_rpy(place, [0, 0, 0.01 * k]))
                bag.write(topic, message, 0.1 * k)
    write_table([("p1.bag", 1.0, 0.0, 0.0, "unknown")])
    code, out, _ = called(capsys, "--points", "points.csv", "--pose", "/pose,/ekf/pose")
    assert code == 0 and re.search(r"^/ekf/pose all +1\.00 +0\.00 +1\.00 +1\.00   10 poses$", out, re.M)
    assert openpyxl.load_workbook("accuracy.xlsx").sheetnames[4:6] == [".pose point 1", ".ekf.pose summary"]
    assert together()["/pose"][:2] == ["10 poses", "2.00"]


@pytest.mark.parametrize(
    "arguments, reason",
    [
        (["--mode", "best"], "--mode best: allowed are average, joint, nearest, or several"),
        (["--mode", ","], "--mode ,: allowed are"),
        (["--axis", "x"], "--axis has no effect for surveyed points"),
        (["--truth-frame", "truth"], "--truth-frame has no effect for surveyed points"),
        (["--true", "x=1"], "the true x is in --points"),
        (["--true", "w=1"], "'w' is not an axis"),
        (["--pose", "/pose", "--mode", "nearest"], "--mode has no effect with --pose"),
        (["--pose", "/pose"], "there is no pose on /pose"),
        (["p1.bag"], "p1.bag: the bags of surveyed points are named in --points"),
        (["--align-start", "/odom"], "--align-start has no effect"),
    ],
)
def test_options_that_cannot_be(survey, capsys, arguments, reason):
    assert reason in refused(capsys, *ARGUMENTS[:4], *arguments)


@pytest.mark.slow
def test_what_is_missing_is_refused_or_skipped(survey, capsys):
    assert "set --map" in refused(capsys, *ARGUMENTS[:2])
    assert "absent.csv" in refused(capsys, "--points", "absent.csv", *ARGUMENTS[2:4])
    with open("points.csv", "a") as file:
        file.write("p3.bag,0,0,0,0\n")
    reason = "points.csv:4: there is no bag p3.bag; correct the name, or record it"
    assert reason in refused(capsys, *ARGUMENTS)
    code, out, _ = called(capsys, *ARGUMENTS[:4], "--skip")
    assert code == 0 and f"skipped: {reason}" in out and set(table_of(out)) == {"point 1", "point 2", "all"}
    write_table([("p9.bag", 0, 0, 0, 0)])
    assert "points.csv:2: there is no bag p9.bag" in refused(capsys, *ARGUMENTS, "--skip", "-o", "other")
