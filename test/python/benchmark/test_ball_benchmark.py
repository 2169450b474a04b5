# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The benchmark of the ball task in a quick run: every topic with the network that comes along."""

import json
import subprocess
import sys
from pathlib import Path

import onnx.utils
import pytest

from sextant.objects.shipped_model import shipped_model

pytestmark = pytest.mark.skipif(not hasattr(onnx.utils, "extract_model"), reason="onnx is older than 1.8")
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
    assert list(figures["topics"]) == ["world", "detector", "places", "task"]
    _, facts, runtimes = figures["topics"]["detector"]
    (row,) = facts["rows"]
    assert row["MB"]["value"] == pytest.approx(shipped_model().stat().st_size / 1e6)
    assert 0.05 < row["GFLOP a frame"]["value"] <= 0.5
    opencv = next(row for row in runtimes["rows"] if row["name"] == "opencv")
    assert 0.1 < opencv["ms a frame"]["value"] < 1000.0
    (table,) = figures["topics"]["task"]
    assert [row["name"] for row in table["rows"]] == ["task 2", "task 3"]
    assert all(5.0 < row["median time to goal, s"]["value"] < 240.0 for row in table["rows"])


def test_pictures_are_drawn(ran):
    for name in ("detector.png", "task.png"):
        assert (ran[1] / name).read_bytes().startswith(b"\x89PNG")
