# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
from pathlib import Path

import numpy as np
import pytest

import sextant
from sextant.simulation.room_markers import default_map, room_for

ROOM_FILE = Path(__file__).resolve().parents[3] / "config" / "room.txt"


@pytest.mark.parametrize("family", ["tag36h11", "DICT_4X4_50"])
def test_default_markers_hang_on_the_walls_and_look_inside(family):
    markers = default_map(family).markers
    assert [(marker.family, marker.id) for marker in markers] == [(family, i) for i in range(8)]
    for marker in markers:
        position, normal, up = (
            marker.T_map_marker[:3, 3],
            marker.T_map_marker[:3, 2],
            marker.T_map_marker[:3, 1],
        )
        assert marker.size == 0.2
        assert np.max(np.abs(position[:2])) == pytest.approx(3.0) and position[2] == 1.0
        assert position[:2] @ normal[:2] == pytest.approx(-3.0)  # straight away from its wall
        assert up == pytest.approx([0.0, 0.0, 1.0])


def test_default_markers_are_those_of_the_shipped_map():
    from_file = {marker.id: marker.T_map_marker for marker in sextant.read_marker_map(str(ROOM_FILE)).markers}
    for marker in default_map().markers:
        np.testing.assert_allclose(marker.T_map_marker, from_file.pop(marker.id), atol=1e-12)
    assert not from_file


def test_unknown_family_is_refused():
    with pytest.raises(ValueError, match="no_such_family"):
        default_map("no_such_family")


def test_default_room_holds_the_default_map():
    room = room_for(default_map())
    assert list(room.size) == [6.0, 6.0, 2.5] and len(room.obstacles) == 4
    assert room_for(default_map(), obstacles=False).obstacles == []
    sextant.RoomScene(room, default_map())


def test_room_grows_around_markers_of_any_map():
    marker_map = default_map()
    for i, xyz in enumerate(([10.0, 1.0, 1.0], [0.0, -20.0, 4.0], [1.0, 1.0, -0.5])):
        marker_map.add(
            sextant.MappedMarker("DICT_4X4_50", i, 0.1, sextant.pose_from_xyz_rpy(xyz, [0.0, 0.0, 0.0]))
        )
    room = room_for(marker_map)
    low = room.floor_center - 0.5 * room.size * [1.0, 1.0, 0.0]
    np.testing.assert_allclose(low, [-3.0, -20.5, -1.0])
    np.testing.assert_allclose(low + room.size, [10.5, 3.0, 4.5])
    assert room.obstacles == []
    sextant.RoomScene(room, marker_map)


def test_a_corridor_is_empty_and_grows_around_markers():
    assert list(room_for(sextant.MarkerMap(), size=[30.0, 2.4, 2.5]).size) == [30.0, 2.4, 2.5]
    room = room_for(default_map(), size=[30.0, 2.4, 2.5])
    assert list(room.size) == [30.0, 7.0, 2.5] and room.obstacles == []
