# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The filter over places, against Bayes' rule by hand and walks whose truth is known."""

import numpy as np
import pytest

from sextant.places import place_belief
from sextant.places.place_belief import BeliefParams, PlaceBelief

LINE = np.c_[np.arange(20.0), np.zeros(20)]
WHOLLY = BeliefParams(reach=3.0, trust=1.0, doubt=0.0, leave=0.02)  # as if pictures erred independently


def saying(place, strength=3.0, count=20):
    ratios = np.zeros(count)
    ratios[place] = strength
    return ratios


def test_a_picture_weighs_by_bayes_rule():
    belief = PlaceBelief(LINE, WHOLLY)
    belief.see(saying(7, np.log(5.0)))
    # prior: 0.5 nowhere, 0.025 each place; one of them five times as likely
    total = 0.5 + 0.025 * 19 + 0.125
    assert belief.places[7] == pytest.approx(0.125 / total)
    assert belief.places[3] == pytest.approx(0.025 / total)
    assert belief.nowhere == pytest.approx(0.5 / total)


def test_what_is_impossible_stays_so_whatever_a_picture_says():
    belief = PlaceBelief(LINE, BeliefParams(nowhere=0.0, leave=0.0, restart=0.0, trust=1.0, doubt=0.0))
    belief.see(saying(2, 2000.0))
    belief.move()
    before = belief.places
    belief.see(saying(18, 2000.0))  # out of reach
    assert belief.places == pytest.approx(before)


def test_a_picture_counts_by_the_part_that_is_trusted():
    half, whole = PlaceBelief(LINE, BeliefParams(trust=0.5, doubt=0.0)), PlaceBelief(LINE, WHOLLY)
    half.see(saying(7, 4.0))
    whole.see(saying(7, 2.0))
    assert half.places == pytest.approx(whole.places)


def test_doubt_makes_every_place_less_likely():
    doubting = PlaceBelief(LINE, BeliefParams(trust=1.0, doubt=2.0))
    doubting.see(saying(7, 2.0 + np.log(5.0)))
    assert doubting.places[7] / doubting.nowhere == pytest.approx(5.0 * 0.025 / 0.5)
    assert doubting.places[3] / doubting.nowhere == pytest.approx(np.exp(-2.0) * 0.025 / 0.5)


def test_what_only_tells_places_apart_casts_no_doubt():
    belief = PlaceBelief(LINE, BeliefParams(doubt=2.0))
    belief.see(np.zeros(20), voted=False)
    assert belief.nowhere == pytest.approx(0.5) and belief.places == pytest.approx(np.full(20, 0.025))
    belief.see(saying(7, np.log(5.0) / 0.6), voted=False)  # of which 0.6 are trusted
    assert belief.places[7] / belief.nowhere == pytest.approx(5.0 * 0.025 / 0.5)


def test_places_around_the_likeliest_are_one_answer():
    belief = PlaceBelief(LINE, BeliefParams(trust=1.0, doubt=0.0, radius=1.0))
    ratios = np.full(20, -50.0)
    ratios[[5, 6, 7, 12]] = np.log([40.0, 80.0, 40.0, 20.0])
    belief.see(ratios)  # each place was at 0.025, nowhere at 0.5
    best, second = belief.hypotheses(2)
    assert (best.place, best.around.tolist()) == (6, [5, 6, 7])
    assert best.probability == pytest.approx(4.0 / 5.0) and second.probability == pytest.approx(0.5 / 5.0)
    assert second.place == 12 and belief.nowhere == pytest.approx(0.5 / 5.0)


def test_without_nowhere_a_place_is_always_told():
    belief = PlaceBelief(LINE, BeliefParams(nowhere=0.0, leave=0.0))
    for _ in range(30):
        belief.move()
        belief.see(np.full(20, -9.0) + saying(3, 1.0))
    assert belief.nowhere == 0 and belief.places.sum() == pytest.approx(1)
    assert belief.hypotheses(1)[0].place == 3


