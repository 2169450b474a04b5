# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What make_place_map refuses, and its page."""

import re
import subprocess
import sys
from pathlib import Path

import cv2
import pytest
from known_drives import SIZE, write_drive
from made_photos import picture
from place_map_command import CORNERS, floor_yaml, photo, refused

from sextant.commands.places.make_place_map import COMMANDS, main

ROOT = Path(__file__).resolve().parents[3]
PAGE = (ROOT / "doc/how_to/place_map.md").read_text()

REFUSED = {
    "no way": ([], "required: COMMAND"),
    "an unknown way": (["walk"], "invalid choice: 'walk'"),
    "an option before the way": (["--force", "exif", "photos"], "--force"),
    "no folder of photos": (["exif", "nowhere"], "nowhere: is not a folder"),
    "photos without positions": (["exif", "blank"], "no photo has a GPS position"),
    "photos elsewhere": (["exif", "blank", "-o", "photos/map.txt", *CORNERS], "photos must be in"),
    "no photo on the overview": (["exif", "blank", *CORNERS], "blank: no photo can be placed"),
    "an overview anywhere": (["exif", "photos", "--overview", "plan.png"], "has no corners; set"),
    "half of the corners": (["exif", "photos", *CORNERS[:2]], "--north-west and --south-east"),
    "a margin": (["exif", "photos", "--margin", "0"], "--margin"),
    "a map that is not there": (["exif", "photos", "--add"], "photos/map.txt"),
    "other corners": (["exif", "photos", "-o", "old.txt", "--add", *CORNERS], "already has corners"),
    "a map that is there": (["image", "plan.png", "-o", "old.txt"], "--force overwrites it"),
    "no such folder": (["image", "plan.png", "-o", "nowhere/map.txt"], "there is no folder nowhere"),
    "no picture": (["image", "old.txt", "-o", "map.txt"], "old.txt: is not an image"),
    "two places": (["image", "plan.png", "-o", "map.txt", "--resolution", "1", *CORNERS], "not both"),
    "an origin alone": (["image", "plan.png", "-o", "map.txt", "--origin", "1,2,3"], "--resolution"),
    "a frame alone": (["image", "plan.png", "-o", "map.txt", "--frame", "f"], "--resolution"),
    "a margin of no drawing": (["exif", "photos", "--add", "--margin", "2"], "not allowed with"),
    "an origin": (["image", "plan.png", "-o", "map.txt", "--resolution", "1", "--origin", "1"], "X,Y,YAW"),
    "a resolution": (["image", "plan.png", "-o", "map.txt", "--resolution", "0"], "resolution is 0"),
    "a YAML with a resolution": (
        ["image", "f/floor.yaml", "-o", "map.txt", "--resolution", "1"],
        "contains its position",
    ),
    "no such bag": (["drive", "nowhere.bag", "-o", "map.txt"], "nowhere.bag: there is no such file"),
    "a bag twice": (["drive", "a.bag", "./a.bag", "-o", "map.txt"], "a.bag: duplicate bag"),
    "bags of one name": (["drive", "a.bag", "f/a.bag", "-o", "map.txt"], "rename one of them"),
    "a frame of a topic": (["drive", "a.bag", "-o", "map.txt", "--pose", "p", "--frame", "f"], "--frame"),
    "a distance": (["drive", "a.bag", "-o", "map.txt", "--distance", "0"], "distance: must be"),
    "a turn": (["drive", "a.bag", "-o", "map.txt", "--turn", "361"], "--turn is 361"),
    "merging": (["drive", "a.bag", "-o", "map.txt", "--merge", "-1"], "--merge"),
    "photos that are there": (["drive", "b.bag", "-o", "map.txt"], ".jpg: already exists; --force"),
    "a drive off the map": (["drive", "a.bag", "-o", "map.txt", "--map-yaml", "f/far.yaml"], "outside"),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Of everything that the refused ask for."""
    folder = tmp_path_factory.mktemp("refused")
    photo(folder / "photos" / "a.jpg", 55.605, 13.01)
    photo(folder / "blank" / "a.jpg")
    cv2.imwrite(str(folder / "plan.png"), picture(1, SIZE))
    (folder / "old.txt").write_text("plan.png;64;48;north_west=55.61,13;south_east=55.6,13.02\n")
    yaml = floor_yaml(folder / "f")
    (folder / "f" / "far.yaml").write_text(yaml.read_text().replace("-3.0", "300"))
    for path in (folder / "a.bag", folder / "f" / "a.bag", folder / "b.bag"):
        write_drive(path, 1.0)
    photo(folder / "b_front_1600000000.000.jpg")
    return folder


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_is_refused_in_one_line_and_nothing_is_written(case, folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    arguments, reason = REFUSED[case]
    assert reason in refused(capsys, folder, *arguments)


@pytest.mark.slow
def test_the_executable_and_its_help(tmp_path):
    command = [sys.executable, str(ROOT / "scripts/make_place_map")]
    done = subprocess.run([*command, "--help"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and all(f"make_place_map {way} " in done.stdout for way in COMMANDS)
    bag = write_drive(tmp_path / "a.bag", 1.0)
    command += ["drive", bag, "-o", str(tmp_path / "map.txt")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "") and (tmp_path / "map.txt").exists()


@pytest.mark.parametrize("way", COMMANDS)
def test_options_are_those_of_the_page(way, capsys):
    with pytest.raises(SystemExit):
        main([way, "--help"])
    options = set(re.findall(r"^  .*?(--[a-z-]+)", capsys.readouterr().out, re.M)) - {"--help"}
    sections = re.split(r"^### ", PAGE, flags=re.M)
    section = next(each for each in sections if f"`make_place_map {way}`" in each.splitlines()[0])
    assert set(re.findall(r"(--[a-z][a-z-]+)", section)) == options
