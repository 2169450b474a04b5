# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How pictures are taken together, against Bayes' rule by hand."""

import numpy as np
import pytest

from sextant.places.place_belief import BeliefParams
from sextant.places.place_modes import MODES, ImageEvidence

LINE = np.c_[np.arange(10.0), np.zeros(10)]
PARAMS = BeliefParams(
    evidence_exponent=0.5, evidence_penalty=0.0, kidnap_probability=0.01, exit_probability=0.01
)


def evidence_for(place, ratio):
    ratios = np.zeros(len(LINE))
    ratios[place] = np.log(ratio)
    return ImageEvidence(ratios, None)


def made(name, params=PARAMS, window=5):
    return MODES[name](LINE, params, window)


def test_single_believes_the_last_image_alone_and_wholly():
    mode = made("single")
    mode.update(evidence_for(2, 100.0))
    mode.update(evidence_for(7, 30.0))
    # 0.05 each place at first, 0.5 nowhere; one of them thirty times as likely
    assert mode.belief.places[7] == pytest.approx(1.5 / 2.45)
    assert mode.belief.places[2] == pytest.approx(0.05 / 2.45)
    mode.update(ImageEvidence(None, None))
    assert mode.belief.unknown == pytest.approx(0.5)


def test_a_filter_begins_without_moving():
    mode = made("filter")
    mode.update(evidence_for(4, 16.0))  # of which the root counts
    assert mode.belief.places[4] == pytest.approx(0.2 / 1.15)
    assert mode.belief.places[3] == pytest.approx(0.05 / 1.15)


def test_a_filter_doubts_only_what_has_votes():
    apart = made("filter", BeliefParams(evidence_penalty=2.0))
    apart.update(ImageEvidence(np.zeros(len(LINE)), None, is_absolute=False))
    assert apart.belief.unknown == pytest.approx(0.5)
    apart.update(ImageEvidence(np.zeros(len(LINE)), None))
    assert apart.belief.unknown > 0.7


def test_a_filter_that_sees_nothing_spreads():
    mode = made("filter")
    mode.update(evidence_for(4, 1e6))
    before = mode.belief.places[4]
    for _ in range(3):
        mode.update(ImageEvidence(None, None))
    assert mode.belief.places[4] < 0.5 * before
    assert mode.belief.places[4] == pytest.approx(mode.belief.places.max())


def test_a_filter_moves_by_odometry():
    mode = made("filter")
    mode.update(evidence_for(0, 1e9))
    mode.update(ImageEvidence(None, 4.0))
    assert mode.belief.places.argmax() == 4


def test_a_sequence_is_never_at_an_unknown_place():
    mode = made("sequence")
    for _ in range(8):
        mode.update(ImageEvidence(np.full(len(LINE), -9.0), None))
    assert mode.belief.unknown == 0
    assert mode.belief.places.sum() == pytest.approx(1)


def test_a_sequence_forgets_what_left_its_window():
    long, short = made("sequence", window=3), made("sequence", window=3)
    long.update(evidence_for(1, 1e9))
    for place in (5, 6, 7):
        for mode in (long, short):
            mode.update(evidence_for(place, 5.0))
    assert long.belief.places == pytest.approx(short.belief.places)


def test_weak_evidence_adds_up_in_a_sequence():
    single, sequence = made("single"), made("sequence", BeliefParams(evidence_exponent=1.0), 9)
    for place in range(9):
        single.update(evidence_for(place, 16.0))
        sequence.update(evidence_for(place, 16.0))
    assert single.belief.places[8] < 0.5
    assert sequence.belief.places[7:].sum() > 0.6 and sequence.belief.places.argmax() == 8