@pytest.mark.parametrize("distance", [None, 0.0, 1.0, 30.0])
def test_probabilities_sum_to_one(distance):
    belief = PlaceBelief(LINE, WHOLLY)
    rng = np.random.default_rng(1)
    for _ in range(20):
        belief.move(distance)
        belief.see(rng.normal(0, 5, 20))
        assert belief.places.sum() + belief.nowhere == pytest.approx(1)
        assert np.all(belief.places >= 0) and belief.nowhere >= 0


def test_a_sequence_decides_what_a_picture_cannot():
    belief = PlaceBelief(LINE, WHOLLY)
    for place in range(3, 12):
        both = saying(place)
        both[(place * 7) % 20] = 3.0  # a place that looks alike, another one every time
        belief.move()
        belief.see(both)
    assert belief.places.argmax() == 11 and belief.places[10:13].sum() > 0.8


def test_odometry_moves_it_as_far_as_it_says():
    sure = BeliefParams(restart=0.0, leave=0.0, trust=1.0, doubt=0.0)
    belief = PlaceBelief(LINE, sure)
    belief.see(saying(10, 30.0))
    belief.move(4.0)
    assert belief.places[[6, 14]] == pytest.approx([0.5, 0.5], abs=0.2)
    assert belief.places[10] < 1e-3
    belief.move(0.0)
    assert belief.places[10] < 1e-2


def test_a_leap_that_no_memory_holds_leads_anywhere(monkeypatch):
    belief = PlaceBelief(LINE, BeliefParams(restart=0.0, leave=0.0, nowhere=0.0, trust=1.0, doubt=0.0))
    belief.see(saying(10, 30.0))
    monkeypatch.setattr(place_belief, "PAIRS", 150)  # of 400
    belief.move(1.0)
    assert belief.places[8:13].sum() > 0.9
    belief.move(8.0)
    assert belief.places == pytest.approx(np.full(20, 0.05))


def test_without_odometry_it_spreads_to_neighbours():
    belief = PlaceBelief(LINE, BeliefParams(reach=3.0, restart=0.0, leave=0.0, trust=1.0, doubt=0.0))
    belief.see(saying(10, 30.0))
    belief.move()
    assert belief.places[8:13].sum() > 0.9 and belief.places[10] == belief.places.max()


def test_a_robot_that_was_carried_away_is_found_again():
    belief = PlaceBelief(LINE, WHOLLY)
    for _ in range(5):
        belief.move()
        belief.see(saying(2))
    assert belief.places[1:4].sum() > 0.8
    pictures = 0
    while belief.places[15:18].sum() < 0.5:
        belief.move()
        belief.see(saying(16))
        pictures += 1
        assert pictures < 10
    assert pictures >= 2  # not by one


def test_pictures_of_nowhere_make_it_say_nowhere():
    belief = PlaceBelief(LINE, WHOLLY)
    for _ in range(5):
        belief.move()
        belief.see(saying(2))
    for _ in range(10):
        belief.move()
        belief.see(np.full(20, -2.0))
    assert belief.nowhere > 0.95


def test_a_map_of_one_place_works():
    belief = PlaceBelief(np.zeros((1, 2)), WHOLLY)
    belief.move(3.0)
    belief.see(np.array([4.0]))
    assert belief.places[0] > 0.9


def test_photos_at_one_spot_do_not_make_the_spacing_zero():
    assert PlaceBelief(np.array([[0, 0], [0, 0], [2, 0], [4, 0]])).spacing == 2.0


@pytest.mark.parametrize(
    "changed, reason",
    [
        ({"reach": 0.5}, r"reach: must be within \[1, 20\], is 0.5"),
        ({"restart": float("nan")}, "restart: must be within .*, is nan"),
        ({"restart": 0.7, "leave": 0.4}, r"restart \+ leave: must be at most 1, is 1.1"),
        ({"nowhere": 0.0}, "leave: must be 0 where nowhere is 0"),
    ],
)
def test_parameters_out_of_range_are_refused(changed, reason):
    with pytest.raises(ValueError, match=reason):
        PlaceBelief(LINE, BeliefParams(**changed))
