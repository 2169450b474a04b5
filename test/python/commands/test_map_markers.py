# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""From a bag of images to a map, as its user calls it."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from written_bags import WrittenBag

import sextant
from sextant.commands.map_markers import main
from sextant.simulation.drive import DriveParams, SimulatedDrive
from sextant.simulation.motion import FigureEight
from sextant.simulation.room_markers import default_map

EIGHT = FigureEight(period=40.0)
PARAMS = DriveParams(seed=2, rate=2.5, eight=EIGHT, horizontal_fov=1.8, obstacles=False)
IMAGES = 100
ROOT = Path(__file__).resolve().parents[3]
PAGE = (ROOT / "doc/how_to/mapping.md").read_text()


def write_drive(path, frames, camera="camera"):
    """A bag of images, odometry and the mount."""
    drive = SimulatedDrive(PARAMS)
    optical = f"{camera}_optical"
    with WrittenBag(path) as bag:
        bag.transforms([("base_link", optical, drive.T_base_camera)])
        for frame in list(drive.frames(IMAGES))[frames]:
            bag.info(f"/{camera}/camera_info", drive.calibration, frame.time, frame=optical)
            bag.image(f"/{camera}/image_raw", frame.image, frame.time, frame=optical)
            bag.odometry("/odom", frame.T_odom_base, frame.time)
    return str(path)


@pytest.fixture(scope="module")
def bags(tmp_path_factory):
    """Two halves of one drive."""
    folder = tmp_path_factory.mktemp("drive")
    middle = IMAGES // 2
    return [
        write_drive(folder / "first.bag", slice(0, middle)),
        write_drive(folder / "second.bag", slice(middle, None)),
    ]


@pytest.fixture
def room(tmp_path):
    """The room's true map in a file, changed by the test."""

    def write(ids, moved=None):
        marker_map = sextant.MarkerMap("room")
        for marker in default_map().markers:
            if marker.id in ids:
                T = marker.T_map_marker.copy()
                T[:3, 3] += (moved or {}).get(marker.id, np.zeros(3))
                marker_map.add(sextant.MappedMarker(marker.family, marker.id, marker.size, T))
        sextant.write_marker_map(marker_map, str(tmp_path / "room.yaml"))
        return str(tmp_path / "room.yaml")

    return write


def errors(path):
    """Position errors (N) in metres of a map in the room's frame."""
    truth = {marker.id: marker.T_map_marker for marker in default_map().markers}
    made = sextant.read_marker_map(str(path)).markers
    return np.array([np.linalg.norm(truth[m.id][:3, 3] - m.T_map_marker[:3, 3]) for m in made])


@pytest.mark.slow
def test_one_known_marker_and_two_bags_make_the_rooms_map(bags, room, tmp_path, capsys):
    out = tmp_path / "map.yaml"
    assert main([*bags, "-o", str(out), "--known", room([0]), "--jobs", "2"]) == 0
    made = sextant.read_marker_map(str(out))
    assert made.frame == "room" and [marker.id for marker in made.markers] == list(range(8))
    assert errors(out).max() < 0.1
    for marker in made.markers[1:]:
        error = sextant.pose_error(
            default_map().find("tag36h11", marker.id).T_map_marker, marker.T_map_marker
        )
        assert error @ np.linalg.solve(marker.covariance, error) < 22.5  # chi-square, 6 d.o.f., one of 1000
    text = capsys.readouterr().out
    assert str(out) in text and str(out.with_suffix(".html")) in text
    report = out.with_suffix(".html").read_text()
    assert "first.bag" in report and "second.bag" in report


@pytest.mark.slow
def test_without_a_known_marker_the_first_is_the_origin(bags, tmp_path):
    out = tmp_path / "map.yaml"
    assert main([*bags, "-o", str(out), "--frame", "hall"]) == 0
    made = sextant.read_marker_map(str(out))
    assert made.frame == "hall"
    np.testing.assert_allclose(made.find("tag36h11", 0).T_map_marker[:3, 3], 0.0, atol=1e-9)
    far = {m.id: m.T_map_marker for m in default_map().markers}
    expected = np.linalg.norm(far[5][:3, 3] - far[0][:3, 3])
    assert np.linalg.norm(made.find("tag36h11", 5).T_map_marker[:3, 3]) == pytest.approx(expected, abs=0.1)


