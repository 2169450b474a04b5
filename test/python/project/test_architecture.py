# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The walls between the rooms (CONTRIBUTING.md). No compiler sees them: all of ROS is in /usr/include."""

import ast
import re
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]

STANDARD_HEADER = r"[a-z_0-9]+"  # <vector>
POSIX_HEADER = r"(fcntl|unistd|sys/[a-z]+)\.h"
GENERATED_HEADER = r"sextant/[A-Z]\w+\.h"

# A room of the core: (the rooms that it uses, the libraries that it uses)
CORE = {
    "base": ("", "Eigen yaml-cpp"),
    "geometry": ("", "Eigen"),
    "images": ("base", "opencv2"),
    "markers": ("base geometry", "Eigen apriltag opencv2"),
    "detection": ("base geometry markers", "Eigen opencv2"),
    "localization": ("base geometry markers", "Eigen boost/math"),
    "mapping": ("base geometry markers landmarks localization", "Eigen ceres"),
    "landmarks": ("base geometry", "Eigen boost/math"),
    "fusion": ("base geometry markers landmarks", "Eigen boost/math"),
    "places": ("base", "dlib Eigen faiss opencv2"),
    "simulation": ("base geometry markers", "Eigen opencv2"),
}

# A room of the bridges to ROS: (the rooms of the core that it uses, the rooms of the bridges that it uses)
BRIDGES = {
    "base": ("base", ""),
    "geometry": ("geometry", ""),
    "markers": ("geometry markers", "geometry"),
    "images": ("base images", "base"),
    "detection": ("base geometry images markers detection", "base"),
    "localization": ("base geometry markers localization", "base geometry markers"),
    "landmarks": ("base geometry markers landmarks fusion", "base geometry markers"),
}

# A room of the Python library: the rooms that it uses. Every one may use the core, `import sextant`.
PYTHON = {
    "base": "",
    "geometry": "",
    "calibration": "base",
    "markers": "base geometry",
    "localization": "geometry",
    "mapping": "base",
    "landmarks": "base geometry",
    "images": "",
    "objects": "base geometry landmarks",
    "labels": "base images objects",
    "place_maps": "base geometry images",
    "place_points": "base geometry images place_maps",
    "places": "base images place_maps place_points",
    "place_reports": "base place_maps places",
    "printing": "base markers",
    "ball": "base geometry objects",
    "simulation": "base geometry objects",
    "streets": "base geometry place_maps simulation",
    "buildings": "base geometry place_maps simulation",
    "detection_scores": "base geometry images labels objects",
    "training": "base detection_scores images labels objects simulation",
    "evaluation": "base geometry localization objects ball simulation",
    "messages": "geometry localization objects",
    "bags": "base calibration geometry images landmarks localization messages objects place_maps",
}


def library_headers(names):
    return [rf"{name}/.+" for name in names.split()]


def room_headers(names, prefix="sextant/"):
    return [rf"{prefix}{name}/.+" for name in names.split()]


# (name, its folders, what it may include besides its neighbours)
WALLS = {
    **{
        f"core {room}": (
            (f"include/sextant/{room}", f"src/{room}"),
            [STANDARD_HEADER, POSIX_HEADER, *library_headers(libraries), *room_headers(f"{room} {rooms}")],
        )
        for room, (rooms, libraries) in CORE.items()
    },
    **{
        f"ros {room}": (
            (f"include/sextant/ros/{room}", f"src/ros/{room}"),
            [
                r"(?!sextant/).+",
                GENERATED_HEADER,
                *room_headers(core),
                *room_headers(f"{room} {bridges}", "sextant/ros/"),
            ],
        )
        for room, (core, bridges) in BRIDGES.items()
    },
    "bindings": (
        ("src/bindings",),
        [STANDARD_HEADER, r"(Eigen|opencv2|pybind11)/.+", *room_headers(" ".join(CORE))],
    ),
    "nodelets": (
        ("src/nodelets",),
        [r"(?!sextant/).+", r"sextant/ros/.+", GENERATED_HEADER, *room_headers(" ".join(CORE))],
    ),
    "nodes": (("src/nodes",), [STANDARD_HEADER, r"(ros|nodelet)/.+", r"sextant/ros/base/.+"]),
}

