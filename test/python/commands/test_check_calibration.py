# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The command, on rendered photos of a marker through a lens that is known."""

import cv2
import numpy as np
import pytest

import sextant
from sextant.calibration.calibration_file import CalibrationFileError, read_calibration
from sextant.commands.check_calibration import main
from sextant.simulation.camera import camera_calibration
from sextant.simulation.room import room_for

SIZE, FOCAL = 0.16, 532.5
DISTORTION = [-0.05, 0.02, 0.0, 0.0, 0.0]
PLACES = [(319.5, 239.5), (105.0, 95.0), (535.0, 95.0), (105.0, 385.0), (535.0, 385.0)]  # pixels
MARKER = ["--family", "tag36h11", "--size", str(SIZE)]


def calibration_text(focal=FOCAL, shift=0.0, distortion=DISTORTION):
    """As camera_calibration writes it."""
    K = f"[{focal}, 0., {319.5 + shift}, 0., {focal}, 239.5, 0., 0., 1.]"
    P = f"[{focal}, 0., {319.5 + shift}, 0., 0., {focal}, 239.5, 0., 0., 0., 1., 0.]"
    return f"""\
image_width: 640
image_height: 480
camera_name: camera
camera_matrix: {{rows: 3, cols: 3, data: {K}}}
distortion_model: plumb_bob
distortion_coefficients: {{rows: 1, cols: {len(distortion)}, data: {distortion}}}
rectification_matrix: {{rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}}
projection_matrix: {{rows: 3, cols: 4, data: {P}}}
"""


def truth():
    fov = 2.0 * np.arctan(320.0 / FOCAL)
    return sextant.CameraModel(camera_calibration(640, 480, fov, "plumb_bob", DISTORTION))


def marker_toward(pixel, distance, random):
    """T_camera_marker, turned by 25 degrees from facing the camera."""
    way = random.uniform(0.0, 2.0 * np.pi)
    T = np.eye(4)
    turn = sextant.exp_so3(np.deg2rad(25.0) * np.array([np.cos(way), np.sin(way), 0.0]))
    T[:3, :3], T[:3, 3] = turn @ np.diag([1.0, -1.0, -1.0]), distance * truth().unproject(pixel)
    return T


def photograph(T_camera_markers, frame):
    T_map_camera = sextant.pose_from_xyz_rpy([0.0, 0.0, 1.2], [-0.5 * np.pi, 0.0, 0.0])
    marker_map = sextant.MarkerMap()
    for number, T in enumerate(T_camera_markers):
        marker_map.add(sextant.MappedMarker("tag36h11", number, SIZE, T_map_camera @ T))
    scene = sextant.RoomScene(room_for(marker_map, obstacles=False), marker_map)
    return sextant.RoomRenderer(sextant.RoomRendererParams(), scene, truth()).render([T_map_camera], frame)


@pytest.fixture(scope="module")
def photos(tmp_path_factory):
    """A folder with calibrations, and photos in the folders 0.7, 1.2 and 2.4; and one of two markers."""
    folder, random = tmp_path_factory.mktemp("photos"), np.random.default_rng(4)
    for distance in (0.7, 1.2, 2.4):
        (folder / str(distance)).mkdir()
        for number, pixel in enumerate(PLACES):
            picture = photograph([marker_toward(pixel, distance, random)], number)
            cv2.imwrite(str(folder / str(distance) / f"{number}.png"), picture)
    (folder / "two").mkdir()
    both = [marker_toward(pixel, 1.2, random) for pixel in PLACES[1:3]]
    cv2.imwrite(str(folder / "two" / "a.png"), photograph(both, 9))
    (folder / "tape.txt").write_text("# photo metres\ntwo/a.png 1.2\n\n0.7/0.png   0.700\n")
    cv2.imwrite(str(folder / "two" / "small.pgm"), np.zeros((240, 320), np.uint8))
    (folder / "right.yaml").write_text(calibration_text())
    (folder / "long.yaml").write_text(calibration_text(focal=1.02 * FOCAL))
    (folder / "shifted.yaml").write_text(calibration_text(shift=15.0))
    return folder


@pytest.fixture(autouse=True)
def inside(photos, monkeypatch):
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
