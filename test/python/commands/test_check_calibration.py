# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The command, on rendered photos of a marker through a lens that is known."""

import cv2
import numpy as np
import pytest
from calibration_photos import (  # noqa: F401, photos: the rendered ones
    FOCAL,
    PLACES,
    SIZE,
    calibration_text,
    marker_toward,
    photograph,
    photos,
)

import sextant
from sextant.calibration.calibration_file import CalibrationFileError, read_calibration
from sextant.commands.check_calibration import main

MARKER = ["--family", "tag36h11", "--size", str(SIZE)]


@pytest.fixture(autouse=True)
def inside(photos, monkeypatch):  # noqa: F811, the fixture
    monkeypatch.chdir(photos)


@pytest.mark.slow
def test_a_good_calibration(capsys):
    assert main(["right.yaml", *MARKER, "0.7", "1.2", "2.4"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[-1] == "good: the calibration is still good"
    rows = [line.split() for line in lines[1:4]]
    assert [(float(row[0]), row[4]) for row in rows] == [(0.7, "5"), (1.2, "5"), (2.4, "5")]
    np.testing.assert_allclose([float(row[2]) for row in rows], [0.7, 1.2, 2.4], rtol=0.005)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name, words", [("long.yaml", "% too long"), ("shifted.yaml", "the principal point x is off by +1")]
)
def test_a_calibration_that_is_not(capsys, name, words):
    assert main([name, "0.7", *MARKER, "1.2", "2.4"]) == 1  # photos before and after options
    last = capsys.readouterr().out.splitlines()[-1]
    assert last.startswith("NOT GOOD: ") and words in last


def test_photos_that_do_not_suffice(capsys):
    assert main(["right.yaml", *MARKER, "1.2/0.png", "--also", "0.7"]) == 2
    assert "undecided: three measured distances are needed" in capsys.readouterr().out


def test_distances_from_a_file_and_a_marker_by_its_id(capsys):
    assert main(["right.yaml", *MARKER, "--id", "0", "--distances", "tape.txt"]) == 2
    rows = capsys.readouterr().out.splitlines()[1:3]
    assert [row.split()[0] for row in rows] == ["0.700", "1.200"]


def test_a_board_by_its_map(tmp_path, capsys):
    board, random = sextant.MarkerMap("board"), np.random.default_rng(1)
    T_camera_marker = marker_toward(PLACES[0], 1.2, random)
    Ts = [sextant.pose_from_xyz_rpy([x, 0.0, 0.0], [0.0, 0.0, 0.0]) for x in (-0.15, 0.15)]
    for number, T in enumerate(Ts):
        board.add(sextant.MappedMarker("tag36h11", number, SIZE, T))
    sextant.write_marker_map(board, str(tmp_path / "board.yaml"))
    (tmp_path / "1.2").mkdir()
    cv2.imwrite(str(tmp_path / "1.2/a.png"), photograph([T_camera_marker @ T for T in Ts], 1))
    assert main(["right.yaml", "--map", str(tmp_path / "board.yaml"), str(tmp_path / "1.2")]) == 2
    row = capsys.readouterr().out.splitlines()[1].split()
    assert float(row[2]) == pytest.approx(1.2, rel=0.005) and row[4] == "1"


@pytest.mark.parametrize(
    "line, reason",
    [
        ("right.yaml 0.7", "--family is needed, or --map"),
        ("right.yaml --family tag36h11 0.7", "--size is needed"),
        ("right.yaml --family tag36h11 --size 0 0.7", "--size is 0.0, allowed is"),
        ("right.yaml --family tag36h11 --size 0.16 --map board.yaml 0.7", "--family has no effect"),
        ("right.yaml --family tag99 --size 0.16 0.7", "tag99"),
        ("right.yaml --family tag36h11 --size 0.16", "no photos are given"),
        ("right.yaml --family tag36h11 --size 0.16 absent", "absent: there is no such photo or folder"),
        ("right.yaml --family tag36h11 --size 0.16 two/a.png", "must be the distance in metres, not 'two'"),
        ("right.yaml --family tag36h11 --size 0.16 --also two/small.pgm", "has 320 x 240 pixels"),
        ("right.yaml --family tag36h11 --size 0.16 --also right.yaml", "right.yaml: is not an image"),
        ("right.yaml --family tag36h11 --size 0.16 --distances tape.txt", "two/a.png: shows the markers"),
        ("right.yaml --family tag36h11 --size 0.16 --tape-sigma 0 0.7", "tape_sigma: must be"),
        ("absent.yaml --family tag36h11 --size 0.16 0.7", "absent.yaml: cannot be read"),
        ("tape.txt --family tag36h11 --size 0.16 0.7", "tape.txt: is not a calibration"),
    ],
)
def test_what_is_refused(capsys, line, reason):
    assert main(line.split()) == 2
    captured = capsys.readouterr()
    assert captured.out == "" and captured.err.count("\n") == 1
    assert captured.err.startswith("check_calibration: ") and reason in captured.err


def test_distances_that_are_none(tmp_path, capsys):
    for text, reason in (
        ("a.png 1.0", "tape.txt:1: there is no photo 'a.png'"),
        ("\ntape.txt 1,0", "tape.txt:2:"),
    ):
        (tmp_path / "tape.txt").write_text(text)
        assert main(["right.yaml", *MARKER, "--distances", str(tmp_path / "tape.txt")]) == 2
        assert reason in capsys.readouterr().err


@pytest.mark.parametrize(
    "old, new, reason",
    [
        ("image_width: 640\n", "", "has no image_width"),
        ("image_width: 640", "image_width: wide", "image_width is 'wide'"),
        ("plumb_bob", "plumb", "plumb"),
        ("cols: 5", "cols: 4", "distortion_coefficients has 5 numbers and the shape 1 x 4"),
        ("[-0.05, ", "[.nan, ", "distortion_coefficients needs 'data', a list of numbers"),
        (f"data: [{FOCAL}, 0., 319.5, 0., {FOCAL}", "data: [0, 0., 319.5, 0., 0", ""),
        ("rows: 3, cols: 4", "rows: 3", "projection_matrix has 12 numbers and the shape 3 x None"),
        ("image_height: 480", "image_height: [", "file.yaml:"),
    ],
)
def test_calibrations_that_are_none(tmp_path, old, new, reason):
    text = calibration_text()
    assert old in text
    (tmp_path / "file.yaml").write_text(text.replace(old, new))
    with pytest.raises(CalibrationFileError) as refused:
        read_calibration(tmp_path / "file.yaml")
    assert str(refused.value).startswith(f"{tmp_path}/file.yaml:") and reason in str(refused.value)


def test_small_numbers_as_camera_info_manager_writes_them(tmp_path):
    (tmp_path / "file.yaml").write_text(calibration_text().replace("[-0.05, 0.02,", "[-5e-05, 0.02,"))
    assert read_calibration(tmp_path / "file.yaml").D[0] == -5e-5
