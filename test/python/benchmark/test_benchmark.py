# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The benchmarks as their caller sees them: exit status, table, JSON, pictures."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARK = Path(__file__).resolve().parents[3] / "benchmark"
sys.path.insert(0, str(BENCHMARK))

from command import divided, write_section  # noqa: E402
from real_data import EXTERNAL  # noqa: E402
from tables import Table, Value  # noqa: E402

from landmarks.landmark_kidnap import Check, outcome  # noqa: E402
from markers.chain import Run, numbered  # noqa: E402
from markers.chain_frames import PlayedDrive  # noqa: E402


def run(*arguments):
    command = [sys.executable, str(BENCHMARK / "markers.py"), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300)


@pytest.mark.slow
def test_quick_run_of_a_simulated_drive(tmp_path):
    done = run("--quick", "--only", "simulated", "--json", tmp_path / "figures.json", "--plots", tmp_path)
    assert done.returncode == 0, done.stderr
    assert "joint, seed 1" in done.stdout and "every bar holds" in done.stdout
    figures = json.loads((tmp_path / "figures.json").read_text())
    assert (figures["holds"], figures["quick"], list(figures["topics"])) == (True, True, ["simulated"])
    for table in figures["topics"]["simulated"]:
        rows = {row["name"]: row for row in table["rows"]}
        assert set(rows) == {f"{mode}, seed 1" for mode in ("nearest", "average", "joint")}
        assert 0.0 < rows["joint, seed 1"]["mean"]["value"] < 20.0  # cm
    assert (tmp_path / "simulated.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_json_alone_is_on_standard_output():
    done = run("--quick", "--only", "simulated", "--json", "-")
    assert json.loads(done.stdout)["holds"]
    assert "joint, seed 1" in done.stderr


@pytest.mark.slow
def test_absent_data_is_reported_and_is_no_success(tmp_path):
    done = run("--only", "photos", "--data", tmp_path)
    assert done.returncode == 2
    assert str(tmp_path) in done.stderr and "Traceback" not in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    "options, reason",
    [
        (["--only", "photos,nonsense"], "no topic nonsense"),
        (["--json", "/nowhere/figures.json"], "--json: there is no folder /nowhere"),
        (["--plots", "/dev/null/plots"], "--plots: /dev/null/plots: Not a directory"),
    ],
)
def test_what_cannot_be_is_refused_before_anything_is_measured(options, reason):
    done = run(*options)
    assert done.returncode == 2
    assert reason in done.stderr and "Traceback" not in done.stderr and not done.stdout


@pytest.mark.parametrize(
    "value, text, holds",
    [
        (Value(1.234), "1.23", True),
        (Value(1.0, at_most=1.0), "1.00 (<= 1)", True),
        (Value(1.01, at_most=1.0), "1.01 (<= 1) FAILS", False),
        (Value(2.0, at_least=2.5), "2.00 (>= 2.5) FAILS", False),
        (Value(float("nan"), at_most=1.0), "nan (<= 1) FAILS", False),
        (Value(float("inf"), at_least=1.0), "inf (>= 1)", True),
    ],
)
def test_a_figure_and_its_bar(value, text, holds):
    assert (str(value), value.holds, value.as_json()["holds"]) == (text, holds, holds)


def test_one_failing_bar_fails_the_table():
    good, bad = ("a", [Value(1.0, at_most=2.0)]), ("bb", [Value(3.0, at_most=2.0)])
    assert Table("title", ["figure"], [good]).holds
    table = Table("title", ["figure"], [good, bad])
    assert not table.holds
    assert str(table).splitlines() == ["title", "    figure", "a   1.00 (<= 2)", "bb  3.00 (<= 2) FAILS"]
    assert table.as_json()["rows"][1]["figure"]["holds"] is False


def tables_of(script, topic, folder):
    """Of a quick run; the topic's pictures lie in the folder."""
    command = [sys.executable, str(BENCHMARK / script), "--quick", "--only", topic, "--json", "-"]
    done = subprocess.run([*command, "--plots", str(folder)], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)["topics"][topic]


def run_trust(topic, folder):
    tables = tables_of("marker_trust.py", topic, folder)
    assert (folder / f"{topic}.png").read_bytes().startswith(b"\x89PNG")
    return tables


@pytest.mark.slow
@pytest.mark.parametrize("topic, column", [("consistency", "published"), ("head_on", "published")])
def test_quick_run_of_trust_publishes(topic, column, tmp_path):
    for table in run_trust(topic, tmp_path):
        assert min(row[column]["value"] for row in table["rows"]) >= 0.5


