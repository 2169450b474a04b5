# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Distances of a robot whose way is known in closed form."""

import math

import pytest

from sextant.localization.odometry_track import MAX_AGE, MAX_POSITIONS, OdometryTrack

SECOND = 1_000_000_000


def on_a_circle(rate=10, seconds=20, radius=3.0):
    """One turn in 20 s."""
    track = OdometryTrack()
    for i in range(rate * seconds + 1):
        angle = 2 * math.pi * i / rate / 20
        track.add(SECOND + i * SECOND // rate, radius * math.cos(angle), radius * math.sin(angle))
    return track


def test_a_distance_is_the_chord_of_what_was_gone():
    track = on_a_circle()
    quarter = track.distance(SECOND, SECOND + 5 * SECOND)
    assert quarter == pytest.approx(3 * math.sqrt(2), abs=1e-9)
    assert track.distance(SECOND, SECOND + 20 * SECOND) == pytest.approx(0, abs=1e-9)


def test_between_two_messages_the_robot_goes_straight():
    track = OdometryTrack()
    track.add(0, 0.0, 0.0)
    track.add(SECOND, 4.0, 3.0)
    assert track.distance(SECOND // 5, SECOND // 2) == pytest.approx(0.3 * 5)


def test_an_image_that_is_a_little_newer_than_odometry_takes_the_last_one():
    track = OdometryTrack()
    track.add(0, 0.0, 0.0)
    track.add(SECOND, 1.0, 0.0)
    assert track.distance(0, SECOND + MAX_AGE) == 1.0
    assert track.distance(0, SECOND + MAX_AGE + 1) is None


def test_what_was_before_odometry_is_not_known():
    track = OdometryTrack()
    assert track.distance(0, SECOND) is None
    track.add(SECOND, 1.0, 1.0)
    assert track.distance(SECOND - 1, SECOND) is None
    assert track.distance(SECOND, SECOND) == 0.0


def test_a_position_that_is_no_number_is_not_known():
    track = OdometryTrack()
    for stamp, x in ((0, 0.0), (SECOND, math.nan), (2 * SECOND, 2.0), (3 * SECOND, 4.0)):
        track.add(stamp, x, 0.0)
    assert track.distance(0, SECOND) is None
    assert track.distance(2 * SECOND, 3 * SECOND) == 2.0


def test_a_clock_that_is_set_back_begins_anew():
    track = on_a_circle()
    track.add(5, 7.0, 7.0)
    assert track.distance(5, SECOND // 4) == 0.0
    assert track.distance(2 * SECOND, 3 * SECOND) is None


def test_the_oldest_are_forgotten():
    track = OdometryTrack()
    for i in range(MAX_POSITIONS + 10):
        track.add(i * 1000, float(i), 0.0)
    assert track.distance(9 * 1000, 20 * 1000) is None
    assert track.distance(10 * 1000, 20 * 1000) == pytest.approx(10)
