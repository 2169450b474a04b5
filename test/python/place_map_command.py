# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""make_place_map as its user calls for it, and what it is called with."""

import cv2
import numpy as np
from known_drives import SIZE
from made_photos import picture
from PIL import Image

from sextant.commands.places.make_place_map import main

CORNERS = ["--north-west", "55.61,13.00", "--south-east", "55.60,13.02"]


def refused(capsys, folder, *arguments):
    """The one line with the reason; nothing was written."""
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    assert main([str(each) for each in arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == "" and captured.err.count("\n") == 1
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*")} == before
    return captured.err


def printed(capsys, *arguments):
    """The lines that a success prints."""
    assert main([str(each) for each in arguments]) == 0, capsys.readouterr().err
    return capsys.readouterr().out.splitlines()


def photo(path, latitude=None, longitude=None):
    exif = Image.Exif()
    if latitude is not None:
        exif[0x8825] = {1: "N", 2: (latitude, 0.0, 0.0), 3: "E", 4: (longitude, 0.0, 0.0)}
    path.parent.mkdir(exist_ok=True)
    Image.fromarray(picture(1, SIZE)).save(path, exif=exif)


def floor_yaml(folder, yaw=0.3):
    """An empty map of map_server: 12 x 10 m."""
    folder.mkdir()
    cv2.imwrite(str(folder / "floor.pgm"), np.full((200, 240), 254, np.uint8))
    (folder / "floor.yaml").write_text(
        f"image: floor.pgm\nresolution: 0.05\norigin: [-1.0, -3.0, {yaw}]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    return folder / "floor.yaml"