# The core takes time as an argument and prints nothing.
NOT_IN_CORE = re.compile(r"std::(cout|cerr|clog)|\bprintf\(|_clock::now|\btime\(nullptr\)|\bgetenv\(")
ROS_MODULES = re.compile(
    r"(actionlib|cv_bridge|diagnostic_updater|dynamic_reconfigure|message_filters|nodelet|ros[a-z]+|tf|tf2_\w+|std_srvs|\w+_msgs"
    r"|sextant\.(msg|srv|nodes|bags|messages|commands))(\.|$)"
)
RUNNING_ROS = re.compile(r"(actionlib|dynamic_reconfigure|rospy|tf2_ros|sextant\.(nodes|commands))(\.|$)")
EMPTY_NOUN = re.compile(r"(^|_)(utils?|helpers?|common|misc)(_|$)")
SPDX = [
    re.compile(r"(#|//) SPDX-FileCopyrightText: Sextant authors"),
    re.compile(r"(#|//) SPDX-License-Identifier: BSD-3-Clause"),
]


TREES = ("include", "src", "test", "scripts", "tools", "benchmark", "doc", "launch", "msg")
SOURCES = (".cpp", ".hpp", ".py", ".sh", ".md", ".launch", ".msg", ".test", "")


def files(*folders, suffixes=(".cpp", ".hpp", ".py", ".sh")):
    """Files below the folders of the project, without what Python leaves behind."""
    found = (path for folder in folders for path in (ROOT / folder).rglob("*"))
    return sorted(path for path in found if path.is_file() and path.suffix in suffixes)


def executables():
    return sorted(path for path in (ROOT / "scripts").rglob("*") if path.is_file() and not path.suffix)


def all_code():
    named = files("include", "src", "test", "scripts", "tools", "benchmark")
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


@pytest.mark.parametrize("room", WALLS)
def test_room_includes_only_what_its_walls_let_through(room):
    folders, allowed = WALLS[room]
    sources = files(*folders)
    assert sources, f"nothing in {folders}: the wall guards an empty room"
    neighbours = {path.name for path in sources if path.suffix == ".hpp"}
    assert offenders(sources, lambda text: forbidden_includes(text, allowed, neighbours)) == {}


def folders_of(*places):
    """Names of the folders in these that have a source in them."""
    found = (path for place in places for path in (ROOT / place).iterdir() if path.is_dir())
    return {path.name for path in found if files(path.relative_to(ROOT), suffixes=(".cpp", ".hpp", ".py"))}


def test_every_folder_is_a_room_with_walls():
    others = {"bindings", "ros", "nodelets", "nodes", "sextant"}
    assert folders_of("include/sextant") == {*CORE, "ros"} and folders_of("src") - others == set(CORE)
    assert folders_of("src/ros") == folders_of("include/sextant/ros") == set(BRIDGES)
    assert folders_of("src/sextant") == {*PYTHON, "nodes", "commands"}


CONTRIBUTING = ROOT / "CONTRIBUTING.md"


@pytest.mark.parametrize("room", sorted({*CORE, *BRIDGES, *PYTHON}))
def test_every_room_is_described_with_the_rooms_that_it_uses(room):
    row = re.search(rf"^\| `{room}` \|[^|]+\|([^|]*)\|([^|]*)\|$", CONTRIBUTING.read_text(), re.M)
    uses = [CORE.get(room, ("–",))[0], PYTHON.get(room, "–")]
    assert [set(cell.split()) for cell in row.groups()] == [set((rooms or "none").split()) for rooms in uses]


def test_no_folder_is_crowded():
    count = Counter(path.parent for path in files(*TREES, suffixes=SOURCES) if path.parent.name != "data")
    assert {str(folder.relative_to(ROOT)): number for folder, number in count.items() if number > 30} == {}


