# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulated bags are what accuracy_statistics reads, and their truth is what the table states."""

import os
import re
from pathlib import Path

import numpy as np
import pytest
from accuracy_command import called
from written_bags import calibration_file

import sextant
from sextant.bags.drive_reader import read_drive
from sextant.commands.simulate_series import main
from sextant.simulation.camera import camera_calibration
from sextant.simulation.room_markers import default_map

ROOT = Path(__file__).resolve().parents[3]
TABLE = "bag,x,y,z,yaw\nnear.bag,0.5,0.5,0,0.785\nfar,0.2,-0.2,0,0.785\n"


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("survey.csv").write_text(TABLE)
    return tmp_path


def simulated(capsys, *arguments):
    code = main([str(each) for each in arguments])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


@pytest.mark.slow
def test_from_the_simulation_to_the_page(here, capsys):
    code, out, _ = simulated(capsys, "room", "--points", "survey.csv", "--images", 12, "--jobs", 2)
    assert code == 0 and sorted(os.listdir("room")) == ["far", "map.yaml", "near.bag", "points.csv"]
    assert os.listdir("room/far") == ["1.bag"] and "room/near.bag: 12 images" in out
    following = re.search(r"Next: accuracy_statistics (.*)", out).group(1).split()
    code, out, _ = called(capsys, *following, "--mode", "nearest,average,joint")
    assert code == 0 and Path("accuracy.html").exists()
    errors = dict(re.findall(r"^(joint point \d) +([\d.]+) ", out, re.M))
    assert len(errors) == 2 and max(map(float, errors.values())) < 3.0  # cm
    assert out.count("12 of 12 (100.0 %)") == 6


@pytest.mark.slow
def test_your_camera_and_your_map(here, capsys):
    lens = camera_calibration(320, 240, 1.2, distortion=(-0.1, 0.02, 0.0, 0.0, 0.0))
    calibration_file(here / "lens.yaml", lens)
    marker_map = sextant.MarkerMap("hall")
    marker = default_map().find("tag36h11", 0)
    marker_map.add(sextant.MappedMarker("tag36h11", 5, 0.3, marker.T_map_marker))
    sextant.write_marker_map(marker_map, "hall.yaml")
    Path("survey.csv").write_text("bag,x,y,z,yaw\na.bag,-1.5,1,0.1,1.5707963\n")
    arguments = ["--map", "hall.yaml", "--calibration", "lens.yaml", "--camera", 0, 0, 0.9, 0, 0, 0]
    code, _, _ = simulated(capsys, "room", "--points", "survey.csv", "--images", 3, *arguments)
    drive = read_drive("room/a.bag")
    [camera] = drive.cameras.values()
    assert code == 0 and list(camera.calibration.D) == list(lens.D)
    assert [[marker.id for marker in image.markers] for image in drive.images] == [[5]] * 3
    T_map_camera = sextant.pose_from_xyz_rpy([-1.5, 1.0, 0.1], [0, 0, 0.5 * np.pi]) @ camera.T_base_camera
    points = (
        np.c_[sextant.marker_corners(0.3), np.ones(4)] @ (np.linalg.inv(T_map_camera) @ marker.T_map_marker).T
    )
    expected = camera.model().project_points(points[:, :3])
    found = np.mean([image.markers[0].corners for image in drive.images], axis=0)
    assert np.abs(found - expected).max() < 0.3
    assert read_drive("room/a.bag").images[0].stamp < drive.images[1].stamp


@pytest.mark.parametrize(
    "table, arguments, reason",
    [
        (TABLE.replace("0.5,0.5", "9,9"), [], "survey.csv:2: the camera is outside of the room"),
        (TABLE.replace("0.785", "unknown"), [], "survey.csv:2: yaw is unknown; a simulated robot needs"),
        (TABLE.replace("near.bag", "../near.bag"), [], "survey.csv:2: ../near.bag is not in room"),
        (TABLE, ["--images", 0], "--images is 0"),
        (TABLE, ["--map", "absent.yaml"], "absent.yaml"),
        (TABLE, ["--calibration", "absent.yaml"], "absent.yaml: cannot be read"),
        (TABLE, ["--points", "absent.csv"], "absent.csv"),
        (TABLE, ["--family", "tag99"], "tag99"),
    ],
)
def test_what_cannot_be_simulated(here, capsys, table, arguments, reason):
    Path("survey.csv").write_text(table)
    code, out, err = simulated(capsys, "room", "--points", "survey.csv", "--images", 1, *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1) and reason in err
    assert os.listdir() == ["survey.csv"]


def test_existing_files_stay(here, capsys):
    (here / "room").mkdir()
    Path("room/near.bag").write_text("mine")
    arguments = ["room", "--points", "survey.csv", "--images", 1]
    assert "near.bag: already exists; --force" in simulated(capsys, *arguments)[2]
    assert Path("room/near.bag").read_text() == "mine"
    assert simulated(capsys, *arguments, "--force")[0] == 0
    assert simulated(capsys, *arguments, "--force")[0] == 0