@pytest.mark.slow
def test_a_taped_map_gets_better_and_its_wrong_entry_is_named(bags, room, tmp_path, capsys):
    taped, out = room(range(8), {3: [0.0, 0.0, 0.12]}), tmp_path / "better.yaml"
    assert main([*bags, "-o", str(out), "--refine", taped]) == 0
    assert errors(taped).max() == pytest.approx(0.12)
    assert errors(out).max() < 0.02
    named = [line for line in capsys.readouterr().out.splitlines() if line.startswith("- ")]
    assert len(named) == 1 and named[0].startswith("- 3 ")
    assert float(re.search(r"off by ([\d.]+) cm", named[0])[1]) == pytest.approx(12, abs=1)


REFUSED = {
    "no such bag": ([], "nowhere.bag"),
    "a map that is no map": (["--known", "nowhere.yaml"], "nowhere.yaml"),
    "a text map": (["-o", "map.txt"], "map.txt"),
    "a size": (["--size", "-1"], "size"),
    "a mount": (["--mounts", "camera=1,2,3"], "six numbers"),
    "a tape": (["--refine", "ROOM", "--tape-sigma", "0", "1"], "--tape-sigma"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_is_refused_in_one_line_and_nothing_is_written(
    case, bags, room, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    arguments, reason = REFUSED[case]
    bag = "nowhere.bag"
    arguments = [room(range(8)) if each == "ROOM" else each for each in arguments]
    before = set(tmp_path.iterdir())
    assert main(["-o", "map.yaml", *arguments, "--", bag if case == "no such bag" else bags[0]]) == 2
    captured = capsys.readouterr()
    assert reason in captured.err and captured.err.count("\n") == 1 and captured.out == ""
    assert set(tmp_path.iterdir()) == before


@pytest.mark.slow
def test_a_bag_that_cannot_be_read_is_skipped_on_request(bags, room, tmp_path, capsys):
    broken = tmp_path / "broken.bag"
    broken.write_bytes(b"#ROSBAG V2.0\n" + b"x" * 50)
    arguments = [*bags, str(broken), "-o", str(tmp_path / "map.yaml"), "--known", room([0])]
    assert main(arguments) == 2
    assert not (tmp_path / "map.yaml").exists()
    assert main([*arguments, "--skip"]) == 0
    assert f"skipped: {broken}" in capsys.readouterr().out


def test_a_bag_without_markers_is_reported(tmp_path, capsys):
    calibration = SimulatedDrive(PARAMS).calibration
    with WrittenBag(tmp_path / "empty.bag") as bag:
        for i in range(3):
            bag.info("/camera/camera_info", calibration, i)
            bag.image("/camera/image_raw", np.full((480, 640), 90, np.uint8), i)
    assert main([str(tmp_path / "empty.bag"), "-o", str(tmp_path / "map.yaml")]) == 2
    assert "no marker" in capsys.readouterr().err


@pytest.mark.slow
def test_the_executable_with_two_processes(bags, tmp_path):
    command = [sys.executable, str(ROOT / "scripts/map_markers"), *bags, "-o", str(tmp_path / "map.yaml")]
    done = subprocess.run([*command, "--jobs", "2"], capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stderr) == (0, "")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["map.html", "map.yaml"]


def test_options_are_those_of_the_page(capsys):
    with pytest.raises(SystemExit):
        main(["--help"])
    options = set(re.findall(r"^  .*?(--[a-z-]+)", capsys.readouterr().out, re.M)) - {"--help"}
    chapter = PAGE.partition("## Make")[2].partition("## Look")[0]
    assert set(re.findall(r"(--[a-z][a-z-]+)", chapter)) == options
