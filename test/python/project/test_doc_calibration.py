# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""doc/how_to/calibration.md is correct: sheet, defaults of the launch file, commands and their options."""

import io
import re
import shlex
import subprocess
import tarfile
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
from calibration_photos import calibration_text, photos  # noqa: F401, the rendered photos

from sextant.commands import check_calibration, make_chessboard
from sextant.printing.chessboard_sheet import largest_square
from sextant.printing.print_layout import Paper

ROOT = Path(__file__).resolve().parents[3]
PAGE = (ROOT / "doc/how_to/calibration.md").read_text()
COMMANDS = re.findall(r"^rosrun sextant (\w+)(.*)", PAGE, re.M)


def launch_arguments():
    root = ElementTree.parse(str(ROOT / "launch/calibrate.launch")).getroot()
    return {each.get("name"): each.get("default") for each in root.findall("arg") if each.get("doc")}


def options_in(text):
    return set(re.findall(r"`(--\w+(?:-\w+)*)`", text))


def test_launch_file_has_the_size_of_the_default_sheet(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert [arguments.strip() for name, arguments in COMMANDS if name == "make_chessboard"] == [""]
    assert make_chessboard.main([]) == 0
    defaults = launch_arguments()
    assert f"size:={defaults['size']} square:={defaults['square']}" in capsys.readouterr().out
    assert float(defaults["square"]) == largest_square(8, 6, Paper())
    corners, millimetres = re.search(r"(\d+x\d+) \*\*inner corners\*\* .* of (\d+) mm on A4", PAGE).groups()
    assert (corners, 0.001 * float(millimetres)) == (defaults["size"], float(defaults["square"]))


def test_launch_files_arguments_are_documented():
    table = PAGE.partition("| argument |")[2].partition("\n\n")[0]
    documented = set(re.findall(r"`(\w+)`", "\n".join(row.split("|")[1] for row in table.splitlines()[2:])))
    webcam = ElementTree.parse(str(ROOT / "launch/webcam.launch")).getroot()
    shared = {each.get("name") for each in webcam.findall("arg")} - {"calibration", "camera"}
    assert documented == set(launch_arguments()) - shared


def test_file_is_where_the_page_takes_it_from(tmp_path):
    command = next(line for line in PAGE.splitlines() if line.startswith("tar "))
    text = calibration_text().encode()
    with tarfile.open(str(tmp_path / "calibrationdata.tar.gz"), "w:gz") as archive:
        entry = tarfile.TarInfo("ost.yaml")
        entry.size = len(text)
        archive.addfile(entry, io.BytesIO(text))
    command = command.replace("/tmp/", "").replace("tar ", "tar --force-local ")
    subprocess.run(["/bin/sh", "-c", command], cwd=str(tmp_path), check=True, timeout=60)
    assert (tmp_path / "camera.yaml").read_bytes() == text


def checks():
    return [arguments for name, arguments in COMMANDS if name == "check_calibration"]


@pytest.mark.slow
@pytest.mark.parametrize("arguments, code", zip(checks(), [1, 1, 2]))
def test_checks_work(photos, monkeypatch, capsys, arguments, code):  # noqa: F811
    """Of a focal length that is 2 % too long; the last one has two photos, which are too few."""
    monkeypatch.chdir(photos)
    Path("camera.yaml").write_text(Path("long.yaml").read_text())
    Path("tape.txt").write_text("0.7/0.png 0.7\n")
    if not Path("corners").exists():
        Path("corners").symlink_to("1.2")
    words = [
        name for word in shlex.split(arguments) for name in (sorted(map(str, Path().glob(word))) or [word])
    ]
    words = ["0" if word == "7" else word for word in words]  # the marker of these photos
    assert check_calibration.main(words) == code
    out = capsys.readouterr().out
    heading = "calibration                error        +-   allowed"
    assert heading in out and heading in PAGE
    if code == 1:
        found = re.search(r"the focal length is .* % too long \(or the markers have another size\)", out)
        assert re.sub(r"[\d.]+", "", found.group()) in re.sub(r"[\d.]+", "", PAGE)


def test_there_are_three_checks():
    assert len(checks()) == 3


def test_options_are_those_of_the_command(capsys):
    with pytest.raises(SystemExit):
        check_calibration.main(["--help"])
    options = set(re.findall(r"^  (--[\w-]+)", capsys.readouterr().out, re.M))
    table = PAGE.partition("| option |")[2].partition("\n\n")[0]
    assert options_in(table) == options
