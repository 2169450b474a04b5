# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from written_bags import WrittenBag

from sextant.commands.estimate_depth_scale import main

ROOT = Path(__file__).resolve().parents[3]


@pytest.mark.slow
def test_a_file_gives_a_scale_and_a_table(tmp_path):
    path = tmp_path / "depths.csv"
    path.write_text("measured,true\n0.4808,0.5\n0.9615,1.0\n1.9231,2.0\n")
    command = [sys.executable, str(ROOT / "scripts/estimate_depth_scale"), str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert "scale: 1.0400 ± 0.00" in done.stdout and "WARNING" not in done.stdout
    assert len(done.stdout.splitlines()) == 6


def test_bags_and_a_file_go_together(tmp_path, capsys):
    bags = []
    for distance in (1.0, 2.0):
        with WrittenBag(tmp_path / f"{distance}.bag") as bag:
            bag.encoded("/depth", np.full((60, 80), distance / 1.04, np.float32), "32FC1", 0.0)
        bags += ["--bag", str(tmp_path / f"{distance}.bag"), "--distance", str(distance)]
    (tmp_path / "depths.csv").write_text("1.4423,1.5\n")
    assert main([*bags, str(tmp_path / "depths.csv")]) == 0
    assert "scale: 1.0400" in capsys.readouterr().out


def test_what_is_no_scale_is_a_warning(tmp_path, capsys):
    (tmp_path / "depths.csv").write_text("0.45,0.5\n0.95,1.0\n1.45,1.5\n1.95,2.0\n")
    assert main([str(tmp_path / "depths.csv")]) == 0
    assert "WARNING: an offset of +0.0500" in capsys.readouterr().out


@pytest.mark.parametrize(
    "arguments, reason",
    [
        ([], "no distances"),
        (["--bag", "a.bag"], "there are 1 --bag and 0 --distance"),
        (["--bag", "a.bag", "--distance", "-1"], "--distance is -1.0, must be within (0, 100] metres"),
        (["--bag", "a.bag", "--distance", "1"], "a.bag: there is no such file"),
        (["nowhere.csv"], "nowhere.csv: No such file"),
        (["--tape-sigma", "2", "x.csv"], "tape_sigma: must be within [0, 1], is 2.0"),
    ],
)
def test_mistakes_are_one_line(capsys, arguments, reason):
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert reason in error and error.count("\n") == 1
