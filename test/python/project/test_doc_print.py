# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What doc/how_to/print.md states is true: its commands, its options, the ranges of its markers."""

import re
import shlex
from pathlib import Path

import pytest

import sextant
from sextant.commands import design_markers, make_chessboard, make_markers
from sextant.evaluation.marker_design import Cell, DesignParams, Setup, camera_calibrations, simulate_cell
from sextant.evaluation.marker_design_report import NUMBERS

PAGE = (Path(__file__).resolve().parents[3] / "doc/how_to/print.md").read_text()
COMMANDS = {"make_markers": make_markers.main, "make_chessboard": make_chessboard.main}


def test_commands_work(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    lines = re.findall(r"^rosrun sextant (make_.*)", PAGE, re.M)
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


@pytest.mark.parametrize("command, number", [(make_markers, 0), (design_markers, 1)])
def test_options_are_those_of_the_command(capsys, command, number):
    with pytest.raises(SystemExit):
        command.main(["--help"])
    options = set(re.findall(r"^  (?:-o .*?)?(--[\w-]+)", capsys.readouterr().out, re.M))
    table = PAGE.split("| option |")[number + 1].partition("\n\n")[0]
    assert set(re.findall(r"`(--[\w-]+)`", table)) == options - {"--help", "--output"}


def sweeps():
    """(options, target, lines) of every sweep that the page shows."""
    found = re.findall(r"^\$ rosrun sextant design_markers ?(.*)\n((?:.*\n)+?)```", PAGE, re.M)
    assert len(found) == 2
    for line, text in found:
        options = design_markers._parser().parse_args(shlex.split(line))
        yield options, options.target[0], text.splitlines()


def rows():
    """(setup, size, target, distance of detection, pixels, ranges by number in view) of the tables."""
    for options, target, lines in sweeps():
        for line in lines:
            heading = re.match(
                r"(\d+) x (\d+), f = (\d+) px, (\w+), noise (\d+), light (\d+); worst of", line
            )
            if heading:
                width, height, _, family, noise, light = heading.groups()
                setup = Setup((int(width), int(height)), family, float(noise), float(light))
            row = re.match(r"([\d.]+) +m +([\d.]+) m \((\d+) px\) +(.*\S) +\d+ ms$", line)
            if row:
                ranges = dict(zip(options.in_view, re.split(r" {2,}", row[4])))
                yield setup, float(row[1]), target, float(row[2]), int(row[3]), max(options.angle), ranges


@pytest.mark.slow
def test_markers_are_detected_and_located_up_to_the_ranges_of_the_page():
    """At the largest angle, few pixels; the pose at 0 degrees, where it is the most uncertain."""
    count = 0
    for setup, size, target, distance, pixels, angle, ranges in rows():
        params = DesignParams(resolution=(setup.resolution,), images=3)
        calibrations = camera_calibrations(params, None)
        found = simulate_cell(params, calibrations, Cell(setup, size, 1, distance, angle))
        assert found.detected == 1.0 and round(found.pixels) == pixels
        for in_view, text in ranges.items():
            if reached(text):
                cell = Cell(setup, size, in_view, reached(text), 0.0)
                assert simulate_cell(params, calibrations, cell).median_error <= target
        count += 1
    assert count == 5 + 3


@pytest.mark.slow
def test_families_are_detected_up_to_the_ranges_of_the_page():
    """In a table of the output of a sweep; at its largest angle."""
    (line,) = re.findall(r"^rosrun sextant design_markers (.*--family.*)", PAGE, re.M)
    options = design_markers._parser().parse_args(shlex.split(line))
    rows = re.findall(r"^\| `(\w+)` \| ([\d.]+) m \((\d+) px\) \|", PAGE, re.M)
    assert [row[0] for row in rows] == options.family
    (size,), resolution = options.size, (640, 480)
    params = DesignParams(resolution=(resolution,), images=5)
    for family, distance, pixels in rows:
        setup = Setup(resolution, family, options.noise[0], options.light[0])
        cell = Cell(setup, size, 1, float(distance), max(options.angle))
        found = simulate_cell(params, camera_calibrations(params, None), cell)
        assert found.detected == 1.0 and round(found.pixels) == int(pixels)


def reached(text):
    """A range of a table, metres."""
    return 0.0 if text == "–" else float(text.split()[0])


@pytest.mark.parametrize("index", [0, 1])
def test_answers_of_the_page_are_those_of_its_tables(index):
    """The smallest size whose range reaches the target."""
    options, _, lines = list(sweeps())[index]
    (answer,) = (line for line in lines if line.startswith("for "))
    tables = [row for row in rows() if f", {row[0].resolution[0]} x " in answer]
    for number in options.in_view:
        good = [row[1] for row in tables if reached(row[-1][number]) >= options.target[1]]
        text = f"markers of {min(good):g} m, " if good else f"with {NUMBERS[number]} in view no size"
        assert text in answer
