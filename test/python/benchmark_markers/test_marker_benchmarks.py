# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Quick runs of the benchmarks of markers."""

import pytest
from quick_run import tables_of, topics_of

from markers.chain import Run, numbered
from markers.chain_frames import PlayedDrive


def trust_tables(topic, folder):
    tables = tables_of("marker_trust.py", topic, folder)
    assert (folder / f"{topic}.png").read_bytes().startswith(b"\x89PNG")
    return tables


@pytest.mark.slow
@pytest.mark.parametrize("topic, column", [("consistency", "published"), ("head_on", "published")])
def test_quick_run_of_trust_publishes(topic, column, tmp_path):
    for table in trust_tables(topic, tmp_path):
        assert min(row[column]["value"] for row in table["rows"]) >= 0.5


@pytest.mark.slow
def test_quick_run_of_a_wrong_map_entry_leaves_it_out(tmp_path):
    for table in trust_tables("moved_marker", tmp_path):
        assert all(row["left out, %"]["value"] > 0 for row in table["rows"][1:])


@pytest.mark.slow
def test_quick_run_of_the_searches_finds_the_same_markers(tmp_path):
    for table in trust_tables("speed", tmp_path):
        plain, full, tracking = table["rows"]
        assert tracking["markers"]["value"] == full["markers"]["value"] >= plain["markers"]["value"] > 0
        assert full["wrong"]["value"] == tracking["wrong"]["value"] == 0


@pytest.mark.parametrize("lost", [set(), {0}, {0, 1, 7}])
def test_images_that_are_lost_leave_the_others_their_numbers(lost):
    played = PlayedDrive(None, {}, truth=list(range(10)), locatable=[0, 1, 2, 6, 7, 8])
    seen = {lap * 10 + number for lap in range(2) for number in played.locatable} - lost
    late = [0.0, 0.004, 0.0, 0.014]  # seconds: less than half a period
    poses = {int(1e9 * (1600000000.0 + number / 30.0 + late[number % 4])): number for number in seen}
    found = numbered(Run(poses=poses), played, 2)
    assert found and all(number == pose for number, pose in found.items()) and set(found) == seen


@pytest.mark.slow
def test_quick_run_of_the_chain(tmp_path):
    tables = trust_tables("chain", tmp_path)
    chain, *others = tables
    assert chain["title"].startswith("Chain") and len(chain["rows"]) == 2
    for row in chain["rows"]:
        assert row["poses, %"]["value"] > 0 and row["of the library's"]["value"] > 0
    stages = {row["name"] for table in others for row in table["rows"]}
    assert "localization: localization" in stages


@pytest.mark.slow
def test_quick_run_of_the_maps(tmp_path):
    topics = topics_of("marker_maps.py", "--only", "simulated,taped,series,bags", "--plots", tmp_path)
    assert (tmp_path / "simulated.png").read_bytes().startswith(b"\x89PNG")
    assert all(row["seen, not in it"]["value"] == 0 for row in topics["simulated"][0]["rows"])
    assert topics["taped"][0]["rows"][0]["exactly the two named, % of maps"]["value"] == 100
    for row in topics["series"][0]["rows"][:8]:  # of simulated corners, whose noise is known
        assert 0.5 < row["z: least"]["value"] <= row["z: largest"]["value"] < 2.0
    assert [row["differs"]["value"] for row in topics["bags"][0]["rows"]] == [0, 0, 0]
