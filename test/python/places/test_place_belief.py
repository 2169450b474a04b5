# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""PlaceBelief against Bayes' rule by hand and walks with known places."""

import numpy as np
import pytest

from sextant.places import place_motion
from sextant.places.place_belief import BeliefParams, PlaceBelief

LINE = np.c_[np.arange(20.0), np.zeros(20)]
INDEPENDENT = BeliefParams(
    reach=3.0, evidence_exponent=1.0, evidence_penalty=0.0, exit_probability=0.02
)  # as if pictures erred independently


def evidence_for(place, strength=3.0, count=20):
    ratios = np.zeros(count)
    ratios[place] = strength
    return ratios


def test_an_image_weighs_by_bayes_rule():
    belief = PlaceBelief(LINE, INDEPENDENT)
    belief.update(evidence_for(7, np.log(5.0)))
    # prior: 0.5 nowhere, 0.025 each place; one of them five times as likely
    total = 0.5 + 0.025 * 19 + 0.125
    assert belief.places[7] == pytest.approx(0.125 / total)
    assert belief.places[3] == pytest.approx(0.025 / total)
    assert belief.unknown == pytest.approx(0.5 / total)


def test_what_is_impossible_stays_so_whatever_the_evidence():
    belief = PlaceBelief(
        LINE,
        BeliefParams(
            unknown_prior=0.0,
            exit_probability=0.0,
            kidnap_probability=0.0,
            evidence_exponent=1.0,
            evidence_penalty=0.0,
        ),
    )
    belief.update(evidence_for(2, 2000.0))
    belief.predict()
    before = belief.places
    belief.update(evidence_for(18, 2000.0))  # out of reach
    assert belief.places == pytest.approx(before)


def test_an_image_counts_with_its_exponent():
    half, whole = (
        PlaceBelief(LINE, BeliefParams(evidence_exponent=0.5, evidence_penalty=0.0)),
        PlaceBelief(LINE, INDEPENDENT),
    )
    half.update(evidence_for(7, 4.0))
    whole.update(evidence_for(7, 2.0))
    assert half.places == pytest.approx(whole.places)


def test_the_penalty_makes_every_place_less_likely():
    penalized = PlaceBelief(LINE, BeliefParams(evidence_exponent=1.0, evidence_penalty=2.0))
    penalized.update(evidence_for(7, 2.0 + np.log(5.0)))
    assert penalized.places[7] / penalized.unknown == pytest.approx(5.0 * 0.025 / 0.5)
    assert penalized.places[3] / penalized.unknown == pytest.approx(np.exp(-2.0) * 0.025 / 0.5)


def test_relative_evidence_has_no_penalty():
    belief = PlaceBelief(LINE, BeliefParams(evidence_exponent=0.6, evidence_penalty=2.0))
    belief.update(np.zeros(20), is_absolute=False)
    assert belief.unknown == pytest.approx(0.5) and belief.places == pytest.approx(np.full(20, 0.025))
    belief.update(evidence_for(7, np.log(5.0) / 0.6), is_absolute=False)  # of which 0.6 are trusted
    assert belief.places[7] / belief.unknown == pytest.approx(5.0 * 0.025 / 0.5)


def test_places_around_the_likeliest_are_one_answer():
    params = BeliefParams(evidence_exponent=1.0, evidence_penalty=0.0, confidence=1.0, radius=1.0)
    belief = PlaceBelief(LINE, params)
    ratios = np.full(20, -50.0)
    ratios[[5, 6, 7, 12]] = np.log([40.0, 80.0, 40.0, 20.0])
    belief.update(ratios)  # each place was at 0.025, nowhere at 0.5
    best, second = belief.hypotheses(2).peaks
    assert (best.place, best.around.tolist()) == (6, [5, 6, 7])
    assert best.probability == pytest.approx(4.0 / 5.0) and second.probability == pytest.approx(0.5 / 5.0)
    assert second.place == 12 and belief.unknown == pytest.approx(0.5 / 5.0)


def test_without_an_unknown_prior_a_place_is_always_found():
    belief = PlaceBelief(LINE, BeliefParams(unknown_prior=0.0, exit_probability=0.0))
    for _ in range(30):
        belief.predict()
        belief.update(np.full(20, -9.0) + evidence_for(3, 1.0))
    assert belief.unknown == 0 and belief.places.sum() == pytest.approx(1)
    assert belief.hypotheses(1).peaks[0].place == 3


@pytest.mark.parametrize("distance", [None, 0.0, 1.0, 30.0])
def test_probabilities_sum_to_one(distance):
    belief = PlaceBelief(LINE, INDEPENDENT)
    rng = np.random.default_rng(1)
    for _ in range(20):
        belief.predict(distance)
        belief.update(rng.normal(0, 5, 20))
        assert belief.places.sum() + belief.unknown == pytest.approx(1)
        assert np.all(belief.places >= 0) and belief.unknown >= 0


@pytest.mark.parametrize("evidence, unknown", [(6.0, False), (-9.0, True)])
def test_published_odds_are_flattened(evidence, unknown):
    belief = PlaceBelief(LINE, BeliefParams(evidence_exponent=1.0, confidence=0.25))
    ratios = np.full(20, min(evidence, 0.0))
    ratios[12] = evidence
    belief.update(ratios)
    raw = belief.unknown if unknown else belief.places[11:15].sum()
    peaks, published_unknown = belief.hypotheses(3)
    published = published_unknown if unknown else peaks[0].probability
    assert 0.5 < published < raw and unknown == (published_unknown > 0.5)
    if unknown:
        assert published / (1 - published) == pytest.approx((raw / (1 - raw)) ** 0.25)
    ratio = peaks[1].probability / peaks[2].probability
    assert ratio == pytest.approx(1, abs=0.5)  # the others share the rest as before
    assert sum(peak.probability for peak in peaks) + published_unknown <= 1 + 1e-9


