# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The files around the code agree with it, and the scripts do what their comments state."""

import ast
import os
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
TOOLS = ROOT / "tools"

JUNIT = {
    "gtest.xml": """<testsuites><testsuite>
        <testcase name="a" status="run"/><testcase name="b" status="notrun"/>
        <testcase name="c" status="run"><failure message="x"/></testcase></testsuite></testsuites>""",
    "python/pytest.xml": """<testsuites><testsuite>
        <testcase name="d"/><testcase name="e"><skipped message="no data"/></testcase>
        </testsuite></testsuites>""",
    "rosunit.xml": '<testsuite><testcase name="f"/><testcase name="g"><error/></testcase></testsuite>',
}


def totals_of(folder, **files):
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    command = [sys.executable, str(TOOLS / "test_totals.py"), str(folder)]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    return done.returncode, done.stdout.splitlines()[-1]


def test_totals_of_all_three_kinds_of_tests(tmp_path):
    assert totals_of(tmp_path, **JUNIT) == (1, "3 passed, 2 failed, 2 skipped")


def test_totals_succeed_only_when_something_passed_and_nothing_failed(tmp_path):
    assert totals_of(tmp_path) == (1, "0 passed, 0 failed, 0 skipped")
    good = JUNIT["python/pytest.xml"]
    assert totals_of(tmp_path, **{"a.xml": good}) == (0, "1 passed, 0 failed, 1 skipped")
    assert totals_of(tmp_path, **{"b.xml": good[:40]}) == (1, "1 passed, 1 failed, 1 skipped")


def test_totals_count_what_rostest_repeats_only_when_it_adds_something(tmp_path):
    good = JUNIT["python/pytest.xml"]
    repeated = '<testsuite><testcase classname="rostest.runner.RosTest" name="testa"/></testsuite>'
    timed_out = repeated.replace("/><", "><error/></testcase><")
    assert totals_of(tmp_path, **{"a.xml": good, "r.xml": repeated}) == (0, "1 passed, 0 failed, 1 skipped")
    assert totals_of(tmp_path, **{"r.xml": timed_out}) == (1, "1 passed, 1 failed, 1 skipped")


CTEST_LOG = """1/2 Testing: _ctest_sextant_gtest_test_base
1/2 Test: _ctest_sextant_gtest_test_base
Command: "x"
"_ctest_sextant_gtest_test_base" start time: Nov 23 15:00 UTC
Output:
----------------------------------------------------------
all is well
<end of output>
Test time =   0.50 sec
----------------------------------------------------------
Test Passed.
"_ctest_sextant_gtest_test_base" end time: Nov 23 15:00 UTC

2/2 Testing: _ctest_sextant_rostest_test_ros_ball_ball_task_launch.test
Output:
----------------------------------------------------------
no ball
<end of output>
Test time =  12.40 sec
----------------------------------------------------------
Test Failed.
"""


def test_every_test_has_a_log_and_a_failed_ones_path_is_printed(tmp_path):
    (tmp_path / "LastTest.log").write_text(CTEST_LOG)
    arguments = [tmp_path / "LastTest.log", tmp_path / "logs"]
    command = [sys.executable, str(TOOLS / "test_logs.py"), *map(str, arguments)]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    failed = tmp_path / "logs/ball_ball_task_launch.test.log"
    assert done.stdout == f"FAILED after 12 s: rostest_test_ros_ball_ball_task_launch.test, see {failed}\n"
    assert failed.read_text() == "no ball\n"
    assert (tmp_path / "logs/gtest_test_base.log").read_text() == "all is well\n"


def test_a_build_shows_errors_and_keeps_everything_in_its_log(tmp_path):
    printed = "[ 50%] Building CXX object a.cpp.o\na.cpp:1:1: error: no\nmake[1]: Leaving directory 'x'\n"
    command = [sys.executable, str(TOOLS / "build_progress.py"), str(tmp_path / "build.log")]
    done = subprocess.run(command, input=printed, stderr=subprocess.PIPE, text=True, check=True)
    assert done.stderr == "a.cpp:1:1: error: no\n"
    assert (tmp_path / "build.log").read_text() == printed


def in_environment(root, command, **variables):
    """Runs a bash command after tools/environment.sh of a checkout."""
    script = f'set -euo pipefail; . "{root}/tools/environment.sh"; {command}'
    return subprocess.run(
        ["/bin/bash", "-c", script],
        env={**os.environ, **variables},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=60,
    )


def test_scripts_use_debians_python_whatever_comes_first(tmp_path):
    (tmp_path / "python3").write_text("#!/bin/sh\nexit 1\n")
    (tmp_path / "python3").chmod(0o755)
    done = in_environment(
        ROOT,
        'command -v python3; echo "${PYTHONPATH-} ${CMAKE_PREFIX_PATH-} ${ROS_NAMESPACE-}"',
        PATH=f"{tmp_path}:{os.environ['PATH']}",
        PYTHONPATH="/elsewhere",
        CMAKE_PREFIX_PATH="/elsewhere",
        ROS_NAMESPACE="elsewhere",
    )
    assert done.stdout.split() == ["/usr/bin/python3"]


def test_only_missing_packages_are_asked_for(tmp_path):
    (tmp_path / "tools").mkdir()
    (tmp_path / "tools/apt_packages_a.txt").write_text("# comment\n\nbash\nno-such-package  # why\n")
    (tmp_path / "tools/apt_packages_b.txt").write_text("old >= 11\nnot-yet >= 99\n")
    missing = in_environment(ROOT, f"root={tmp_path}; missing_packages a b").stdout
    assert missing.split() == ["no-such-package", "old"]


def test_a_path_that_catkin_cannot_build_in_is_refused(tmp_path):
    checkout = tmp_path / "my robot"
    (checkout / "tools").mkdir(parents=True)
    (checkout / "tools/environment.sh").write_text((TOOLS / "environment.sh").read_text())
    done = in_environment(checkout, "install_packages; build_package")
    assert done.returncode == 1
    assert str(checkout) in done.stdout and "without blanks" in done.stdout
    assert not (checkout / "build").exists()


@pytest.mark.parametrize("name", ["msg", "srv"])
def test_every_message_is_generated(name):
    cmake = (ROOT / "CMakeLists.txt").read_text()
    listed = set(re.findall(rf"\b\w+\.{name}\b", cmake))
    assert listed == {path.name for path in (ROOT / name).glob(f"*.{name}")}


def test_every_nodelet_is_described():
    sources = "".join(path.read_text() for path in (ROOT / "src/nodelets").glob("*.cpp"))
    exported = set(re.findall(r"PLUGINLIB_EXPORT_CLASS\(\s*([\w:]+)", sources))
    description = ElementTree.parse(str(ROOT / "nodelet_plugins.xml"))
    described = {each.get("type") for each in description.iter("class")}
    assert exported and exported == described


def test_the_header_of_every_node_begins_with_its_name():
    nodes = [
        path
        for path in (ROOT / "src/sextant/nodes").rglob("*.py")
        if (ROOT / "scripts/nodes" / path.stem).exists()
    ]
    headers = {path.stem: ast.get_docstring(ast.parse(path.read_text())) for path in nodes}
    assert len(headers) > 10
    assert [name for name, text in headers.items() if not text.startswith(f"Node {name}: ")] == []


def test_version_is_in_the_changelog():
    version = ElementTree.parse(str(ROOT / "package.xml")).findtext("version")
    assert re.search(rf"^{re.escape(version)}\b", (ROOT / "CHANGELOG.rst").read_text(), re.M)
