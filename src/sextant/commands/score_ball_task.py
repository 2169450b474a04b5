# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plays the ball task in many simulated worlds and prints the success rate.

score_ball_task --worlds 200 --jobs 2 --results worlds.csv     resumes after an interruption
score_ball_task --tasks 3 --seed 17 --worlds 1                 one world
score_ball_task --hard                                         hard rooms, a poor camera, slip, delay
"""

import argparse
from pathlib import Path
from typing import List, Optional, Sequence

from sextant.base.jobs import run_jobs
from sextant.commands.command_line import Answer, CommandParser, check_output, run
from sextant.evaluation.ball_match import MatchResult
from sextant.evaluation.ball_score import (
    HARD_SEEDS,
    Match,
    append_result,
    detector_of,
    is_success,
    play_match,
    read_results,
    score_of,
)
from sextant.objects.shipped_model import shipped_model
from sextant.simulation.ball_world import TASKS


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Run the command. :returns: exit code: 0, or 2 for invalid options"""
    return run(_parser(), arguments, _score)


def _parser() -> CommandParser:
    parser = CommandParser(prog="score_ball_task", description=__doc__)
    add, default = parser.add_argument, "(default: %(default)s)"
    add("--tasks", type=int, nargs="+", choices=sorted(TASKS), default=sorted(TASKS), metavar="TASK")
    add("--worlds", type=int, default=200, metavar="N", help=f"worlds of each task {default}")
    text = f"of the first world (default: 0, with --hard {HARD_SEEDS}); further worlds count up"
    add("--seed", type=int, metavar="N", help=text)
    add("--jobs", type=int, default=1, metavar="N", help="number of parallel processes")
    add("--detector", choices=("network", "colour"), default="network")
    text = (
        "hard rooms with obstacles without a class, a poor camera, 10 %% slip, three times the depth noise, "
        "images 150 ms later, cameras turned by 2 degrees"
    )
    add("--hard", action="store_true", help=text)
    add("--model", metavar="ONNX", help="detection network (default: Sextant's own)")
    add("--results", type=Path, metavar="CSV", help="one line per world; worlds already in it are skipped")
    add("--film", type=Path, metavar="FILE", help="film of one world: a strip (.png) or an animation (.gif)")
    add("--force", action="store_true", help="overwrite the film")
    return parser


def _score(options: argparse.Namespace) -> Answer:
    if options.worlds < 1 or (options.seed or 0) < 0:
        raise ValueError("--worlds must be 1 or more, --seed 0 or more")
    wanted = _wanted(options)
    results = [_filmed(wanted, options)] if options.film else _played(wanted, options)
    failures = [_failure(each) for each in results if each.pillars or not is_success(each)]
    return Answer([*failures, *_table(results)])


def _wanted(options: argparse.Namespace) -> List[Match]:
    model = "" if options.detector == "colour" else options.model or str(shipped_model())
    detector_of(model)  # raises before anything is played
    first = (HARD_SEEDS if options.hard else 0) if options.seed is None else options.seed
    seeds = range(first, first + options.worlds)
    return [Match(task, seed, model, options.hard) for task in options.tasks for seed in seeds]


def _filmed(wanted: List[Match], options: argparse.Namespace) -> MatchResult:
    from sextant.evaluation.ball_film import BallFilm  # matplotlib takes a second to load

    if len(wanted) != 1 or options.results:
        raise ValueError("--film is of one world, without --results: give --tasks, --seed and --worlds 1")
    check_output(options.film, options.force)
    film = BallFilm(options.film)
    result = play_match(wanted[0], film.watch)
    film.write()
    return result


def _played(wanted: List[Match], options: argparse.Namespace) -> List[MatchResult]:
    if options.results and not options.results.parent.is_dir():
        raise ValueError(f"--results: there is no folder {options.results.parent}")
    known = read_results(options.results) if options.results else {}
    matches = [each for each in wanted if each[:2] not in known]
    for result in run_jobs(play_match, matches, options.jobs, progress="worlds"):
        known[result.task, result.seed] = result
        if options.results:
            append_result(options.results, result)
    return [known[each[:2]] for each in wanted]


def _failure(result: MatchResult) -> str:
    through = "through" if result.through else "not through"
    return (
        f"task {result.task}, seed {result.seed}: {result.reason}; the ball was {through}, the robot stopped "
        f"{100 * result.stop:.1f} cm before the line and touched {result.pillars} pillars"
    )


def _table(results: List[MatchResult]) -> List[str]:
    lines = ["task  worlds  success  through  no pillar touched  to the goal  stop error  kicks  speed"]
    for task in sorted({each.task for each in results}):
        score = score_of([each for each in results if each.task == task])
        shares = (
            f"{100 * score.success:5.1f} %  {100 * score.through:5.1f} %  {100 * score.untouched:15.1f} %"
        )
        rest = f"{score.goal_seconds:9.1f} s  {100 * score.stop_error:7.1f} cm  {score.kicks:5.2f}"
        lines.append(f"{task:4}  {score.worlds:6}  {shares}  {rest}  {score.speed:4.1f}x")
    return lines
