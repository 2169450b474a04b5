# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import shlex
from pathlib import Path

import cv2
import pytest
from printed_pages import pictures, texts

from sextant.commands.make_chessboard import main


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Commands run in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    "line, size, square",
    [
        ("", (8, 6), "0.025"),
        ("9x7 --square 0.0185", (9, 7), "0.0185"),
        ("7x5 --page A3", (7, 5), "0.041"),
        ("--page Letter --margin 0.02", (8, 6), "0.022"),
    ],
)
def test_the_command_that_it_prints_fits_the_sheet(capsys, line, size, square):
    assert main([*line.split(), "-o", "board.pdf"]) == 0
    command = shlex.split(capsys.readouterr().out.splitlines()[-1])
    shape = f"{size[0]}x{size[1]}"
    assert command == ["roslaunch", "sextant", "calibrate.launch", f"size:={shape}", f"square:={square}"]
    assert f"--size {shape} --square {square}" in " ".join(texts(Path("board.pdf"))[0])
    [picture] = pictures(Path("board.pdf"), 72)
    found, corners = cv2.findChessboardCorners(picture, size)
    assert found
    step = cv2.norm(corners[0], corners[1]) * 0.0254 / 72
    assert step == pytest.approx(float(square), abs=0.0003)  # to a pixel; test_chessboard_sheet.py measures


@pytest.mark.parametrize(
    "line, reason",
    [
        ("8", "'8' is not of the form COLUMNSxROWS"),
        ("8x6 --square 0.1", "the board does not fit on A4; its squares: at most 0.02"),
        ("8x6 --square x", "invalid float value"),
        ("8x6000", "rows: must be"),
        ("8x6 --page A5", "'A5'"),
        ("-o absent/board.pdf", "there is no folder absent"),
        ("-o mine.pdf", "mine.pdf: already exists; --force overwrites it"),
    ],
)
def test_what_is_refused(capsys, line, reason):
    Path("mine.pdf").write_text("mine")
    assert main(line.split()) == 2
    captured = capsys.readouterr()
    assert captured.out == "" and captured.err.count("\n") == 1
    assert captured.err.startswith("make_chessboard: ") and reason in captured.err
    assert [path.read_text() for path in Path().iterdir()] == ["mine"]
