# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What doc/how_to/print.md states is true: its commands, its options, the pixels that a marker needs."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest

import sextant
from sextant.commands import make_chessboard, make_markers
from sextant.simulation.room_markers import room_for

PAGE = (Path(__file__).resolve().parents[3] / "doc/how_to/print.md").read_text()
COMMANDS = {"make_markers": make_markers.main, "make_chessboard": make_chessboard.main}


def test_commands_work(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    lines = re.findall(r"^rosrun sextant (.*)", PAGE, re.M)
    assert len(lines) == 5
    for line in lines:
        name, *arguments = shlex.split(line, comments=True)
        assert COMMANDS[name](arguments) == 0
    assert "size:=8x6 square:=0.025" in capsys.readouterr().out
    assert {path.name for path in tmp_path.iterdir()} == {
        *("markers.pdf", "map.yaml", "board.pdf", "board.yaml", "chessboard.pdf", "large.pdf")
    }
    with pytest.raises(RuntimeError) as refused:
        sextant.read_marker_map("map.yaml")
    assert re.sub("'.*'", "", str(refused.value)) in re.sub("'.*'", "", PAGE)


def test_options_are_those_of_the_command(capsys):
    with pytest.raises(SystemExit):
        make_markers.main(["--help"])
    options = set(re.findall(r"^  .*?(--[\w-]+)", capsys.readouterr().out, re.M)) - {"--help", "--output"}
    table = PAGE.partition("| option |")[2].partition("\n\n")[0]
    assert set(re.findall(r"`(--[\w-]+)`", table)) == options


@pytest.mark.slow
@pytest.mark.parametrize("family", ["tag36h11", "tagStandard41h12", "DICT_4X4_50", "DICT_6X6_250"])
@pytest.mark.parametrize("angle", [0.1, 0.25 * np.pi])
def test_pixels_that_a_marker_needs(family, angle):
    pixels = float(re.search(r"edge length of about (\d+) pixels", PAGE).group(1))
    focal, size, wall = 500.0, 0.1, 2.99
    marker_map = sextant.MarkerMap()
    T_map_marker = sextant.pose_from_xyz_rpy([0.0, wall, 1.0], [0.5 * np.pi, 0.0, 0.0])
    marker_map.add(sextant.MappedMarker(family, 3, size, T_map_marker))
    calibration = sextant.CameraCalibration()
    calibration.width, calibration.height, calibration.distortion_model = 640, 480, "plumb_bob"
    calibration.K = np.array([[focal, 0, 319.5], [0, focal, 239.5], [0, 0, 1]])
    scene = sextant.RoomScene(room_for(marker_map, obstacles=False), marker_map)
    renderer = sextant.RoomRenderer(sextant.RoomRendererParams(), scene, sextant.CameraModel(calibration))
    params = sextant.DetectorParams()
    params.families = [family]
    detector, distance = sextant.MarkerDetector(params), size * focal / pixels
    place = [distance * np.sin(angle), wall - distance * np.cos(angle), 1.0]
    T_map_camera = sextant.pose_from_xyz_rpy(place, [-0.5 * np.pi, 0.0, angle])  # looks at the marker
    pictures = [renderer.render([T_map_camera], frame) for frame in range(10)]
    found = [[marker.id for marker in detector.detect(picture)] for picture in pictures]
    assert found == [[3]] * 10
