# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Scores of many worlds, and the file that remembers them."""

import math

import numpy as np
import pytest

from sextant.commands.score_ball_task import main
from sextant.evaluation.ball_match import MatchResult
from sextant.evaluation.ball_score import append_result, is_success, read_results, score_of

GOOD = MatchResult(2, 0, True, 0.21, 0, 0, 20.0, 15.0, 1, "done", 10.0)
LATE = GOOD._replace(seed=1, stop=0.24, goal_seconds=25.0, seconds=40.0, kicks=2)
TOUCHED = GOOD._replace(seed=2, pillars=1, stop=0.2, goal_seconds=18.0)
MISSED = GOOD._replace(seed=3, through=False, goal_seconds=math.nan, reason="no way, at all", kicks=4)
FAR = GOOD._replace(seed=4, stop=0.26)


def test_success_is_the_ball_through_and_the_robot_where_it_should_be():
    assert [is_success(each) for each in (GOOD, LATE, TOUCHED, MISSED, FAR)] == [
        True,
        True,
        True,
        False,
        False,
    ]


def test_a_score_of_four():
    score = score_of([GOOD, LATE, TOUCHED, MISSED])
    assert (score.worlds, score.success, score.through, score.untouched) == (4, 0.75, 0.75, 0.75)
    assert score.goal_seconds == 18.0 and score.kicks == 2.0
    assert score.stop_error == pytest.approx(math.sqrt((0.01**2 + 0.04**2) / 3.0))
    assert score.speed == pytest.approx(100.0 / 40.0)


def test_a_score_of_failures_alone_has_no_time():
    score = score_of([MISSED])
    assert score.success == 0.0 and np.isnan(score.goal_seconds) and np.isnan(score.stop_error)


def test_what_was_played_is_read_again(tmp_path):
    path = tmp_path / "worlds.csv"
    assert read_results(path) == {}
    for each in (GOOD, MISSED):
        append_result(path, each)
    known = read_results(path)
    assert known[2, 0] == GOOD
    assert known[2, 3]._replace(goal_seconds=0.0) == MISSED._replace(goal_seconds=0.0)


@pytest.mark.parametrize(
    "change, reason",
    [
        (lambda text: text.replace("task", "Task", 1), r"worlds.csv:1: the columns must be task,seed"),
        (lambda text: text.rsplit(",", 1)[0], r"worlds.csv:2: 10 columns, there must be 11"),
        (lambda text: text.replace("0.21", "far"), r"worlds.csv:2: could not convert .*'far'"),
    ],
)
def test_a_damaged_file_is_refused(tmp_path, change, reason):
    path = tmp_path / "worlds.csv"
    append_result(path, GOOD)
    path.write_text(change(path.read_text()))
    with pytest.raises(ValueError, match=reason):
        read_results(path)


def test_worlds_that_were_played_are_not_played_again(tmp_path, capsys):
    path = tmp_path / "worlds.csv"
    for seed in range(4):
        append_result(path, (GOOD, LATE, TOUCHED, MISSED)[seed])
    arguments = ["--tasks", "2", "--worlds", "4", "--detector", "colour", "--results", str(path)]
    assert main(arguments) == 0
    lines = capsys.readouterr().out.splitlines()
    assert (
        lines[0].startswith("task 2, seed 2: done; the ball was through") and "touched 1 pillars" in lines[0]
    )
    assert "not through" in lines[1] and "no way, at all" in lines[1]
    assert lines[3].split()[:4] == ["2", "4", "75.0", "%"]


def test_hard_worlds_have_seeds_of_their_own(tmp_path, capsys):
    path = tmp_path / "worlds.csv"
    append_result(path, TOUCHED)  # of a usual world
    append_result(path, GOOD._replace(seed=100_000))
    arguments = ["--tasks", "2", "--worlds", "1", "--detector", "colour", "--results", str(path)]
    assert main([*arguments, "--hard"]) == 0
    (_, line) = capsys.readouterr().out.splitlines()
    assert line.split()[:4] == ["2", "1", "100.0", "%"]
    assert main([*arguments, "--hard", "--seed", "100000"]) == 0
    assert capsys.readouterr().out.splitlines()[1] == line


@pytest.mark.parametrize(
    "arguments, reason",
    [
        (["--worlds", "0"], "--worlds must be 1 or more"),
        (["--film", "film.png"], "--film is of one world"),
        (["--model", "nowhere.onnx"], "nowhere.onnx: No such file"),
        (["--tasks", "4"], "argument --tasks: invalid choice"),
    ],
)
def test_what_cannot_be_is_refused(arguments, reason, capsys):
    detector = [] if "--model" in arguments else ["--detector", "colour"]
    assert main([*arguments, *detector]) == 2
    assert reason in capsys.readouterr().err
