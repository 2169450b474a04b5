# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Quick runs of the benchmarks of places."""

import pytest
from quick_run import tables_of
from real_data import EXTERNAL


@pytest.mark.slow
def test_quick_run_of_the_seasons(tmp_path):
    usual, hard = tables_of("places.py", "seasons", tmp_path)
    rows = {row["name"]: row for row in usual["rows"]}
    assert rows["summer -> autumn, filter"]["recall@1"]["value"] > 0.8
    names = [row["name"] for row in hard["rows"]]
    walks = "autumn -> snow, street 3", "mean"
    assert names == [f"{each}, {mode}" for each in walks for mode in ("single", "filter", "filter, GPS")]
    assert 0 <= hard["rows"][-1]["recall@1"]["value"] <= hard["rows"][-1]["@5"]["value"] <= 1


@pytest.mark.slow
def test_quick_run_of_metric_poses(tmp_path):
    (table,) = tables_of("places.py", "metric_pose", tmp_path)
    (row,) = table["rows"]
    assert row["metric, %"]["value"] > 80 and row["largest, m"]["value"] < 0.3
    assert row["position in 95 % region, %"]["value"] > 70  # of 12


@pytest.mark.slow
@pytest.mark.skipif(not (EXTERNAL / "places").is_dir(), reason="external test data")
def test_quick_run_of_recall(tmp_path):
    corridor, unknown, look_alikes, lund = tables_of("places.py", "recall", tmp_path)
    modes = {row["name"]: row["recall@1"]["value"] for row in corridor["rows"]}
    assert modes["single"] > modes["votes"] > 0
    assert unknown["rows"][0]["not in the map"]["value"] == lund["rows"][0]["placed"]["value"] == 8
    assert [row["recall@1"]["value"] > 0.9 for row in look_alikes["rows"]] == [True]
    for name in ("recall", "reliability_single"):
        assert (tmp_path / f"{name}.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
@pytest.mark.skipif(not (EXTERNAL / "places").is_dir(), reason="external test data")
def test_quick_run_of_the_calibration(tmp_path):
    domains, modes, weights = tables_of("places.py", "calibration", tmp_path)
    assert all(row["images of the map"]["value"] > 0 for row in domains["rows"])
    assert {row["queries"]["value"] for row in modes["rows"]} == {96}
    fitted, shipped = weights["rows"]
    assert fitted["slope"]["value"] > 0 < shipped["slope"]["value"]


@pytest.mark.slow
def test_quick_run_of_speed_and_size(tmp_path):
    (speed,) = tables_of("places.py", "speed", tmp_path)
    votes, ours = speed["rows"]
    assert ours["right, %"]["value"] >= 25 < votes["right, %"]["value"]  # the photos are 30 m apart
    assert ours["index, MB"]["value"] < votes["index, MB"]["value"]
    (size,) = tables_of("places.py", "size", tmp_path)
    few, many = size["rows"]
    assert few["right, %"]["value"] == many["right, %"]["value"] == 100
    assert few["index, MB"]["value"] < many["index, MB"]["value"]
