# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The benchmark of the ball task in a quick run: every topic with the network that comes along."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[3] / "benchmark/ball_task.py"


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    folder = tmp_path_factory.mktemp("benchmark")
    command = [
        sys.executable,
        str(SCRIPT),
        "--quick",
        "--json",
        str(folder / "figures.json"),
        "--plots",
        str(folder),
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=400)
    return done, folder


@pytest.mark.slow
def test_every_topic_is_measured(ran):
    done, folder = ran
    assert done.returncode == 0, done.stderr
    figures = json.loads((folder / "figures.json").read_text())
    assert (figures["holds"], figures["quick"]) == (True, True)
    assert list(figures["topics"]) == ["world", "places", "task"]
    (table,) = figures["topics"]["task"]
    assert [row["name"] for row in table["rows"]] == ["task 2", "task 3"]
    assert all(5.0 < row["median time to goal, s"]["value"] < 240.0 for row in table["rows"])


def test_pictures_are_drawn(ran):
    assert (ran[1] / "task.png").read_bytes().startswith(b"\x89PNG")
