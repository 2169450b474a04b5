# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The walls between the rooms (CONTRIBUTING.md). No compiler sees them: all of ROS is in /usr/include."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]

STANDARD_HEADER = r"[a-z_0-9]+"  # <vector>
POSIX_HEADER = r"(fcntl|unistd|sys/[a-z]+)\.h"
CORE_LIBRARY = r"(Eigen|apriltag|boost/math|ceres|dlib|faiss|opencv2|yaml-cpp)/.+"

# room: (its folders, what it may include)
ROOMS = {
    "core": (
        ("include/sextant/core", "src/core"),
        (STANDARD_HEADER, POSIX_HEADER, CORE_LIBRARY, r"sextant/core/.+"),
    ),
    "bindings": (
        ("src/bindings",),
        (STANDARD_HEADER, r"(Eigen|opencv2|pybind11)/.+", r"sextant/core/.+"),
    ),
    "ros": (
        ("include/sextant/ros", "src/ros"),
        (r"(?!sextant/).+", r"sextant/(core|ros)/.+", r"sextant/[A-Z]\w+\.h"),
    ),
    "nodelets": (
        ("src/nodelets",),
        (r"(?!sextant/).+", r"sextant/(core|ros)/.+", r"sextant/[A-Z]\w+\.h"),
    ),
    "nodes": (
        ("src/nodes",),
        (STANDARD_HEADER, r"(ros|nodelet)/.+", r"sextant/ros/.+"),
    ),
}

# The core takes time as an argument and says nothing.
NOT_IN_CORE = re.compile(r"std::(cout|cerr|clog)|\bprintf\(|_clock::now|\btime\(nullptr\)|\bgetenv\(")
ROS_MODULES = re.compile(
    r"(actionlib|cv_bridge|diagnostic_updater|dynamic_reconfigure|message_filters|nodelet|ros[a-z]+|tf|tf2_\w+|std_srvs|\w+_msgs"
    r"|sextant\.(msg|srv|nodes|bags|commands))(\.|$)"
)
RUNNING_ROS = re.compile(r"(actionlib|dynamic_reconfigure|rospy|tf2_ros|sextant\.(nodes|commands))(\.|$)")
EMPTY_NOUN = re.compile(r"(^|_)(utils?|helpers?|common|misc)(_|$)")
SPDX = [
    re.compile(r"(#|//) SPDX-FileCopyrightText: Sextant authors"),
    re.compile(r"(#|//) SPDX-License-Identifier: BSD-3-Clause"),
]


def files(*folders, suffixes=(".cpp", ".hpp", ".py", ".sh")):
    """Files below the folders of the project, without what Python leaves behind."""
    found = (path for folder in folders for path in (ROOT / folder).rglob("*"))
    return sorted(path for path in found if path.is_file() and path.suffix in suffixes)


def executables():
    return sorted(path for path in (ROOT / "scripts").iterdir() if path.is_file() and not path.suffix)


def all_code():
    named = files("include", "src", "test", "scripts", "benchmark")
    return [*named, *executables(), ROOT / "setup.py", ROOT / ".ci/run"]


def offenders(paths, check):
    """{path: what the check of its text found} of the files where it found something."""
    found = {str(path.relative_to(ROOT)): check(path.read_text()) for path in paths}
    return {name: value for name, value in found.items() if value}


def includes(text):
    """(name, whether it may be a neighbour in the same folder) of every #include."""
    found = re.findall(r"^\s*#\s*include\s*([<\"])([^>\"]+)", text, re.M)
    return [(name, mark == '"') for mark, name in found]


def forbidden_includes(text, allowed, neighbours=()):
    allowed = re.compile("|".join(f"(?:{pattern})" for pattern in allowed))
    return [
        name
        for name, quoted in includes(text)
        if not (quoted and name in neighbours) and not allowed.fullmatch(name)
    ]


def imports(text):
    """Dotted names of all modules that a Python source imports, wherever in the file."""
    names = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            module = "." * node.level + (node.module or "")
            names.update({module, *(f"{module}.{alias.name}" for alias in node.names)})
    return names


