# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
from collections import Counter
from types import SimpleNamespace

import numpy as np
import pytest
from made_maps import (
    ABSENT,
    ALONE,
    FAMILY,
    OFFSET,
    TAPED,
    WEAK,
    WEAK_IMAGES,
    WRONG,
    key,
    map_of,
    marker_quality,
    simulated_drive,
)

import sextant
from sextant.mapping.map_quality import Unconnected, map_quality, swapped_pairs

# Of a MappingResult.
TAKEN = ("map", "residuals", "conflicting_poses", "inconsistent", "ambiguous", "unconnected")


@pytest.fixture(scope="module")
def drive():
    return simulated_drive()


@pytest.fixture(scope="module")
def quality(drive):
    return map_quality(*drive)


def shown_ids(drive):
    """Ids by instant; there is one camera."""
    return [[each.id for each in instant.views[0].detections] for instant in drive.instants]


def by_id(quality):
    return {marker.key[1]: marker for marker in quality.markers}


def test_observations_are_counted(drive, quality):
    shown = Counter(id for ids in shown_ids(drive) for id in ids)
    for id, marker in by_id(quality).items():
        assert marker.observations == shown[id]
        assert marker.used_rms.size + marker.left_out_rms.size <= shown[id]
    assert by_id(quality)[0].used_rms.size > 10


def test_residuals_are_those_of_the_corners_noise(quality):
    for id in TAPED:
        assert 0.15 < by_id(quality)[id].rms < 0.45  # both coordinates of a corner have 0.3 px
        assert by_id(quality)[id].worst >= by_id(quality)[id].rms


def test_deviations_are_those_of_the_worst_axis(drive, quality):
    for marker in drive.made.map.markers:
        judged = by_id(quality)[marker.id]
        sigmas = np.sqrt(np.diag(marker.covariance))
        assert max(sigmas[:3]) <= judged.position_sigma <= np.linalg.norm(sigmas[:3])
        assert max(sigmas[3:]) <= judged.rotation_sigma <= np.linalg.norm(sigmas[3:])


def test_which_markers_define_the_frame(quality):
    markers = by_id(quality)
    assert {id for id in markers if markers[id].known} == {*TAPED, ABSENT}
    assert {id for id in markers if markers[id].is_anchor} == set(TAPED) - {WRONG}
    assert [markers[0].images, markers[ABSENT].images] == [None, None]


def test_the_wrong_entry(quality):
    (wrong,) = quality.wrong
    assert wrong.key == key(WRONG)
    assert wrong.offset == pytest.approx(-OFFSET, abs=0.01)
    assert wrong.rotation < 0.05
    assert quality.swapped == quality.conflicting == quality.doubtful == []


def test_an_entry_that_is_far_off_but_not_certainly_wrong(drive):
    check = dict(family=FAMILY, offset=np.array([0.0, 0.03, 0.04, 0.0, 0.0, 0.1]), wrong=False)
    checks = [
        SimpleNamespace(id=id, squared_distance=squared, **check) for id, squared in enumerate((12, 14, 16))
    ]
    made = SimpleNamespace(**{name: getattr(drive.made, name) for name in TAKEN}, known=checks)
    quality = map_quality(made, *drive[1:])
    assert quality.wrong == []
    assert [each.key for each in quality.doubtful] == [key(2), key(1)]
    assert quality.doubtful[0].rotation == pytest.approx(0.1)


def test_the_weak_link(quality):
    assert by_id(quality)[WEAK].images == WEAK_IMAGES
    (weak,) = (cut for cut in quality.weak if key(WEAK) in cut.markers)
    assert (weak.markers, weak.images) == ({key(WEAK)}, WEAK_IMAGES)
    assert {id for _, id in by_id(quality)[WEAK].neighbours} == {b[1] for _, b in weak.links}


def test_links_are_of_images_that_show_both(drive, quality):
    both = sum({0, 1} <= set(ids) for ids in shown_ids(drive))
    assert 0 < quality.links[key(0), key(1)] <= both
    assert all(key(ALONE) not in pair for pair in quality.links)


def test_what_is_not_connected_is_named(quality):
    assert quality.unconnected == [Unconnected(frozenset([key(ALONE)]), 0)]
    assert quality.unmapped == [key(ALONE)]
    assert not quality.odometry


def test_without_known_markers_one_defines_the_frame(drive):
    # The same drive; only the known markers differ.
    quality = map_quality(drive.made, drive.instants, sextant.MarkerMap())
    assert not any(marker.known for marker in quality.markers)
    assert quality.wrong == []


def test_swapped_markers():
    a, b, c = np.array([0.0, 0, 0]), np.array([2.0, 0, 0]), np.array([9.0, 0, 0])
    near = np.array([0.05, -0.05, 0.1])  # they are taped, not surveyed
    assert swapped_pairs({key(1): (a, b + near), key(2): (b, a - near)}) == [(key(1), key(2))]
    assert swapped_pairs({key(1): (a, b), key(2): (b, c)}) == []
    assert swapped_pairs({key(1): (a, a + near), key(2): (b, b + near)}) == []
    assert swapped_pairs({}) == []


def test_a_marker_of_which_many_observations_are_left_out_does_not_fit():
    def fits(used, left_out, observations=99):
        marker = marker_quality(
            1, used_rms=np.ones(used), left_out_rms=np.ones(left_out), observations=observations
        )
        return not marker.does_not_fit

    assert fits(50, 0) and fits(50, 12) and fits(3, 4) and fits(0, 0, observations=0)
    assert not fits(50, 13) and not fits(0, 1) and not fits(0, 0)


def test_no_residual_is_no_number():
    marker = marker_quality(1, used_rms=np.zeros(0))
    assert np.isnan(marker.rms) and np.isnan(marker.worst)
    assert marker_quality(1, used_rms=np.array([3.0, 4.0])).rms == pytest.approx(np.sqrt(12.5))


def test_families_are_named_where_there_are_several():
    one = map_of([marker_quality(1)])
    assert (one.name(key(1)), one.name(("tag25h9", 1))) == ("1", "tag25h9/1")
    assert map_of([marker_quality(1)], inconsistent=[("tag25h9", 7)]).name(key(1)) == "tag36h11/1"
