# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Ranges and choices of figures that are written by hand, tables and heat maps of them."""

import csv

import cv2
import numpy as np
import pytest
from designs import ERRORS, SETUP, made_results

from sextant.evaluation.marker_design import Setup, Target
from sextant.evaluation.marker_design_plots import plot_conditions, plot_setup
from sextant.evaluation.marker_design_report import (
    COLUMNS,
    answer,
    choices,
    describe,
    range_table,
    write_table,
)

NOISY = SETUP._replace(noise=8.0)


def test_ranges_end_before_the_first_distance_that_is_not_good():
    lines = range_table(made_results(), SETUP, describe(SETUP, 500.0), Target(0.02, 2.0))
    assert lines == [
        "640 x 480, f = 500 px, tag36h11, noise 4, light 200; worst of 0, 45 degrees",
        "          markers           95 % of the poses within 2 cm up to",
        "size      detected up to    one in view     two in view     CPU per image",
        "0.1   m   2 m (25 px)       1 m             2 m             30 ms",
        "0.2   m   4 m (25 px)       2 m             4 m             30 ms",
    ]


def test_the_smallest_size_is_chosen_for_each_number_in_view():
    def text(error, distance):
        target = Target(error, distance)
        ((key, chosen),) = choices(made_results(), target).items()
        return answer(chosen, key, "camera.yaml", target).partition(": ")[2]

    assert text(0.02, 1.0) == "markers of 0.1 m, one in view; markers of 0.1 m, two in view"
    assert text(0.02, 2.0) == "markers of 0.2 m, one in view; markers of 0.1 m, two in view"
    assert text(0.02, 4.0) == "markers of 0.2 m, two in view; with one in view no size of this sweep"
    assert text(0.001, 4.0) == "with one or two in view no size of this sweep"


def test_a_choice_holds_under_all_conditions():
    noisy = made_results(NOISY, factor=2.0)  # 2.4 cm with two markers of 0.1 m at 2 m
    chosen = choices(made_results() + noisy, Target(0.02, 2.0))
    assert [choice.size for choice in chosen[SETUP[:2]]] == [None, 0.2]


def test_markers_that_do_not_fit_into_the_image_are_no_choice():
    ((_, chosen),) = choices(made_results(), Target(1.0, 0.5)).items()
    assert [choice.size for choice in chosen] == [0.1, None]


def test_table_has_every_combination(tmp_path):
    results = made_results()
    write_table(tmp_path / "design.csv", results)
    heading, *rows = csv.reader((tmp_path / "design.csv").read_text().splitlines())
    assert heading == list(COLUMNS) and len(rows) == len(results)
    values = [dict(zip(heading, row)) for row in rows]
    (row,) = (
        each
        for each in values
        if (each["size, m"], each["in view"], each["distance, m"], each["angle, degrees"])
        == ("0.1", "2", "2.0", "45.0")
    )
    assert float(row["95 % position error, m"]) == ERRORS[0.1, 2][2.0]
    assert (row["CPU, ms"], row["markers detected, %"], row["size, px"]) == ("30", "100", "25")
    unseen = [each for each in values if each["images"] == "0"]
    assert len(unseen) == 4 and {each["95 % position error, m"] for each in unseen} == {""}


def colours(path):
    """Number of pixels of every colour of a picture, RGB."""
    image = cv2.cvtColor(cv2.imread(str(path)), cv2.COLOR_BGR2RGB)
    found, counts = np.unique(image.reshape(-1, 3), axis=0, return_counts=True)
    return {tuple(colour): count for colour, count in zip(found.tolist(), counts)}


NONE = (0x44, 0x44, 0x44)


@pytest.mark.slow
def test_heat_maps_show_fields_without_a_pose(tmp_path):
    plot_setup(tmp_path / "good.png", made_results(), SETUP, "title", Target(0.02, 2.0))
    plot_setup(tmp_path / "none.png", made_results(factor=np.inf), SETUP, "title", Target(0.02, 2.0))
    assert colours(tmp_path / "good.png").get(NONE, 0) < 1000 < colours(tmp_path / "none.png")[NONE]


@pytest.mark.slow
def test_heat_map_of_the_conditions_has_the_worst_of_the_angles(tmp_path):
    results = made_results() + made_results(NOISY, factor=np.inf)
    plot_conditions(tmp_path / "conditions.png", results, "title", Target(0.02, 2.0))
    shown = colours(tmp_path / "conditions.png")
    fields = [count for count in shown.values() if count > 2000]
    assert shown[NONE] > 2000 and len(fields) >= 4  # white, grey, and the colours of the errors


def test_setups_are_described():
    assert describe(Setup((640, 480), "tag16h5", 2.5, 60.0), 512.3) == (
        "640 x 480, f = 512 px, tag16h5, noise 2.5, light 60"
    )
