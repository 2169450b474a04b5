# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""evaluate_places as its user calls for it: what it prints, writes and refuses, and its page."""

import csv
import json
import re
import subprocess
import sys
from pathlib import Path

import cv2
import pytest
from made_network import pooling_network
from made_photos import picture, shifted, written_photos

from sextant.commands.places.evaluate_places import main

ROOT = Path(__file__).resolve().parents[3]
PAGE = (ROOT / "doc/how_to/place_accuracy.md").read_text()


@pytest.fixture(scope="module")
def park(tmp_path_factory):
    """Six places; autumn.txt has them a bit aside, and one far off; truth.csv has some of autumn's photos."""
    folder = tmp_path_factory.mktemp("park")
    written_photos(folder, 6)
    (folder / "autumn").mkdir()
    lines = ["park.png;1000;100"]
    for i in (*range(6), 40):
        cv2.imwrite(str(folder / f"autumn/{i}.png"), shifted(picture(i), 4, 2, seed=i))
        lines.append(f"{i};autumn/{i}.png;{10 * i + 1};50")
    (folder / "autumn.txt").write_text("\n".join(lines) + "\n")
    header = lines[0].replace("1000", "900")
    (folder / "other.txt").write_text("\n".join([header, *lines[1:]]) + "\n")
    (folder / "truth.csv").write_text("query,right_refs\n2.png,2.png\n3.png,2.png 4.png\n40.png,\n")
    (folder / "lost.csv").write_text("query,right_refs\n2.png,2.png\nlost.png,2.png\n")
    (folder / "broken.csv").write_text("query,right_refs\nbroken.png,2.png\n")
    (folder / "autumn/broken.png").write_bytes((folder / "autumn/1.png").read_bytes()[:5000])
    (folder / "there.json").write_text("{}")
    (folder / "empty.txt").write_text(lines[0] + "\n")
    (folder / "empty.csv").write_text("query,right_refs\n")
    pooling_network(folder / "net.onnx", channels=1)
    return folder


@pytest.fixture
def in_park(park, monkeypatch):
    monkeypatch.chdir(park)
    return park


def printed(capsys, *arguments):
    assert main([str(each) for each in arguments]) == 0, capsys.readouterr().err
    return capsys.readouterr().out.splitlines()


@pytest.mark.slow
def test_photos_of_another_map(in_park, tmp_path, capsys):
    lines = printed(
        capsys, "park.txt", "--queries", "autumn.txt", "--mode", "single", "--tolerance", "1",
        "--json", tmp_path / "figures.json", "--plots", tmp_path / "plots",
    )  # fmt: skip
    assert lines[0] == "park.txt, mode single: 7 queries, 1 of them not in the map"
    assert lines[1].startswith("recall @1 1.000, @5 1.000, @10 1.000; area under precision-recall 1.000")
    assert lines[3].endswith("reported for 0.0% of the queries in the map, and for 100.0% of the others")
    assert lines[4].startswith("position error: median ") and " px, 90 % below" in lines[4]
    names = [
        f"plots/{name}.png" for name in ("precision_recall", "predictors", "distributions", "reliability")
    ]
    assert lines[-5:] == [str(tmp_path / name) for name in ("figures.json", *names)]
    for picture_file in lines[-4:]:
        assert cv2.imread(picture_file).shape[1] > 600
    written = json.loads((tmp_path / "figures.json").read_text())
    assert (written["figures"]["recall@1"], written["figures"]["mode"]) == (1.0, "single")
    assert [each["rank"] for each in written["queries"]] == [1, 1, 1, 1, 1, 1, None]
    assert written["queries"][6]["status"] == "UNKNOWN_PLACE" and not written["queries"][6]["is_in_map"]
    assert written["queries"][2]["hypotheses"][0][0] == "2.png"


def test_a_table_of_right_photos(in_park, capsys):
    lines = printed(capsys, "park.txt", "--truth", "truth.csv", "--folder", "autumn", "--mode", "single")
    assert lines[0] == "park.txt, mode single: 3 queries, 1 of them not in the map"
    assert lines[1].startswith("recall @1 0.500")  # 3.png is not the 2.png or the 4.png that the table wants
    assert not any(line.startswith("position error") for line in lines)


@pytest.mark.slow
def test_photos_that_are_left_out(in_park, capsys):
    lines = printed(capsys, "park.txt", "--leave-one-out", "--tolerance", "5")
    assert lines[0] == "park.txt, mode single: 6 queries, 6 of them not in the map"
    assert lines[1].startswith("recall @1 -, @5 -, @10 -; area under precision-recall -")


@pytest.mark.slow
def test_votes_of_plain_features(in_park, capsys):
    arguments = ["--mode", "votes", "--profile", "plain", "--matcher", "FlannBased"]
    lines = printed(capsys, "park.txt", "--queries", "autumn.txt", *arguments)
    assert lines[0].startswith("park.txt, mode votes: 7 queries") and "built in" in lines[-1]