@pytest.mark.slow
def test_quick_run_of_a_wrong_map_entry_leaves_it_out(tmp_path):
    for table in run_trust("moved_marker", tmp_path):
        assert all(row["left out, %"]["value"] > 0 for row in table["rows"][1:])


@pytest.mark.slow
def test_quick_run_of_the_searches_finds_the_same_markers(tmp_path):
    for table in run_trust("speed", tmp_path):
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
    tables = run_trust("chain", tmp_path)
    chain, *others = tables
    assert chain["title"].startswith("Chain") and len(chain["rows"]) == 2
    for row in chain["rows"]:
        assert row["poses, %"]["value"] > 0 and row["of the library's"]["value"] > 0
    stages = {row["name"] for table in others for row in table["rows"]}
    assert "localization: localization" in stages


@pytest.mark.slow
def test_quick_run_of_the_maps(tmp_path):
    command = [sys.executable, str(BENCHMARK / "marker_maps.py"), "--quick"]
    command += ["--only", "simulated,taped,series,bags"]
    done = subprocess.run(
        [*command, "--json", "-", "--plots", str(tmp_path)], capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "simulated.png").read_bytes().startswith(b"\x89PNG")
    topics = json.loads(done.stdout)["topics"]
    assert all(row["seen, not in it"]["value"] == 0 for row in topics["simulated"][0]["rows"])
    assert topics["taped"][0]["rows"][0]["exactly the two named, % of maps"]["value"] == 100
    for row in topics["series"][0]["rows"][:8]:  # of simulated corners, whose noise is known
        assert 0.5 < row["z: least"]["value"] <= row["z: largest"]["value"] < 2.0
    assert [row["differs"]["value"] for row in topics["bags"][0]["rows"]] == [0, 0, 0]


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
def test_quick_run_of_the_cost_of_landmarks(tmp_path):
    cost, same = tables_of("landmarks.py", "cost", tmp_path)
    assert cost["rows"][-1]["of the textbook's"]["value"] < 1
    for row in same["rows"]:
        assert max(row[column]["value"] for column in row if column != "name") < 1e3  # 1e-9


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


def test_a_page_gets_one_section_of_each_script_and_keeps_topics_that_were_not_measured(tmp_path):
    page = tmp_path / "figures.md"
    page.write_text("# Figures\n\nText.\n")
    for topic, figure in [("real", 7.0), ("simulated", 1.0), ("simulated", 2.0)]:
        table = Table("Errors", ["mean, cm"], [("joint", [Value(figure, at_most=8)])])
        write_section(page, "markers", "Measures markers.\n\nMore.", ["simulated", "real"], {topic: [table]})
    table = "### Errors\n\n|  | mean, cm |\n| --- | --- |\n| joint | {} (<= 8) |\n"
    assert page.read_text() == (
        "# Figures\n\nText.\n\n<!-- begin markers -->\n## markers\n\nMeasures markers.\n\n"
        f"<!-- topic simulated -->\n\n{table.format('2.00')}\n<!-- topic real -->\n\n{table.format('7.00')}"
        "<!-- end markers -->\n"
    )


@pytest.mark.parametrize(
    "whole, damaged",
    [
        ("<!-- end a -->\n", ""),
        ("<!-- begin a -->\n", ""),
        ("<!-- begin a -->", "<!-- begin a --> "),
        ("<!-- topic x -->\n", ""),
        ("<!-- topic y -->", "<!--  topic y -->"),
        ("<!-- topic y -->", "<!-- topic x -->"),
    ],
)
def test_a_page_whose_comments_are_damaged_is_refused(tmp_path, whole, damaged):
    page = tmp_path / "figures.md"
    text = (
        "# Figures\n\n<!-- begin a -->\n## a\n\n<!-- topic x -->\n\n### X\n\n"
        "<!-- topic y -->\n\n### Y\n<!-- end a -->\n"
        "\n<!-- begin b -->\n## b\n<!-- end b -->\n"
    )
    page.write_text(text)
    assert "".join(divided(page, "a")) == text.replace("<!-- begin a -->\n", "").replace(
        "<!-- end a -->\n", ""
    )
    page.write_text(text.replace(whole, damaged))
    with pytest.raises(ValueError, match="section of a are damaged"):
        divided(page, "a")
