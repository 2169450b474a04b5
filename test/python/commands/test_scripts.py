# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executables of all commands: they run, and end with the exit code of their main()."""

import subprocess
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[3] / "scripts"
COMMANDS = sorted(
    path.name for path in FOLDER.iterdir() if path.is_file() and "from sextant.commands." in path.read_text()
)


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDS)
def test_a_wrong_argument_is_refused_in_one_line(tmp_path, name):
    command = [str(FOLDER / name), "--no-such-option"]
    done = subprocess.run(command, cwd=str(tmp_path), capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert done.stderr.startswith(f"{name}: ") and list(tmp_path.iterdir()) == []
