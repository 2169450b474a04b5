# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What several tests begin with; the marker `slow`; the modules of the benchmarks."""

import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).resolve().parents[2] / "benchmark"))


def pytest_configure(config):
    config.addinivalue_line("markers", "slow: takes a second or more; scripts/test.sh --quick leaves it out")


def pytest_sessionfinish(session, exitstatus):
    if exitstatus == pytest.ExitCode.NO_TESTS_COLLECTED and session.config.option.markexpr:
        session.exitstatus = pytest.ExitCode.OK  # all tests of a room are slow


@pytest.fixture
def folder(tmp_path):
    """Of photos, empty."""
    folder = tmp_path / "photos"
    folder.mkdir()
    return folder


@pytest.fixture
def served(folder):
    """The page of a map that is begun in the folder."""
    from served_page import Served  # only here: no other test needs a server

    from sextant.place_maps.place_map_draft import PlaceMapDraft

    served = Served(PlaceMapDraft(folder / "map.txt"))
    yield served
    served.close()
