# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every line of the shell examples is a command of Sextant with valid arguments, or a known foreign one.

The tests of the commands, launch files and nodes run them with data; here they are parsed as printed.
"""

import importlib
import os
import re
import shlex
from pathlib import Path

import pytest
from test_doc import NODES_PAGE, section, table_of
from test_launch_files import NEEDED, load

from sextant.commands.command_line import CommandParser
from sextant.commands.maps.maps_folder import LANDMARKS, MapPart, write_folder

ROOT = Path(__file__).resolve().parents[3]
PAGES = [ROOT / "README.md", *sorted((ROOT / "doc").rglob("*.md"))]
NODES = re.findall(r"^## (\w+)$", NODES_PAGE, re.M)
FOREIGN = (
    *(
        "apt install ./sextant_*.deb",
        "rosbag record ",
        "yolo export ",
        "rqt_image_view ",
        "rosrun tf2_ros ",
        "rosrun rqt_image_view ",
        "tar -xOf ",
        "apt install ",
        "mkdir ",
        "rosdep install ",
        "catkin_make ",
    ),
    *("roslaunch kobuki_node ", "roslaunch realsense2_camera "),
)


def commands():
    """{command: the page of its first occurrence}"""
    result = {}
    for page in PAGES:
        for block in re.findall(r"^ *```sh\n(.*?)^ *```", page.read_text(), re.M | re.S):
            for line in block.splitlines():
                words = shlex.split(os.path.expandvars(line), comments=True)
                if words:
                    result.setdefault(tuple(words), page.name)
    return result


COMMANDS = commands()


def of_kind(*words):
    found = [each for each in COMMANDS if each[: len(words)] == words]
    assert found
    return found


def tag_of(command):
    return " ".join(command)[:60]


def test_shell_examples_are_of_a_known_kind():
    kinds = ("rosrun sextant ", "roslaunch sextant ", "rosservice call ", "rostopic echo ", *FOREIGN)
    scripts = ("scripts/", "tools/", "benchmark/", ". build/devel/setup.bash")
    unknown = [each for each in map(" ".join, COMMANDS) if not each.startswith((*kinds, *scripts))]
    assert unknown == []


def module_of(command):
    """The module that a script imports."""
    script = (ROOT / "scripts" / command).read_text()
    return re.search(r"from (sextant\.commands\.[\w.]+) import", script).group(1)


@pytest.mark.parametrize("command", of_kind("rosrun", "sextant"), ids=tag_of)
def test_commands_and_nodes_accept_their_arguments(command, monkeypatch, capsys):
    name, arguments = command[2], list(command[3:])
    if name in NODES:
        pairs = dict(each.split(":=") for each in arguments)
        params = {key[1:] for key in pairs if key.startswith("_")}
        assert params <= set(table_of(name))
        for topic in {key for key in pairs if not key.startswith("_")}:
            assert f"`{topic}`" in section(NODES_PAGE, name)
        return
    parse = CommandParser.parse_intermixed_args

    def only_parse(self, given):
        parse(self, given)
        raise ValueError("parsed")

    monkeypatch.setattr(CommandParser, "parse_intermixed_args", only_parse)
    assert importlib.import_module(module_of(name)).main(arguments) == 2
    assert capsys.readouterr().err.endswith(": parsed\n")


@pytest.mark.parametrize("command", of_kind("roslaunch", "sextant"), ids=tag_of)
def test_launch_files_accept_their_arguments(command, tmp_path):
    file, given = ROOT / "launch" / command[2], list(command[3:])
    if any(each.startswith("maps:=") for each in given):
        write_folder(tmp_path, "Maps", [MapPart("landmarks", "one landmark", file=LANDMARKS)], {})
        given = [f"maps:={tmp_path}" if each.startswith("maps:=") else each for each in given]
    known = re.findall(r'<arg name="(\w+)"', file.read_text())
    assert {each.partition(":=")[0] for each in given} <= set(known)
    assert load(file, [*NEEDED.get(file.name, []), *given]).nodes


@pytest.mark.parametrize(
    "command", [*of_kind("rosservice", "call"), *of_kind("rostopic", "echo")], ids=tag_of
)
def test_services_and_topics_are_those_of_the_nodes(command):
    node, _, name = command[2][1:].rpartition("/")
    page = section(NODES_PAGE, node) if node else NODES_PAGE
    assert f"`~{name}`" in page or f"`{name}`" in page


@pytest.mark.parametrize(
    "command",
    [each for each in COMMANDS if each[0].startswith(("scripts/", "tools/", "benchmark/"))],
    ids=tag_of,
)
def test_scripts_are_there(command):
    assert os.access(ROOT / command[0], os.X_OK)
