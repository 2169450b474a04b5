# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Collecting pictures from bags."""

import numpy as np
import pytest
from known_drives import write_depth_drive, write_drive

from sextant.commands.collect_pictures import main
from sextant.images.photo_depth import read_photo_depth


def test_pictures_of_a_drive_with_depth(tmp_path, capsys):
    bag, folder = write_depth_drive(tmp_path / "hall.bag"), tmp_path / "pictures"
    options = ["--image", "/front/image_raw", "--depth", "/depth/image_raw"]
    assert main([bag, "-o", str(folder), *options]) == 0
    assert capsys.readouterr().out == f"{folder}: 9 pictures\n"
    pictures = sorted(folder.glob("*.jpg"))
    assert len(pictures) == 9 and pictures[0].name.startswith("hall_front_16")
    for path in folder.glob("*.depth"):
        path.unlink()
    assert main([bag, "-o", str(folder), *options]) == 0  # as after an interruption
    for path in pictures:
        depth = read_photo_depth(path)
        np.testing.assert_allclose(depth[depth > 0], 2.0, atol=1e-3)


def test_a_second_recording_adds_what_is_new(tmp_path, capsys):
    day, night = write_drive(tmp_path / "day.bag", 2.0), write_drive(tmp_path / "night.bag", 3.0)
    for bag in (day, day, night):
        assert main([bag, "-o", str(tmp_path / "pictures"), "--count", "100"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.partition(": ")[2] for line in lines] == [
        "9 pictures", "9 pictures; dropped: 9 already there",
        "13 pictures; dropped: 9 already there, 9 like another one",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["nowhere.bag"], "there is no such file"),
        (["nowhere.mp4"], "there is no such file"),
        (["hall.bag", "--every", "0"], "--every is 0"),
        (["hall.bag", "--count", "0"], "count"),
        (["hall.bag", "--image", "/side"], "no images on /side"),
    ],
)
def test_what_cannot_be_read_is_refused(tmp_path, monkeypatch, capsys, options, reason):
    monkeypatch.chdir(tmp_path)
    write_drive("hall.bag", 1.0)
    assert main([*options, "-o", "pictures"]) == 2
    assert reason in capsys.readouterr().err
