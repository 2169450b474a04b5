# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The command, on the files of test/data/map_formats."""

import os
import re
from pathlib import Path

import numpy as np
import pytest

import sextant
from sextant.commands.convert_map import _parser, main
from sextant.markers.map_formats import guess_write_format

ROOT = Path(__file__).resolve().parents[3]
DATA = ROOT / "test/data/map_formats"
PRINT = ["--family", "DICT_5X5_50", "--size", "0.2"]


def run(capsys, *arguments):
    """Exit status, and what went to both streams."""
    status = main([str(each) for each in arguments])
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def refusal(capsys, *arguments):
    """The one line of a command that wrote nothing."""
    status, out, err = run(capsys, *arguments)
    assert (status, out) == (2, "")
    assert err.startswith("convert_map: ") and err.count("\n") == 1
    return err


@pytest.mark.parametrize(
    "name, options, format_name, family",
    [
        ("fiducial_slam.txt", PRINT, "fiducial_slam", "DICT_5X5_50"),
        ("tags.yaml", [], "apriltag_ros", "tag36h11"),
        ("tagslam.yaml", ["--bundle", "room"], "tagslam", "tag36h11"),
        ("poses.yaml", ["--frame", "map"], "tagslam", "tag36h11"),
    ],
)
def test_every_format_moves_in_one_command(tmp_path, capsys, name, options, format_name, family):
    path = tmp_path / "map.yaml"
    status, out, err = run(capsys, DATA / name, path, *options)
    assert (status, err) == (0, "")
    first, *lost, last = out.splitlines()
    assert first == f"{DATA / name}: read 3 markers of {family}, 0.2 m, in frame 'map' ({format_name})"
    assert lost and all(line.startswith("lost: ") for line in lost)
    assert last == f"{path}: written (yaml)"
    marker = sextant.read_marker_map(str(path)).find(family, 7)
    np.testing.assert_allclose(marker.T_map_marker[:3, 3], [1, 3, 1.5], atol=1e-8)
    np.testing.assert_allclose(marker.T_map_marker[:3, 2], [0, -1, 0], atol=1e-8)


@pytest.mark.parametrize(
    "target, out",
    [("apriltag_ros", "a.yaml"), ("tagslam", "a.yaml"), ("text", "a.txt"), ("yaml", "tags.yaml")],
)
def test_to_another_format_and_back(tmp_path, capsys, target, out):
    tag = ["--family", "tag36h11", "--size", "0.2"]
    assert run(capsys, DATA / "tags.yaml", tmp_path / out, "--to", target)[0] == 0
    options = tag if target == "text" else []
    assert run(capsys, tmp_path / out, tmp_path / "back.yaml", "--from", target, *options)[0] == 0
    ours = sextant.read_marker_map(str(tmp_path / "back.yaml"))
    for marker in ours.markers:
        pose = {7: [1, 3, 1.5], 8: [4, -1, 1.2], 9: [0.5, 0.25, 0]}[marker.id]
        np.testing.assert_allclose(marker.T_map_marker[:3, 3], pose, atol=1e-8)
    assert len(ours.markers) == 3


def test_additions_to_plain_text_are_reported(tmp_path, capsys):
    source, target = tmp_path / "frames.txt", tmp_path / "map.yaml"
    source.write_text("map 0 0 0 0 0 0\nId7 1 3 1.5 1.5708 0 0 0.2\n")
    status, out, err = run(capsys, source, target, "--family", "tag36h11", "--size", "0.2")
    assert (status, err) == (0, "")
    assert out.splitlines()[1:3] == [
        "lost: line 1, the frame of the map: it has no pose in itself",
        "lost: the eighth field, '0.2' in line 2: the format has 7, it is ignored",
    ]
    (marker,) = sextant.read_marker_map(str(target)).markers
    assert (marker.id, marker.name) == (7, "Id7")


def test_losses_of_writing_are_reported(tmp_path, capsys):
    status, out, _ = run(capsys, DATA / "tagslam.yaml", tmp_path / "map.txt", "--to", "text")
    assert status == 0
    assert "lost: the covariance of 2 markers" in out
    assert (
        "lost: family, size and frame: marker_broadcaster needs family: tag36h11, size: 0.2, frame: map"
        in out
    )


def test_a_file_is_overwritten_only_with_force(tmp_path, capsys):
    path = tmp_path / "map.yaml"
    path.write_text("mine\n")
    assert "already exists; --force overwrites it" in refusal(capsys, DATA / "tags.yaml", path)
    assert path.read_text() == "mine\n"
    assert run(capsys, DATA / "tags.yaml", path, "--force")[0] == 0
    assert "tag36h11" in path.read_text()
    assert os.listdir(tmp_path) == ["map.yaml"]


def test_a_link_to_nowhere_is_a_file_too(tmp_path, capsys):
    (tmp_path / "map.yaml").symlink_to(tmp_path / "nowhere")
    assert "already exists" in refusal(capsys, DATA / "tags.yaml", tmp_path / "map.yaml")


@pytest.mark.parametrize(
    "arguments, reason",
    [
        (["fiducial_slam.txt", "m.yaml"], "set --family and --size"),
        (["none.txt", "m.yaml"], "none.txt: cannot be read: No such file or directory"),
        (["README.md", "m.yaml"], "looks like no known format; name the format: --from yaml|text|"),
        (["tags.yaml", "m.txt"], "the ending does not define the format; set --to yaml|text|"),
        (["tags.yaml", "tagslam.yaml"], "is a file name of tagslam; set --to tagslam or --to yaml"),
        (["tags.yaml", "m.yaml", "--from", "tagslam"], "tags.yaml:1: 'standalone_tags' is not a name in"),
        (["tags.yaml", "no/m.yaml"], "m.yaml: there is no folder"),
        (["tags.yaml", "no/m.txt", "--to", "tagslam"], "m.txt: there is no folder"),
    ],
)
def test_mistakes_are_one_line(tmp_path, capsys, arguments, reason):
    source, target, *options = arguments
    assert reason in refusal(capsys, DATA / source, tmp_path / target, *options)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    "arguments", [[], ["a.yaml", "b.yaml", "--size", "wide"], ["a", "b", "--from", "csv"]]
)
def test_wrong_arguments_are_one_line(capsys, arguments):
    assert "see --help" in refusal(capsys, *arguments)


def test_commands_of_the_page_are_understood():
    page = (ROOT / "doc/how_to/migrating.md").read_text()
    commands = re.findall(r"`rosrun sextant convert_map ([^`]+)`", page)
    assert len(commands) == 5
    for command in commands:
        parsed = _parser().parse_args(command.split())
        assert parsed.target or guess_write_format(parsed.output) == "yaml"
