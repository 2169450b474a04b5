# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Quick runs of the benchmarks of landmarks."""

import numpy as np
import pytest
from quick_run import tables_of
from real_data import EXTERNAL

import sextant
from landmarks import drive_bag
from landmarks.commanded_drive import read_commanded_drive
from landmarks.landmark_kidnap import Check, outcome
from landmarks.stamped_drive import LABELS, estimated
from sextant.commands import map_landmarks


@pytest.mark.slow
def test_quick_run_of_the_accuracy_of_landmarks(tmp_path):
    (table,) = tables_of("landmarks.py", "accuracy", tmp_path)
    for row in table["rows"]:
        assert 0.3 < row["pose NEES"]["value"] < 3 and 0.3 < row["map NEES"]["value"] < 3
    assert (tmp_path / "accuracy.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_quick_run_of_the_association_of_landmarks(tmp_path):
    (table,) = tables_of("landmarks.py", "association", tmp_path)
    assert all(row["wrong associations"]["value"] == 0 for row in table["rows"])


@pytest.mark.slow
def test_quick_run_of_realistic_drives_among_landmarks(tmp_path):
    (table,) = tables_of("landmarks.py", "realistic", tmp_path)
    known, three, one = table["rows"]
    assert known["wrong associations, %"]["value"] == 0
    assert 3 < known["landmarks right: least"]["value"] <= 15
    assert three["over known ids: median"]["value"] > 0.5 and one["pose, m (median)"]["value"] > 0.01


@pytest.mark.slow
@pytest.mark.skipif(not (EXTERNAL / "landmarks").is_dir(), reason="external test data")
def test_quick_run_of_recorded_drives_among_landmarks(tmp_path):
    (table,) = tables_of("landmarks.py", "real_drives", tmp_path)
    known, three, _ = table["rows"]
    assert known["landmarks right: least"]["value"] == 15
    assert three["maps exact"]["value"] == 1
    assert three["over known ids: median"]["value"] < 1.5


@pytest.mark.slow
@pytest.mark.skipif(not (EXTERNAL / "landmarks").is_dir(), reason="external test data")
def test_quick_run_of_the_figures_of_drives(tmp_path):
    (table,) = tables_of("landmarks.py", "drive_figures", tmp_path)
    recorded, simulated, ratio = table["rows"]
    assert 3 < recorded["observations a second"]["value"] < 7
    for name in ("moved in 10 s, m", "odometry off, m: median"):
        assert 0.3 < ratio[name]["value"] < 3
        assert ratio[name]["value"] == pytest.approx(simulated[name]["value"] / recorded[name]["value"])


@pytest.mark.slow
@pytest.mark.skipif(not (EXTERNAL / "landmarks").is_dir(), reason="external test data")
def test_quick_run_of_maps_of_recorded_drives(tmp_path):
    (table,) = tables_of("landmarks.py", "batch", tmp_path)
    for row in table["rows"]:
        assert row["maps exact"]["value"] == 1 and 0.8 < row["over known ids: median"]["value"] < 1.2


@pytest.mark.slow
@pytest.mark.skipif(not (EXTERNAL / "landmarks").is_dir(), reason="external test data")
def test_a_recorded_drive_as_a_bag_gives_the_map_of_the_benchmark(tmp_path):
    bag, out = tmp_path / "drive.bag", tmp_path / "map.yaml"
    folder = EXTERNAL / "landmarks" / "mrclam"
    assert drive_bag.main([str(folder), "1", "1", "-o", str(bag)]) == 0
    params = ["--params", str(bag.with_suffix(".yaml"))]
    assert map_landmarks.main([str(bag), "-o", str(out), "--online", *params]) == 0
    drive = read_commanded_drive(folder, 1, 1)
    expected = estimated(drive, LABELS["three classes"])
    found = np.array([each.position for each in sextant.read_landmark_map(str(out)).landmarks])
    assert found == pytest.approx(expected.landmarks, abs=1e-3)


@pytest.mark.slow
def test_quick_run_of_the_cost_of_landmarks(tmp_path):
    cost, same = tables_of("landmarks.py", "cost", tmp_path)
    assert cost["rows"][-1]["of the textbook's"]["value"] < 1
    for row in same["rows"]:
        assert max(row[column]["value"] for column in row if column != "name") < 1e3  # 1e-9


@pytest.mark.slow
def test_quick_run_of_bad_messages_and_a_large_map(tmp_path):
    bad, long, states = tables_of("landmarks.py", "limits", tmp_path)
    assert len(bad["rows"]) == 9  # their bars hold, or the exit status is another one
    assert all(row["landmarks"]["value"] == 50 for row in long["rows"])
    assert states["rows"][1]["of one state"]["value"] > 0.3


@pytest.mark.slow
def test_quick_run_of_late_observations(tmp_path):
    late, clock = tables_of("landmarks.py", "delay", tmp_path)
    at_stamp, at_arrival = (row["of no delay"]["value"] for row in late["rows"][1:])
    assert at_stamp < 1.1 < at_arrival
    assert all(30 < row["offset, ms"]["value"] < 70 for row in clock["rows"][1:])


@pytest.mark.slow
@pytest.mark.skipif(not (EXTERNAL / "landmarks").is_dir(), reason="external test data")
def test_quick_run_of_victoria_park(tmp_path):
    optimum, known, unknown = tables_of("landmarks.py", "victoria_park", tmp_path)
    assert all(row["cost"]["value"] > 0 for row in optimum["rows"])
    assert known["rows"][0]["trajectory, m"]["value"] < known["rows"][1]["trajectory, m"]["value"] + 1
    assert unknown["rows"][0]["landmarks"]["value"] > 10
    assert (tmp_path / "victoria_park.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_quick_run_of_odometry_and_markers(tmp_path):
    (table,) = tables_of("landmarks.py", "fusion", tmp_path)
    for row in table["rows"]:
        assert row["error after the first marker, m"]["value"] < row["error before, m"]["value"]


@pytest.mark.slow
def test_quick_run_of_carried_robots(tmp_path):
    (table,) = tables_of("landmarks.py", "kidnap", tmp_path)
    for row in table["rows"]:
        assert row["relocalized, %"]["value"] == 100 and row["after, s (median)"]["value"] < 60


LOST, RIGHT, FAR = (
    (True, False, False),
    (False, True, True),
    (False, False, True),
)  # lost, near, within 3 sigma
WRONG, TOO_SURE = (False, False, False), (False, True, False)


@pytest.mark.parametrize(
    "looks, expected",
    [
        ([LOST] * 5, (None, False)),
        ([WRONG] * 5, (None, False)),  # it did not notice
        ([WRONG, LOST, LOST, RIGHT], (30, False)),
        ([WRONG, LOST, FAR, TOO_SURE, RIGHT], (40, False)),
        ([LOST, RIGHT, FAR, TOO_SURE, LOST, FAR], (None, False)),
        ([LOST, RIGHT, WRONG, RIGHT], (30, True)),
        ([LOST, WRONG], (None, True)),
        ([LOST, RIGHT, FAR, FAR, FAR, WRONG], (10, False)),  # found long before
    ],
)
def test_when_a_carried_robot_is_found(looks, expected):
    """A look every 10 s, the first at once."""
    assert outcome(Check(10 * number, *look) for number, look in enumerate(looks)) == expected
