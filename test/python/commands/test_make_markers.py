# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The command line: files that it writes, what it prints, what it refuses."""

import re
import shlex
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest
from printed_pages import detector, paper, pictures

import sextant
from sextant.commands.make_markers import main

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Commands run in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(capsys, line):
    """(exit code, lines of stdout, lines of stderr)"""
    code = main(line.split())
    captured = capsys.readouterr()
    return code, captured.out.splitlines(), captured.err.splitlines()


def refused(capsys, line):
    """The one line that is printed; nothing else has happened."""
    before = {path: path.read_bytes() for path in Path().iterdir()}
    code, out, err = run(capsys, line)
    assert (code, out, len(err)) == (2, [], 1)
    assert {path: path.read_bytes() for path in Path().iterdir()} == before
    assert err[0].startswith("make_markers: ")
    return err[0]


def found_in(pdf, family, dpi=100):
    pages = pictures(Path(pdf), dpi)
    return [sorted(marker.id for marker in detector(family).detect(picture)) for picture in pages]


def test_ids_are_ranges_and_numbers(capsys):
    code, out, _ = run(capsys, "tag36h11 0-7,12 --size 0.06")
    assert code == 0
    assert out[0] == "markers.pdf: 9 markers of tag36h11 on 2 sheets, A4"
    assert found_in("markers.pdf", "tag36h11") == [[0, 1, 2, 3, 4, 5], [6, 7, 12]]


def test_options_reach_the_sheets(capsys):
    layout = "--page Letter --max-per-page 2 --margin 0.02 --quiet-zone 2"
    line = f"DICT_4X4_50 3-6 --size 0.04 {layout} -o four.pdf"
    code, out, _ = run(capsys, line)
    assert (code, out[0]) == (0, "four.pdf: 4 markers of DICT_4X4_50 on 2 sheets, Letter")
    assert found_in("four.pdf", "DICT_4X4_50") == [[3, 4], [5, 6]]
    assert paper(Path("four.pdf")) == pytest.approx([215.9, 279.4], abs=0.01)


def test_a_family_is_called_as_detections_and_maps_call_it(capsys):
    _, out, _ = run(capsys, "DICT_APRILTAG_36h11 7 --size 0.1 --map map.yaml")
    assert out[0] == "markers.pdf: 1 marker of tag36h11 on 1 sheet, A4"
    assert found_in("markers.pdf", "tag36h11") == [[7]]
    assert "family: tag36h11" in Path("map.yaml").read_text()


def test_map_is_refused_until_it_states_where_the_markers_hang(capsys):
    code, out, _ = run(capsys, "tag36h11 3,9,4 --size 0.125 --map map.yaml")
    assert code == 0 and out[1].startswith("map.yaml: fill in position and rpy")
    with pytest.raises(RuntimeError, match="^map.yaml:4: needs a finite number, not '"):
        sextant.read_marker_map("map.yaml")

    text = Path("map.yaml").read_text()
    place, turn = ("[x, y, z]", "[1, 2, 3]"), ("[roll, pitch, yaw]", "[0, 0, 0.5]")
    for half in (place, turn):
        Path("map.yaml").write_text(text.replace(*half))
        with pytest.raises(RuntimeError, match="^map.yaml:4: "):
            sextant.read_marker_map("map.yaml")
    Path("map.yaml").write_text(text.replace(*place, 1).replace(*turn, 1))
    with pytest.raises(RuntimeError, match="^map.yaml:5: "):
        sextant.read_marker_map("map.yaml")

    Path("map.yaml").write_text(
        text.replace("[x, y, z]", "[1, 2, 3]").replace("[roll, pitch, yaw]", "[0, 0, 0.5]")
    )
    marker_map = sextant.read_marker_map("map.yaml")
    assert marker_map.frame == "map"
    assert [(marker.family, marker.id, marker.size) for marker in marker_map.markers] == [
        ("tag36h11", id, 0.125) for id in (3, 4, 9)
    ]
    np.testing.assert_allclose(marker_map.find("tag36h11", 9).T_map_marker[:3, 3], [1.0, 2.0, 3.0])


def test_board_comes_with_its_map(capsys):
    code, out, _ = run(capsys, "tag36h11 0-11 --size 0.04 --board 4x3 --map board.yaml")
    assert code == 0
    assert out[0] == "markers.pdf: board of 4 x 3 markers of tag36h11, gap 0.005 m, on 1 sheet, A4"
    assert found_in("markers.pdf", "tag36h11") == [list(range(12))]
    marker_map = sextant.read_marker_map("board.yaml")
    positions = np.array([marker.T_map_marker[:3, 3] for marker in marker_map.markers]).reshape(3, 4, 3)
    np.testing.assert_allclose(np.diff(positions, axis=1), np.tile([0.045, 0, 0], (3, 3, 1)), atol=1e-12)
    np.testing.assert_allclose(np.diff(positions, axis=0), np.tile([0, -0.045, 0], (2, 4, 1)), atol=1e-12)


