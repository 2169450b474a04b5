# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The command, on sweeps of few small images."""

import csv
from pathlib import Path

import cv2
import pytest
from calibration_photos import calibration_text

from sextant.commands.design_markers import main

QUICK = "--resolution 320x240 --size 0.1 0.2 --distance 0.5 --angle 30 --images 3 --in-view 1".split()


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Commands run in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(capsys, *arguments):
    """Exit status, and what went to both streams."""
    status = main([str(each) for each in arguments])
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def test_it_answers_and_writes_a_table_and_heat_maps(capsys):
    status, out, err = run(capsys, *QUICK, "--target", "0.02", "1")
    assert (status, err) == (0, "")
    assert "320 x 240, f = 266 px, tag36h11, noise 4, light 200; worst of 30 degrees" in out
    assert "for 2 cm at 1 m with a field of view of 62 degrees, 320 x 240, tag36h11: markers of 0.1 m" in out
    assert {path.name for path in Path().iterdir()} == {"design.csv", "design.png"}
    assert cv2.imread("design.png").shape[1] > 500
    rows = list(csv.DictReader(Path("design.csv").read_text().splitlines()))
    assert [(row["size, m"], row["distance, m"]) for row in rows] == [
        *(("0.1", "0.5"), ("0.1", "1.0"), ("0.2", "0.5"), ("0.2", "1.0"))
    ]


def test_a_target_that_is_not_reached_is_an_exit_code(capsys):
    status, out, _ = run(capsys, *QUICK, "--target", "0.000001", "0.5")
    assert status == 1 and "with one in view no size of this sweep" in out


def test_camera_of_a_calibration_file(capsys):
    Path("camera.yaml").write_text(calibration_text())
    status, out, _ = run(capsys, "--calibration", "camera.yaml", *QUICK, "--target", "0.05", "0.5")
    assert status == 0
    assert "320 x 240, f = 266 px" in out and "for 5 cm at 0.5 m with camera.yaml, 320 x 240, tag36h11" in out


@pytest.mark.slow
def test_each_setup_has_its_heat_maps(capsys):
    conditions = ["--noise", "2", "8", "--family", "tag36h11", "tag16h5", "--size", "0.2", "--images", "1"]
    status, out, _ = run(capsys, *QUICK[:2], *conditions, *QUICK[5:9], "--in-view", "1", "-o", "hall")
    assert status in (0, 1)
    cameras = [f"hall_320x240_{family}" for family in ("tag36h11", "tag16h5")]
    endings = ("_noise2_light200.png", "_noise8_light200.png", "_conditions.png")
    written = {"hall.csv", *(camera + ending for camera in cameras for ending in endings)}
    assert {path.name for path in Path().iterdir()} == written
    assert all(name in out for name in written)


@pytest.mark.parametrize(
    "arguments, reason",
    [
        (["--calibration", "none.yaml"], "none.yaml: cannot be read: No such file"),
        (["--resolution", "640"], "'640' is not of the form WIDTHxHEIGHT, e.g. 640x480 (see --help)"),
        (["--size", "0"], "size: each must be within (0, 10]"),
        (["--size", "wide"], "see --help"),
        (["--in-view", "11"], "in_view: each must be within [1, 10]"),
        (["--family", "tag99h1"], "unknown marker family 'tag99h1'"),
        (["--target", "0", "2"], "--target: the error must be above 0 m, is 0"),
        (["--target", "0.02", "0"], "distance: each must be within [0.1, 100.0]"),
        (["--jobs", "0"], "jobs is 0"),
        (["-o", "no/design"], "no/design.csv: there is no folder no"),
        (["-o", "design."], "is not a prefix of file names"),
        (["-o", "mine"], "mine.png: already exists; --force overwrites it"),
        (["--calibration", "camera.yaml", "--fov", "90"], "--fov has no effect with --calibration"),
        (
            ["--calibration", "camera.yaml", "--resolution", "1280x720"],
            "1280 x 720 is not the aspect ratio of the calibration, 640 x 480",
        ),
    ],
)
def test_mistakes_are_one_line(capsys, arguments, reason):
    Path("mine.png").write_text("mine")
    Path("camera.yaml").write_text(calibration_text())
    status, out, err = run(capsys, *arguments)
    assert (status, out) == (2, "") and err.count("\n") == 1
    assert err.startswith("design_markers: ") and reason in err
    assert sorted(path.name for path in Path().iterdir()) == ["camera.yaml", "mine.png"]
    assert Path("mine.png").read_text() == "mine"
