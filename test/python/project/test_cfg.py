# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What cfg/*.cfg offers is what the nodes' parameters are: their names, types, defaults and ranges."""

import importlib
import re
import sys
from pathlib import Path

import pytest
from test_doc import NODELETS, NODES_PAGE, section

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))
from parameter_tables import snake_case  # noqa: E402

CFGS = sorted(path.stem for path in (ROOT / "cfg").glob("*.cfg"))
TYPES = {"bool": bool, "int": int, "double": float, "str": str}


def offered(cfg):
    """{name: description} of the generated configuration."""
    config = importlib.import_module(f"sextant.cfg.{cfg}Config")
    return {each["name"]: each for each in config.config_description["parameters"]}


def fields_of(cfg):
    """{name: (default, what is allowed)} of the nodelet's struct."""
    struct = NODELETS[snake_case(cfg)]
    return {name: (getattr(struct(), name), allowed) for name, _, allowed, _, _ in struct.fields()}


def range_of(allowed):
    """(whether the low end belongs to it, low, high)"""
    bracket, low, high = re.fullmatch(r"([\[(])([\d.e]+), ([\d.e]+)\]", allowed).groups()
    return bracket == "[", float(low), float(high)


def test_there_is_one_for_each_nodelet_that_can():
    assert CFGS == ["MarkerDetector", "MarkerLocator"]


@pytest.mark.parametrize("cfg", CFGS)
def test_defaults_are_those_of_the_structs(cfg):
    fields, descriptions = fields_of(cfg), offered(cfg)
    assert set(descriptions) < set(fields)
    for name, description in descriptions.items():
        assert description["default"] == fields[name][0], name
        assert isinstance(fields[name][0], TYPES[description["type"]]), name


@pytest.mark.parametrize("cfg", CFGS)
def test_ranges_are_those_of_the_parameters(cfg):
    for name, description in offered(cfg).items():
        if description["type"] not in ("int", "double"):
            continue
        closed, low, high = range_of(fields_of(cfg)[name][1])
        assert description["max"] == high, name
        # Nothing is the least of what is more than 0: what is offered begins so low that nobody wants less.
        assert description["min"] == low if closed else low < description["min"] <= 1e-3 * high, name


@pytest.mark.parametrize("cfg", CFGS)
def test_words_to_choose_from_are_those_that_are_allowed(cfg):
    for name, description in offered(cfg).items():
        if description["type"] != "str":
            continue
        choices = [each["value"] for each in eval(description["edit_method"])["enum"]]
        assert sorted(choices) == sorted(fields_of(cfg)[name][1].split(", "))


@pytest.mark.parametrize("cfg", CFGS)
def test_page_states_what_may_change(cfg):
    """The sentence below the table of a node names them all, and no other."""
    text = section(NODES_PAGE, snake_case(cfg)).partition("dynamic_reconfigure")[2].partition("\n\n")[0]
    assert set(re.findall(r"`(\w+)`", text)) == set(offered(cfg))
