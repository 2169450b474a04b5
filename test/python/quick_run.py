# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Quick runs of the benchmarks."""

import json
import subprocess
import sys
from pathlib import Path

BENCHMARK = Path(__file__).resolve().parents[2] / "benchmark"


def run(script, *arguments):
    """The finished process of one script."""
    command = [sys.executable, str(BENCHMARK / script), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=600)


def topics_of(script, *options):
    """The tables of a quick run by topic."""
    done = run(script, "--quick", "--json", "-", *options)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)["topics"]


def tables_of(script, topic, folder):
    """Of one topic; its pictures lie in the folder."""
    return topics_of(script, "--only", topic, "--plots", folder)[topic]