def ros_imports(text):
    return sorted(name for name in imports(text) if ROS_MODULES.match(name) or name.startswith("."))


@pytest.mark.parametrize("room", ROOMS)
def test_room_includes_only_what_its_walls_let_through(room):
    folders, allowed = ROOMS[room]
    sources = files(*folders)
    assert sources, f"nothing in {folders}: the wall guards an empty room"
    neighbours = {path.name for path in sources if path.suffix == ".hpp"}
    assert offenders(sources, lambda text: forbidden_includes(text, allowed, neighbours)) == {}


def test_core_reads_no_clock_and_writes_no_console():
    assert offenders(files("include/sextant/core", "src/core"), NOT_IN_CORE.findall) == {}


def python_room(name):
    return [path for path in files("src/sextant") if name in path.parts]


def test_python_library_knows_no_ros():
    outside = {*python_room("nodes"), *python_room("bags"), *python_room("commands")}
    library = [path for path in files("src/sextant") if path not in outside]
    assert library
    assert offenders(library, ros_imports) == {}


@pytest.mark.parametrize("room", ["bags", "commands"])
def test_what_runs_offline_needs_no_master(room):
    sources = python_room(room)
    assert sources, f"nothing in {room}: the wall guards an empty room"

    def running(text):
        mine = re.compile(rf"sextant\.{room}(\.|$)")
        return sorted(name for name in imports(text) if RUNNING_ROS.match(name) and not mine.match(name))

    assert offenders(sources, running) == {}


def test_executables_only_call_their_node():
    for path in executables():
        tree = ast.parse(path.read_text())
        assert len(tree.body) <= 3, f"{path.name}: what it does belongs into src/sextant/nodes or commands"
        assert path.stat().st_mode & 0o111, f"{path.name} is not executable"
        if "sextant.commands" in path.read_text():  # its worker processes read it again
            assert isinstance(tree.body[-1], ast.If), f"{path.name} lacks if __name__ == '__main__'"


def test_node_loaders_are_short():
    long = [path.name for path in files("src/nodes") if len(path.read_text().splitlines()) > 30]
    assert long == []


def test_every_core_noun_has_its_test():
    nouns = {path.stem for path in files("include/sextant/core")} & {path.stem for path in files("src/core")}
    tested = {path.stem[: -len("_test")] for path in files("test/core") if path.stem.endswith("_test")}
    assert sorted(nouns - tested) == []


def test_names_say_something():
    assert [str(path.relative_to(ROOT)) for path in all_code() if EMPTY_NOUN.search(path.stem)] == []


def test_files_are_at_most_300_lines_long():
    assert offenders(all_code(), lambda text: len(text.splitlines()) > 300) == {}


def lacks_licence(text):
    lines = [line for line in text.splitlines()[:4] if not line.startswith(("#!", "# shellcheck"))]
    return bool(lines) and not all(pattern.fullmatch(line) for pattern, line in zip(SPDX, lines))


def test_files_begin_with_the_licence():
    assert offenders(all_code(), lacks_licence) == {}


@pytest.mark.parametrize(
    "room, line",
    [
        ("core", "#include <ros/ros.h>"),
        ("core", '#include "sextant/ros/conversions.hpp"'),
        ("core", "#include <sextant/Marker.h>"),
        ("core", "#include <cv_bridge/cv_bridge.h>"),
        ("core", "#include <pybind11/pybind11.h>"),
        ("bindings", "# include <sensor_msgs/Image.h>"),
        ("bindings", '#include "../ros/conversions.hpp"'),
        ("ros", '#include "sextant/nodelets/marker_detector.hpp"'),
        ("nodes", '#include "sextant/core/pose.hpp"'),
    ],
)
def test_the_wall_stops_an_include(room, line):
    assert forbidden_includes(line, ROOMS[room][1])


@pytest.mark.parametrize(
    "line",
    [
        "import rospy",
        "def f():\n    import rosbag",
        "from tf2_ros import Buffer",
        "from sextant import nodes",
        "from sextant.msg import Marker",
        "from .nodes import params",
        "import geometry_msgs.msg as g",
    ],
)
def test_the_wall_stops_an_import(line):
    assert ros_imports(line)
