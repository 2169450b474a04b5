# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Images of the building: detectors find in them what is in it, where a pinhole camera shows it."""

import numpy as np
import pytest

import sextant
from sextant.buildings.building_looks import GAINS, PILLAR_HEIGHT, PILLAR_RADIUS, BuildingLooks
from sextant.buildings.building_maps import true_marker_map
from sextant.buildings.building_view import BuildingCamera, building_view, visible_walls
from sextant.geometry.plane_poses import composed
from sextant.simulation.building import FAMILY, LENGTH, LOWER, UPPER, Building

BUILDING, CAMERA = Building(), BuildingCamera()
EXACT = CAMERA._replace(noise=0.0)


@pytest.fixture(scope="module")
def days():
    return [BuildingLooks(BUILDING, day=day) for day in (0, 1)]


def in_front_of(marker, distance, aside=0.0, turn=0.0):
    """Pose of a robot that faces a marker."""
    ahead = np.array([distance, aside, np.pi + turn])
    return composed(marker.pose, ahead)


def pixels(points, pose):
    """Of points (n, 3) in the map, by the camera model."""
    camera, T_camera_map = sextant.CameraModel(CAMERA.calibration()), np.linalg.inv(CAMERA.pose(pose))
    return np.array([camera.project(T_camera_map[:3, :3] @ point + T_camera_map[:3, 3]) for point in points])


@pytest.mark.parametrize("marker", BUILDING.markers, ids=lambda marker: str(marker.id))
@pytest.mark.parametrize("distance, aside, turn", [(1.5, 0.2, 0.1), (1.5, -0.5, -0.3)])
def test_markers_are_detected_where_they_are(days, marker, distance, aside, turn):
    pose = in_front_of(marker, distance, aside, turn)
    image = building_view(BUILDING, days[1], CAMERA, pose, 1)
    found = {each.id: each for each in sextant.MarkerDetector(sextant.DetectorParams()).detect(image)}
    mapped = true_marker_map(BUILDING).find(FAMILY, marker.id)
    corners = sextant.marker_corners(mapped.size) @ mapped.T_map_marker[:3, :3].T + mapped.T_map_marker[:3, 3]
    np.testing.assert_allclose(found[marker.id].corners, pixels(corners, pose), atol=0.5)


def test_the_detected_markers_localize_the_camera(days):
    pose = in_front_of(BUILDING.markers[0], 4.0, 0.3, 0.05)
    image = building_view(BUILDING, days[1], CAMERA, pose, 1)
    found = sextant.MarkerDetector(sextant.DetectorParams()).detect(image)
    camera = sextant.CameraModel(CAMERA.calibration())
    view = sextant.MarkerView(camera, CAMERA.T_base_camera, found)
    located = sextant.MarkerLocator().locate(true_marker_map(BUILDING), [view]).pose.T_map_base
    np.testing.assert_allclose(located[:2, 3], pose[:2], atol=0.05)


def test_a_column_shows_the_nearest_wall(days):
    """In the lower corridor: its side walls, to the left with openings, and its far end in the middle."""
    view = EXACT.view(np.array([5.0, LOWER, 0.0]))
    owners, depths = visible_walls(days[0], view)
    tangent = (np.arange(view.width) - view.centre[0]) / view.f
    assert owners.min() >= 0
    assert depths[[319, 320]] == pytest.approx(LENGTH - view.x)
    assert (depths * -tangent)[:100] == pytest.approx(1.0)
    inside, beyond = (
        np.column_stack([view.x + depth, LOWER - depth * tangent]) for depth in (depths - 0.01, depths + 0.01)
    )
    assert BUILDING.is_inside(inside).all()
    assert BUILDING.is_inside(beyond).mean() < 0.01  # beside the edge of a door


def test_a_pillar_is_seen_where_it_is_and_not_behind_a_wall(days):
    pillar = BUILDING.pillars[0]
    seen = np.array([pillar[0] - 1.5, LOWER, np.arctan2(pillar[1] - LOWER, 1.5)])
    behind = np.array([pillar[0], UPPER, -0.5 * np.pi])  # in the other corridor
    assert BUILDING.is_inside(behind[:2]) and not shown(days[0], 0, behind).any()
    rows, columns = np.nonzero(shown(days[0], 0, seen))
    middle = 0.5 * PILLAR_HEIGHT
    (centre,) = pixels([[*pillar, middle]], seen)
    width = 2 * PILLAR_RADIUS * CAMERA.view(seen).f / np.hypot(*(pillar - CAMERA.pose(seen)[:2, 3]))
    assert columns.mean() == pytest.approx(centre[0], abs=2.0)
    assert np.ptp(columns) + 1 == pytest.approx(width, abs=3.0)
    assert rows.min() < centre[1] < rows.max()


def shown(looks, index, pose):
    """Pixels that a pillar changes."""
    without = Building()
    without.pillars = np.delete(without.pillars, index, axis=0)
    without.classes = without.classes[:index] + without.classes[index + 1 :]
    other = BuildingLooks(without)
    images = [building_view(*each, EXACT, pose, 1) for each in ((BUILDING, looks), (without, other))]
    return np.abs(np.subtract(*images, dtype=int)) > 10


def test_corridors_look_alike_but_for_some_posters(days):
    pose = np.array([3.0, LOWER, 0.0])
    here, there = (building_view(BUILDING, days[0], EXACT, each, 1) for each in (pose, BUILDING.twin(pose)))
    assert 0.02 < np.mean(np.abs(np.subtract(here, there, dtype=int)) > 40) < 0.3


def test_a_day_changes_light_and_posters(days):
    same = BuildingLooks(BUILDING, day=0)
    assert all(np.array_equal(one.grey, other.grey) for one, other in zip(days[0].panels, same.panels))
    pairs = [(one.grey.ravel(), other.grey.ravel()) for one, other in zip(days[0].panels, days[1].panels)]
    alike = np.array([np.corrcoef(*pair)[0, 1] for pair in pairs])
    assert 0.02 < np.mean(alike < 0.95) < 0.25
    levels = [np.mean([each.grey.mean() for each in looks.panels]) for looks in days]
    assert levels[0] / levels[1] == pytest.approx(GAINS[0] / GAINS[1], rel=0.05)
