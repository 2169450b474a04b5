# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Options that set parameters."""

from argparse import ArgumentParser
from dataclasses import dataclass
from typing import Tuple

import pytest

from sextant.base.strict_params import StrictParams, nested, one_of, param, parse_params, within
from sextant.commands.params_options import add_params_options, given_params


@dataclass(frozen=True)
class Inner(StrictParams):
    channel_means: Tuple[float, ...] = param((0.5, 0.25), "means of [channels](page.md)")


@dataclass(frozen=True)
class Params(StrictParams):
    mode: str = param("one", "kind of `run`, 100 % sure", one_of("one", "two"))
    max_side: int = param(7, "longer side", within(0, 9), "px")
    weight: float = param(1.5, "of it")
    inner: Inner = nested(Inner)


def parser():
    made = ArgumentParser()
    add_params_options(made, Params)
    return made


def test_only_what_is_given_is_set():
    given = given_params(parser().parse_args(["--max-side", "3", "--channel-means", "1", "2.5"]), Params)
    assert given == {"max_side": 3, "channel_means": [1.0, 2.5]}
    assert parse_params(Params, given, "", "") == Params(max_side=3, inner=Inner((1.0, 2.5)))
    assert given_params(parser().parse_args([]), Params) == {}


def test_the_help_has_unit_range_and_default_without_markdown():
    text = " ".join(parser().format_help().split())
    assert "--mode NAME kind of run, 100 % sure; one, two (default: one)" in text
    assert "--max-side PX longer side; [0, 9] (default: 7)" in text
    assert "--weight NUMBER of it (default: 1.5)" in text
    assert "means of channels (default: 0.5 0.25)" in text


@pytest.mark.parametrize("arguments", [["--max-side", "3.5"], ["--weight", "much"]])
def test_a_wrong_type_is_refused(arguments, capsys):
    with pytest.raises(SystemExit):
        parser().parse_args(arguments)
    assert f"{arguments[0]}: invalid" in capsys.readouterr().err