def test_gap_of_a_board(capsys):
    _, out, _ = run(capsys, "tag36h11 0-1 --size 0.05 --board 2x1 --gap 0.0325 --map board.yaml")
    assert "gap 0.0325 m" in out[0]
    T = [marker.T_map_marker for marker in sextant.read_marker_map("board.yaml").markers]
    np.testing.assert_allclose(T[1][:3, 3] - T[0][:3, 3], [0.0825, 0.0, 0.0], atol=1e-12)


@pytest.mark.parametrize("map_option", ["", " --map 'my map.yaml'"])
def test_command_that_comes_next(capsys, folder, map_option):
    assert main(shlex.split("tagStandard41h12 0 --size 0.0625" + map_option)) == 0
    command = shlex.split(capsys.readouterr().out.splitlines()[-1])
    assert command[:3] == ["roslaunch", "sextant", "webcam.launch"]
    arguments = dict(argument.split(":=") for argument in command[3:])
    expected = {"families": "[tagStandard41h12]", "marker_size": "0.0625"}
    if map_option:
        expected["map"] = str(folder / "my map.yaml")
    assert arguments == expected
    for launch in ("webcam.launch", "robot.launch"):
        root = ElementTree.parse(str(ROOT / "launch" / launch)).getroot()
        assert {*arguments, "map"} <= {arg.get("name") for arg in root.iter("arg")}


@pytest.mark.parametrize("there", ["markers.pdf", "map.yaml"])
def test_nothing_is_overwritten_unless_asked_for(capsys, there):
    Path(there).write_text("mine")
    line = "tag36h11 0 --size 0.1 --map map.yaml"
    assert refused(capsys, line) == f"make_markers: {there}: already exists; --force overwrites it"
    assert Path(there).read_text() == "mine"
    assert run(capsys, line + " --force")[0] == 0
    assert Path("markers.pdf").read_bytes().startswith(b"%PDF")
    assert Path("map.yaml").read_text().startswith("#")


@pytest.mark.parametrize(
    "line, reason",
    [
        ("tag36h11 0", "--size"),
        ("tag36h11 --size 0.1", "ids"),
        ("tag36h11 0 --size big", "invalid float value: 'big'"),
        ("tag36h11 0 --size -1", "size is -1.0 m, allowed is"),
        ("tag36h11 0 --size 0.3", "a marker of 0.3 m does not fit on A4; at most 0.168 m on A4"),
        ("tag36h12 0 --size 0.1", "unknown marker family 'tag36h12'; known are"),
        ("tag36h11 587 --size 0.1", "id 587 is not in tag36h11"),
        ("tag36h11 5-3 --size 0.1", "'5-3' is neither an id nor a range of ids such as 0-7"),
        ("tag36h11 1,,2 --size 0.1", "'' is neither an id"),
        ("tag36h11 0-99999999999 --size 0.1", "more than 10000 ids"),
        ("tag36h11 0 --size 0.1 --page A0", "'A0'"),
        ("tag36h11 0 --size 0.1 --board 2", "'2' is not of the form COLUMNSxROWS"),
        ("tag36h11 0-3 --size inf --board 2x2", "size is inf m, allowed is"),
        ("tag36h11 0-3 --size 0.04 --board 2x99999999999", "rows: must be"),
        ("tag36h11 0 --size 0.1 --gap 0.1", "--gap is for --board"),
        ("tag36h11 0 --size 0.04 --board 1x1 --max-per-page 1", "--max-per-page is not for --board"),
        ("tag36h11 0 --size 0.1 --map map.txt", "must end in .yaml"),
        ("tag36h11 0 --size 0.1 -o one.yaml --map one.yaml", "cannot be both"),
        ("tag36h11 0 --size 0.1 -o absent/markers.pdf", "there is no folder absent"),
        ("tag36h11 0 --size 0.1 --map absent/map.yaml", "there is no folder absent"),
        ("tag36h11 0 --size 0.1 -o . --force", ".: is a folder"),
    ],
)
def test_what_is_refused(capsys, line, reason):
    assert reason in refused(capsys, line)


def test_a_folder_that_cannot_be_written_to(capsys):
    if not Path("/proc/self").exists():
        pytest.skip("needs a folder that even root cannot write to")
    reason = refused(capsys, "tag36h11 0 --size 0.1 -o /proc/markers.pdf")
    assert "/proc/markers.pdf: cannot be written: " in reason


def test_examples_of_the_help_work(capsys):
    with pytest.raises(SystemExit):
        main(["--help"])
    examples = re.findall(r"^  make_markers (.*)", capsys.readouterr().out, re.M)
    assert len(examples) == 3
    for number, example in enumerate(examples):
        assert main([*shlex.split(example), "--force", "-o", f"{number}.pdf"]) == 0
