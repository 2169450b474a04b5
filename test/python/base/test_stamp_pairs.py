# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import genpy
from std_msgs.msg import Header

from sextant.nodes.base.stamp_pairs import MAX_WAIT, StampPairs


class Stamped:
    def __init__(self, seconds):
        self.header, self.seconds = Header(stamp=genpy.Time.from_sec(seconds)), seconds


def of(pairs):
    return [(each.first.seconds, each.second.seconds) for each in pairs]


def test_the_nearest_is_taken_whichever_comes_first():
    pairs = StampPairs(0.05)
    for seconds in (1.0, 1.1, 1.2):
        assert pairs.add_second(Stamped(seconds)) == []
    assert of(pairs.add_first(Stamped(1.09))) == [(1.09, 1.1)]
    assert of(pairs.add_first(Stamped(1.21))) == []  # a nearer one may come
    assert of(pairs.add_first(Stamped(1.29))) == []
    assert of(pairs.add_second(Stamped(1.3))) == [(1.21, 1.2), (1.29, 1.3)]
    assert pairs.unmatched == 0


def test_what_is_too_far_off_stays_alone():
    pairs = StampPairs(0.05)
    pairs.add_second(Stamped(1.0))
    pairs.add_second(Stamped(2.0))
    assert pairs.add_first(Stamped(1.5)) == []
    assert pairs.unmatched == 1


def test_without_the_other_topic_not_all_is_kept():
    pairs = StampPairs(0.05)
    for i in range(50):
        pairs.add_first(Stamped(1.0 + 0.1 * i))
    assert pairs.unmatched == 50 - (1e-9 * MAX_WAIT / 0.1 + 1)


def test_however_fast_the_other_topic_comes_a_late_message_finds_it():
    pairs = StampPairs(0.01)
    for i in range(150):  # 90 Hz
        assert pairs.add_second(Stamped(1.0 + i / 90.0)) == []
    assert of(pairs.add_first(Stamped(1.0))) == [(1.0, 1.0)]


def test_a_clock_that_is_set_back_begins_anew():
    pairs = StampPairs(0.05)
    pairs.add_second(Stamped(100.0))
    pairs.add_first(Stamped(101.0))
    pairs.add_first(Stamped(1.0))
    assert pairs.add_second(Stamped(1.0)) == []
    pairs.add_first(Stamped(1.1))
    assert of(pairs.add_second(Stamped(1.1))) == [(1.1, 1.1)]