def core_files():
    return [path for room in CORE for path in files(f"include/sextant/{room}", f"src/{room}")]


def test_core_reads_no_clock_and_writes_no_console():
    assert offenders(core_files(), NOT_IN_CORE.findall) == {}


def python_room(name):
    return [path for path in files("src/sextant") if name in path.parts]


def test_python_library_knows_no_ros():
    outside = {path for name in ("nodes", "bags", "messages", "commands") for path in python_room(name)}
    library = [path for path in files("src/sextant") if path not in outside]
    assert library
    assert offenders(library, ros_imports) == {}


def rooms_used(text):
    """Of the Python library, by a source."""
    dotted = (name.split(".") for name in imports(text) if name.startswith("sextant."))
    return {name[1] for name in dotted if name[1] in {*PYTHON, "nodes", "commands"}}


@pytest.mark.parametrize("room", PYTHON)
def test_python_room_uses_only_the_rooms_below_it(room):
    sources = files(f"src/sextant/{room}")
    allowed = {room, *PYTHON[room].split()}
    assert offenders(sources, lambda text: rooms_used(text) - allowed) == {}


@pytest.mark.parametrize("rooms", [PYTHON, {room: uses for room, (uses, _) in CORE.items()}])
def test_arrows_between_rooms_make_no_circle(rooms):
    left = {room: set(uses.split()) for room, uses in rooms.items()}
    while left:
        free = {room for room, uses in left.items() if not uses & set(left)}
        assert free, f"these use one another: {left}"
        left = {room: uses for room, uses in left.items() if room not in free}


@pytest.mark.parametrize("room", ["bags", "messages", "commands"])
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


UNTESTED = {"eigen_solvers"}  # Eigen's own, compiled once: it has no function of its own


@pytest.mark.parametrize("room", CORE)
def test_every_core_noun_has_its_test(room):
    nouns = {path.stem for path in files(f"src/{room}", suffixes=(".cpp",))} - UNTESTED
    tested = {path.stem[: -len("_test")] for path in files(f"test/core/{room}")}
    assert sorted(nouns - tested) == []


def test_names_are_meaningful():
    assert [str(path.relative_to(ROOT)) for path in all_code() if EMPTY_NOUN.search(path.stem)] == []


def test_files_are_at_most_500_lines_long():
    assert offenders(all_code(), lambda text: len(text.splitlines()) > 500) == {}


def lacks_licence(text):
    lines = [line for line in text.splitlines()[:4] if not line.startswith(("#!", "# shellcheck"))]
    return bool(lines) and not all(pattern.fullmatch(line) for pattern, line in zip(SPDX, lines))


def test_files_begin_with_the_licence():
    assert offenders(all_code(), lacks_licence) == {}


@pytest.mark.parametrize(
    "room, line",
    [
        ("core geometry", "#include <ros/ros.h>"),
        ("core geometry", '#include "sextant/ros/geometry/pose_conversions.hpp"'),
        ("core markers", "#include <sextant/Marker.h>"),
        ("core markers", "#include <cv_bridge/cv_bridge.h>"),
        ("core markers", "#include <pybind11/pybind11.h>"),
        ("core markers", '#include "sextant/localization/marker_locator.hpp"'),
        ("core landmarks", "#include <opencv2/core.hpp>"),
        ("core detection", "#include <ceres/problem.h>"),
        ("bindings", "# include <sensor_msgs/Image.h>"),
        ("bindings", '#include "../ros/geometry/pose_conversions.hpp"'),
        ("ros base", '#include "sextant/ros/geometry/transform_lookup.hpp"'),
        ("ros markers", '#include "sextant/nodelets/marker_detector.hpp"'),
        ("nodes", '#include "sextant/geometry/pose.hpp"'),
    ],
)
def test_the_wall_stops_an_include(room, line):
    assert forbidden_includes(line, WALLS[room][1])


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