@pytest.mark.slow
def test_a_comparison_has_table_plots_pictures_and_page(in_park, tmp_path, capsys):
    outputs = ["--table", tmp_path / "a.csv", tmp_path / "a.md", "--per-picture", tmp_path / "pictures.csv"]
    outputs += ["--plots", tmp_path / "plots", "--page", tmp_path / "a.html"]
    lines = printed(
        capsys, "park.txt", "--queries", "autumn.txt", "--compare", "orb,default", "--clusters", "2",
        "--tolerance", "1", "--distances", "15", "0.5", "--min-matches", "3", *outputs,
    )  # fmt: skip
    assert lines[0] == "park.txt:"
    names = ["orb", "orb, 2 clusters", "default", "default, 2 clusters"]
    for line, name in zip(lines[3:7], names):
        assert line.startswith(name)
    with open(tmp_path / "a.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["method"] for row in rows] == names
    for row in rows[::2]:
        shares = [
            row[f"{photos} ≤ {distance} px, %"] for photos in ("map", "new") for distance in ("0.5", "15")
        ]
        assert shares == ["100.0", "100.0", "0.0", "100.0"] and row["right cluster, %"] == "100.0"
    with open(tmp_path / "pictures.csv", newline="") as file:
        pictures = list(csv.DictReader(file))
    assert len(pictures) == 4 * 7
    assert [row["right"] for row in pictures[:7]] == ["1"] * 6 + ["0"]  # the last is not in the map
    assert {row["best_error_px"] for row in pictures[:6]} == {"1"}
    page = (tmp_path / "a.html").read_text()
    assert page.count("data:image/png;base64") == 7 == len(list((tmp_path / "plots").iterdir()))


@pytest.mark.slow
def test_thresholds_are_those_of_the_node(in_park, tmp_path, capsys):
    """Fewer and fewer keypoints."""
    counts = []
    for number in ("60", "120"):
        path = tmp_path / f"{number}.csv"
        printed(
            capsys, "park.txt", "--truth", "truth.csv", "--folder", "autumn", "--mode", "single",
            "--max-features", number, "--per-picture", path,
        )  # fmt: skip
        with open(path, newline="") as file:
            counts.append({row["keypoints"] for row in csv.DictReader(file)})
    assert counts == [{"60"}, {"120"}]


GREY = ["--network", "net.onnx", "--network-channels", "grey", "--network-mean", "0.5", "--network-std", "1"]


@pytest.mark.slow
def test_a_network_takes_part_as_much_as_it_is_weighted(in_park, tmp_path, capsys):
    """Out of focus, where keypoints are of little use."""
    lines = ["query,right_refs"]
    for i in range(6):
        cv2.imwrite(str(tmp_path / f"{i}.png"), cv2.GaussianBlur(picture(i), (0, 0), 25))
        lines.append(f"{i}.png,{i}.png")
    (tmp_path / "blurred.csv").write_text("\n".join(lines) + "\n")
    recalls = []
    for weight in ("0", "5"):
        printed(
            capsys, "park.txt", "--truth", tmp_path / "blurred.csv", "--mode", "single", *GREY,
            "--network-weight", weight, "--json", tmp_path / f"{weight}.json",
        )  # fmt: skip
        recalls.append(json.loads((tmp_path / f"{weight}.json").read_text())["figures"]["recall@1"])
    assert recalls[0] < 0.9 and recalls[1] == 1.0


@pytest.mark.slow
def test_orb_of_four_points_has_a_matcher_of_its_own(in_park, capsys):
    orb = ["--mode", "votes", "--detector", "ORB", "--extractor", "ORB", "--orb-wta-k", "4", "--matcher"]
    assert printed(capsys, "park.txt", "--queries", "autumn.txt", *orb, "BruteForce-Hamming(2)")
    assert main(["park.txt", "--queries", "autumn.txt", *orb, "BruteForce-Hamming"]) == 2


REFUSED = {
    "no truth": (["park.txt"], "one of the arguments"),
    "two truths": (["park.txt", "--leave-one-out", "--truth", "truth.csv"], "not allowed with"),
    "no such map": (["none.txt", "--leave-one-out"], "none.txt: No such file"),
    "another overview": (["park.txt", "--queries", "other.txt"], "another overview"),
    "a query that is not there": (
        ["park.txt", "--truth", "lost.csv", "--folder", "autumn"],
        "autumn/lost.png: there is no such query",
    ),
    "a query that is not an image": (
        ["park.txt", "--truth", "broken.csv", "--folder", "autumn"],
        "autumn/broken.png: the image is damaged",
    ),
    "a folder of nothing": (["park.txt", "--leave-one-out", "--folder", "autumn"], "--folder needs"),
    "a tolerance of a table": (["park.txt", "--truth", "truth.csv", "--tolerance", "1"], "cannot be used"),
    "a tolerance": (["park.txt", "--leave-one-out", "--tolerance", "-1"], "--tolerance: is -1, it must"),
    "a mode that carries on": (["park.txt", "--leave-one-out", "--mode", "filter"], "mode is 'filter'"),
    "an unknown mode": (["park.txt", "--leave-one-out", "--mode", "best"], "mode: must be one of filter"),
    "a matcher of bits": (
        ["park.txt", "--leave-one-out", "--mode", "votes", "--matcher", "BruteForce-Hamming"],
        "matcher is",
    ),
    "figures that are there": (["park.txt", "--leave-one-out", "--json", "there.json"], "--force"),
    "a network that is not there": (["park.txt", "--leave-one-out", "--network", "no.onnx"], "no.onnx"),
    "colours for a grey network": (
        ["park.txt", "--leave-one-out", "--network", "net.onnx"],
        "takes 1 channels; RGB is 3",
    ),
    "a weight": (["park.txt", "--leave-one-out", *GREY, "--network-weight", "-1"], "network_weight: must be"),
    "points of ORB": (
        ["park.txt", "--leave-one-out", "--orb-wta-k", "5"],
        "orb_wta_k: must be within [2, 4]",
    ),
    "a threshold": (["park.txt", "--leave-one-out", "--surf-threshold", "0"], "surf_threshold: must be"),
    "a side of no number": (["park.txt", "--leave-one-out", "--max-side", "big"], "--max-side: invalid int"),
    "no query": (["park.txt", "--queries", "empty.txt"], "empty.txt: there is no query"),
    "no query in a table": (["park.txt", "--truth", "empty.csv"], "empty.csv: there is no query"),
    "an unknown method": (
        ["park.txt", "--leave-one-out", "--compare", "sift,surff"],
        "'surff' is not a method to compare; known are surf, sift, orb, akaze, default",
    ),
    "features of a method": (
        ["park.txt", "--leave-one-out", "--compare", "sift", "--detector", "ORB"],
        "detector cannot be set: the compared method 'sift' has its own",
    ),
    "more clusters than places": (["park.txt", "--leave-one-out", "--clusters", "7"], "into 7 clusters"),
    "a table of one method": (["park.txt", "--leave-one-out", "--table", "a.csv"], "--table needs --compare"),
    "distances for one method": (
        ["park.txt", "--leave-one-out", "--distances", "5"],
        "--distances needs --compare",
    ),
    "figures of a comparison": (
        ["park.txt", "--leave-one-out", "--compare", "sift", "--json", "a.json"],
        "--json is of one method",
    ),
    "a workbook": (
        ["park.txt", "--leave-one-out", "--compare", "sift", "--table", "a.xlsx"],
        "a.xlsx: the ending must be one of .csv, .md, .txt",
    ),
    "pictures in no folder": (
        ["park.txt", "--leave-one-out", "--per-picture", "nowhere/a.csv"],
        "there is no folder nowhere",
    ),
    "pictures that are there": (["park.txt", "--leave-one-out", "--per-picture", "truth.csv"], "--force"),
    "no job": (["park.txt", "--leave-one-out", "--profile", "plain", "--jobs", "0"], "jobs is 0"),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_is_refused_in_one_line(case, in_park, capsys):
    arguments, reason = REFUSED[case]
    assert main(arguments) == 2
    captured = capsys.readouterr()
    *progress, line = captured.err.splitlines()
    assert captured.out == "" and line.startswith("evaluate_places: ") and reason in line
    assert all("describing" in each or "other parameters" in each for each in progress)
    assert (in_park / "there.json").read_text() == "{}"


def test_a_write_protected_folder_is_named_before_anything_is_computed(in_park, capsys, monkeypatch):
    monkeypatch.setattr("os.access", lambda path, mode: False)
    assert main(["park.txt", "--leave-one-out", "--per-picture", "a.csv"]) == 2
    assert capsys.readouterr().err == "evaluate_places: a.csv: the folder . is write-protected\n"


@pytest.mark.slow
def test_the_executable(park):
    command = [sys.executable, str(ROOT / "scripts/evaluate_places"), "park.txt", "--queries", "autumn.txt"]
    done = subprocess.run(command, cwd=park, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and "mode filter: 7 queries" in done.stdout, done.stderr


def test_options_are_those_of_the_page(capsys):
    with pytest.raises(SystemExit):
        main(["--help"])
    options = set(re.findall(r"^  .*?(--[a-z-]+)", capsys.readouterr().out, re.M)) - {"--help"}
    assert set(re.findall(r"(--[a-z][a-z-]+)", PAGE)) == options