def test_improbable_hypotheses_are_not_raised():
    belief = PlaceBelief(LINE, BeliefParams(unknown_prior=0.0, exit_probability=0.0, confidence=0.1))
    belief.update(evidence_for(7, 1.0))
    assert belief.hypotheses(1).peaks[0].probability < 0.5


def test_a_sequence_decides_what_an_image_cannot():
    belief = PlaceBelief(LINE, INDEPENDENT)
    for place in range(3, 12):
        both = evidence_for(place)
        both[(place * 7) % 20] = 3.0  # a place that looks alike, another one every time
        belief.predict()
        belief.update(both)
    assert belief.places.argmax() == 11 and belief.places[10:13].sum() > 0.8


def test_odometry_moves_the_belief_by_its_distance():
    sure = BeliefParams(
        kidnap_probability=0.0, exit_probability=0.0, evidence_exponent=1.0, evidence_penalty=0.0
    )
    belief = PlaceBelief(LINE, sure)
    belief.update(evidence_for(10, 30.0))
    belief.predict(4.0)
    assert [belief.places[5:8].sum(), belief.places[13:16].sum()] == pytest.approx([0.5, 0.5], abs=0.15)
    assert belief.places[10] < 1e-3
    belief.predict(0.0)
    assert belief.places[10] < 1e-2


def test_a_leap_that_no_memory_holds_leads_anywhere(monkeypatch):
    belief = PlaceBelief(
        LINE,
        BeliefParams(
            kidnap_probability=0.0,
            exit_probability=0.0,
            unknown_prior=0.0,
            evidence_exponent=1.0,
            evidence_penalty=0.0,
        ),
    )
    belief.update(evidence_for(10, 30.0))
    monkeypatch.setattr(place_motion, "MAX_ENTRIES", 700)  # of 3200 in all layers
    belief.predict(1.0)
    assert belief.places[8:13].sum() > 0.9
    belief.predict(8.0)
    assert belief.places == pytest.approx(np.full(20, 0.05))


def test_pictures_that_are_turned_at_one_spot_decide_together():
    """Each of them shows what two places have in common; only one place is common to all."""
    belief = PlaceBelief(LINE, INDEPENDENT)
    belief.update(evidence_for([10, 3], 4.0))
    assert belief.places[9:12].sum() < 0.6
    for other in (15, 18):
        belief.predict(0.0)
        belief.update(evidence_for([10, other], 4.0))
    assert belief.places.argmax() == 10 and belief.places[9:12].sum() > 0.9


def test_without_odometry_it_spreads_to_neighbours():
    belief = PlaceBelief(
        LINE,
        BeliefParams(
            reach=3.0,
            kidnap_probability=0.0,
            exit_probability=0.0,
            evidence_exponent=1.0,
            evidence_penalty=0.0,
        ),
    )
    belief.update(evidence_for(10, 30.0))
    belief.predict()
    assert belief.places[8:13].sum() > 0.85 and belief.places[10] == belief.places.max()


def test_poor_images_do_not_lose_the_place():
    """After images that match nothing, the robot is probably still near its place, if it is in the map."""
    belief = PlaceBelief(LINE, INDEPENDENT)
    for _ in range(4):
        belief.predict()
        belief.update(evidence_for(10, 20.0))
    for _ in range(5):
        belief.predict()
        belief.update(np.full(20, -3.0))
    assert belief.unknown > 0.9
    inside = belief.places / belief.places.sum()
    assert inside[8:13].sum() > 0.35 and inside.argmax() == 10  # 0.25: anywhere


def test_a_robot_that_was_carried_away_is_found_again():
    belief = PlaceBelief(LINE, INDEPENDENT)
    for _ in range(5):
        belief.predict()
        belief.update(evidence_for(2))
    assert belief.places[1:4].sum() > 0.8
    pictures = 0
    while belief.places[15:18].sum() < 0.5:
        belief.predict()
        belief.update(evidence_for(16))
        pictures += 1
        assert pictures < 10
    assert pictures >= 2  # not by one


def test_images_of_unknown_places_raise_the_unknown_probability():
    belief = PlaceBelief(LINE, INDEPENDENT)
    for _ in range(5):
        belief.predict()
        belief.update(evidence_for(2))
    for _ in range(10):
        belief.predict()
        belief.update(np.full(20, -2.0))
    assert belief.unknown > 0.95


def test_a_map_of_one_place_works():
    belief = PlaceBelief(np.zeros((1, 2)), INDEPENDENT)
    belief.predict(3.0)
    belief.update(np.array([4.0]))
    assert belief.places[0] > 0.9


def test_photos_at_one_spot_do_not_make_the_spacing_zero():
    assert PlaceBelief(np.array([[0, 0], [0, 0], [2, 0], [4, 0]])).spacing == 2.0


@pytest.mark.parametrize(
    "changed, reason",
    [
        ({"reach": 0.5}, r"reach: must be within \[1, 20\], is 0.5"),
        ({"kidnap_probability": float("nan")}, "kidnap_probability: must be within .*, is nan"),
        (
            {"kidnap_probability": 0.7, "exit_probability": 0.4},
            r"kidnap_probability \+ exit_probability: must be at most 1, is 1.1",
        ),
        ({"unknown_prior": 0.0}, "exit_probability: must be 0 where unknown_prior is 0"),
    ],
)
def test_parameters_out_of_range_are_refused(changed, reason):
    with pytest.raises(ValueError, match=reason):
        PlaceBelief(LINE, BeliefParams(**changed))
