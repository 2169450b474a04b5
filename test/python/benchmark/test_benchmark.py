# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The benchmarks as their caller sees them: exit status, table, JSON, pictures."""

import json

import pytest
from command import divided, write_section
from quick_run import run
from tables import Table, Value


@pytest.mark.slow
def test_quick_run_of_a_simulated_drive(tmp_path):
    outputs = ["--json", tmp_path / "figures.json", "--plots", tmp_path]
    done = run("markers.py", "--quick", "--only", "simulated", *outputs)
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
    done = run("markers.py", "--quick", "--only", "simulated", "--json", "-")
    assert json.loads(done.stdout)["holds"]
    assert "joint, seed 1" in done.stderr


@pytest.mark.slow
def test_absent_data_is_reported_and_is_no_success(tmp_path):
    done = run("markers.py", "--only", "photos", "--data", tmp_path)
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
    done = run("markers.py", *options)
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
