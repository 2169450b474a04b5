# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
from made_maps import faulty_quality, key, map_of, marker_quality

from sextant.base.findings import NAMED
from sextant.mapping.map_findings import findings, list_findings, names, verdict
from sextant.mapping.map_links import Cut
from sextant.mapping.map_quality import Unconnected


def only(**changes):
    (line,) = findings(map_of([marker_quality(id) for id in range(4)], **changes))
    return line


def test_a_faultless_map():
    assert findings(map_of([marker_quality(1)])) == []
    assert verdict(map_of([marker_quality(1)])) == "1 marker mapped; no problem found"


def test_verdict_counts_markers_not_findings():
    named = {each for finding in list_findings(faulty_quality()) for each in finding.keys}
    assert (
        verdict(faulty_quality())
        == f"13 markers mapped, 4 seen but not mapped; check {len(named)} markers named below"
    )
    assert verdict(map_of([marker_quality(1)], inconsistent=[key(2)])).endswith("check 1 marker named below")


@pytest.mark.parametrize(
    "start",
    [
        "3 and 4 are swapped, each is at the known position of the other: ",
        "2 had a wrong entry, off by 10.2 cm (+10.0, +0.0, -2.0 along x, y, z) and 1.1 degrees",
        "8 may have a wrong entry, off by 5.0 cm (+0.0, +3.0, +4.0 along x, y, z) and 0.0 degrees",
        "20 is not in the map (moved during the recording, or printed twice): ",
        "6 and 7 cannot both be where the map has them (9 images with both contradict it): ",
        "5 is seen elsewhere (12 images with 0 and 1 show it 3.00 m from its position, at 4.00, 0.00, 1.00 m",
        "10 does not fit its pose (30 of its 80 observations were left out): ",
        "22 and 23 are not in the map (never seen together with its markers): ",
        "21 is not in the map (two poses explain its observations, or none explains enough of them): ",
        "9 is connected to the rest only by 3 images with 1: drive slowly past 1 and 9 again",
        "11 is uncertain (8.0 cm and 0.1 degrees, standard deviation): ",
        "12 was never seen, its entry is unchanged: ",
    ],
)
def test_every_kind_has_its_sentence(start):
    assert len([line for line in findings(faulty_quality()) if line.startswith(start)]) == 1


def test_no_finding_is_repeated():
    lines = findings(faulty_quality())
    assert len(lines) == 12 == len(set(lines))


def test_a_group_behind_a_weak_link():
    cut = Cut(frozenset([key(2), key(3)]), 3, ((key(2), key(1)),))
    assert only(weak=[cut]).startswith(
        "2 and 3 are connected to the rest only by 3 images of 1 with 2: drive"
    )
    assert "of 1 with 2 and by odometry: drive" in only(weak=[cut], odometry=True)


def test_a_group_that_no_image_connects():
    cut = Cut(frozenset([key(3)]), 0, ())
    assert only(weak=[cut]).startswith("3 is connected to the rest by no image, only by the floor: ")
    assert "no image, only by odometry: " in only(weak=[cut], odometry=True)


def test_images_with_the_map_that_could_not_be_used():
    group = Unconnected(frozenset([key(8)]), 2)
    assert only(unconnected=[group]).startswith(
        "8 is not in the map (only 2 images with markers of the map, and none"
    )


def test_a_marker_without_usable_observations():
    marker = marker_quality(5, used_rms=np.zeros(0), observations=1)
    (line,) = findings(map_of([marker]))
    assert "none of its 1 observation could" in line


def test_many_names():
    quality = map_of([])
    assert names(quality, [key(2)]) == "2"
    assert names(quality, [key(2), key(1)]) == "1 and 2"
    assert names(quality, map(key, range(NAMED))) == "0, 1, 2, 3, 4, 5, 6 and 7"
    assert names(quality, map(key, range(20))) == "0, 1, 2, 3, 4, 5, 6 and 13 more"
