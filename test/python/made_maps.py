# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps for tests of their judgement: one made of a simulated drive, and ones written down by hand."""

from collections import namedtuple
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
from simulated_observations import FAMILY, SIZE, SimulatedCamera, wall_map

import sextant
from sextant.mapping.map_links import Cut
from sextant.mapping.map_quality import (
    ConflictingMarker,
    MapQuality,
    MarkerQuality,
    Unconnected,
    WrongEntry,
)

Drive = namedtuple("Drive", "made instants known")

TAPED = (0, 1, 2, 3)
WRONG, OFFSET = 2, np.array([0.0, 0.08, 0.06])  # the entry minus where it hangs, metres
WEAK, WEAK_IMAGES = 5, 3
ALONE, ABSENT = 9, 40


def key(id, family=FAMILY):
    return (family, id)


def simulated_drive():
    """Six markers on a wall: 2 is taped wrong, 5 hardly seen with the others, 9 only alone, 40 not at all."""
    wall = wall_map([(3.0, y, 1.0 + 0.2 * (i % 2), np.pi) for i, y in enumerate(np.linspace(-1.5, 1.0, 6))])
    alone = sextant.MappedMarker(FAMILY, ALONE, SIZE, wall.find(FAMILY, 0).T_map_marker)
    camera = SimulatedCamera("plumb_bob 4", sigma=0.3, seed=3)
    instants, often = [], 0
    for i, turn in enumerate(np.linspace(0.0, 2 * np.pi, 60)):
        T = sextant.pose_from_xyz_rpy(
            [0.5 * np.cos(turn), np.sin(turn), 0.0], [0.0, 0.0, 0.2 * np.cos(2 * turn)]
        )
        visible = camera.visible(T, wall)
        shown = (
            [alone] if i % 15 == 0 else [each for each in visible if each.id != WEAK or often < WEAK_IMAGES]
        )
        often += WEAK in [each.id for each in shown]
        instants.append(sextant.RecordedInstant([camera.view(T, shown)]))
    known = taped(wall)
    made = sextant.make_marker_map(instants, sextant.MarkerSizes(), known, sextant.MappingParams())
    return Drive(made, instants, known)


def taped(wall):
    """MarkerMap of what was measured by hand."""
    covariance = np.diag([0.005**2] * 3 + [0.01**2] * 3)
    known = sextant.MarkerMap()
    for id in TAPED:
        T = wall.find(FAMILY, id).T_map_marker.copy()
        T[:3, 3] += OFFSET if id == WRONG else 0.0
        known.add(sextant.MappedMarker(FAMILY, id, SIZE, T, "", covariance))
    far = sextant.pose_from_xyz_rpy([-5.0, 0.0, 1.0], [np.pi / 2, 0.0, np.pi / 2])
    known.add(sextant.MappedMarker(FAMILY, ABSENT, SIZE, far, "", covariance))
    return known


def marker_quality(id, **changes):
    plain = MarkerQuality(
        key=key(id),
        known=False,
        is_anchor=False,
        observations=50,
        used_rms=np.full(50, 0.2),
        left_out_rms=np.zeros(0),
        position_sigma=0.002,
        rotation_sigma=0.001,
        neighbours=(),
        images=40,
    )
    return replace(plain, **changes)


def map_of(markers, **changes):
    """MapQuality without a fault but for the changes."""
    plain = MapQuality(markers, {}, [], [], [], [], [], [], [], [], False)
    return replace(plain, **changes)


def faulty_quality():
    """A map with every kind of finding."""
    at, away = np.array([1.0, 0.0, 1.0]), np.array([4.0, 0.0, 1.0])
    markers = [
        marker_quality(0, known=True, is_anchor=True, images=None),
        *(marker_quality(id) for id in range(1, 10)),
        marker_quality(10, left_out_rms=np.full(30, 4.0)),
        marker_quality(11, position_sigma=0.08),
        marker_quality(12, known=True, observations=0, used_rms=np.zeros(0), images=0),
    ]
    return map_of(
        markers,
        links={(key(0), key(1)): 40, (key(1), key(9)): 3},
        weak=[Cut(frozenset([key(9)]), 3, ((key(9), key(1)),))],
        wrong=[WrongEntry(key(i), at, np.array([0.1, 0.0, -0.02]), 0.02) for i in (2, 3, 4)],
        doubtful=[WrongEntry(key(8), at, np.array([0.0, 0.03, 0.04]), 0.0)],
        swapped=[(key(3), key(4))],
        conflicting=[
            ConflictingMarker(key(5), at, away, 12, (key(0), key(1))),
            ConflictingMarker(key(6), at, away, 9, (key(7),)),
            ConflictingMarker(key(7), at, away, 9, (key(6),)),
        ],
        inconsistent=[key(20)],
        ambiguous=[key(21)],
        unconnected=[Unconnected(frozenset([key(22), key(23)]), 0)],
    )


def made_of(quality, spacing=1.0):
    """What plots and tables need of a MappingResult: the markers of a quality in a row along a wall."""
    made_map = sextant.MarkerMap()
    for i, each in enumerate(quality.markers):
        T = sextant.pose_from_xyz_rpy([i * spacing, 0.0, 1.0], [np.pi / 2, 0.0, 0.0])
        covariance = np.diag([each.position_sigma**2] * 3 + [each.rotation_sigma**2] * 3)
        made_map.add(sextant.MappedMarker(*each.key, SIZE, T, "", covariance))
    path = [sextant.pose_from_xyz_rpy([x, -2.0, 0.0], [0.0, 0.0, 0.0]) for x in np.linspace(0.0, 3.0, 20)]
    return SimpleNamespace(
        map=made_map,
        T_map_base=[None, *path],
        noise_scales=[1.5],
        lens_errors=[2.25],
        correlated_images=2.0,
        known_position_scale=3.0,
        known_rotation_scale=1.0,
    )
