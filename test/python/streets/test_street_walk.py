# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A walk whose way is known, and the maps that are made of it."""

from itertools import islice

import cv2
import numpy as np
import pytest

from sextant.place_maps.place_map_file import read_place_map
from sextant.streets.street import LENGTH, WIDTH, Street
from sextant.streets.street_conditions import CONDITIONS
from sextant.streets.street_map import CLUSTERS, MAP, StreetMap, has_street_map, write_street_map
from sextant.streets.street_overview import LOW, aerial_image
from sextant.streets.street_view import street_view
from sextant.streets.street_walk import StreetWalk, WalkParams

SIZE = (64, 48)


@pytest.fixture(scope="module")
def street():
    return Street(1, CONDITIONS["summer"])


def walk(**changed):
    return StreetWalk(WalkParams(**{"width": SIZE[0], "height": SIZE[1], "seasons": ["summer"], **changed}))


def frames(walk_, count):
    return [walk_.frame() for _ in range(count)]


@pytest.fixture(scope="module")
def straight():
    """Twenty frames along the first side of the block, without swaying."""
    return frames(walk(sway=0.0, speed=2.0, rate=4.0, seed=1), 20)


@pytest.mark.slow
def test_the_walker_goes_at_its_speed(straight):
    times = [frame.time for frame in straight]
    assert np.diff(times) == pytest.approx(0.25)
    xy = np.array([(frame.truth.x, frame.truth.y) for frame in straight])
    assert np.linalg.norm(np.diff(xy, axis=0), axis=1) == pytest.approx(
        0.5, rel=0.02
    )  # chords of round corners


def test_odometry_is_the_distance_walked(straight):
    """By 2 % of the root of every metre."""
    gone = np.hypot(straight[-1].odometry.motion.x, straight[-1].odometry.motion.y)
    true = np.hypot(straight[-1].truth.x - straight[0].truth.x, straight[-1].truth.y - straight[0].truth.y)
    assert gone == pytest.approx(true, abs=4 * 0.02 * np.sqrt(10))
    assert straight[0].odometry.motion.pose == pytest.approx(np.eye(4))


@pytest.mark.slow
def test_the_picture_is_that_of_the_truth(street, straight):
    motion = straight[7].truth
    expected = street_view(street, [motion.x, motion.y, motion.yaw], SIZE, seed=99)
    assert np.mean(np.abs(expected.astype(int) - straight[7].image)) < 3 * street.conditions.noise


@pytest.mark.slow
def test_a_swaying_walker_looks_where_it_goes():
    swaying = frames(walk(sway=1.0, speed=0.5, rate=10.0), 60)
    xy = np.array([(frame.truth.x, frame.truth.y) for frame in swaying])
    along = np.diff(xy, axis=0)
    yaw = np.array([frame.truth.yaw for frame in swaying[:-1]])
    off = np.angle(np.exp(1j * (np.arctan2(along[:, 1], along[:, 0]) - yaw)))
    assert np.abs(off).max() < 0.03


@pytest.mark.slow
def test_every_round_has_its_season(street):
    seasons = ["summer", "evening"]
    fast = walk(seasons=seasons, speed=10.0, rate=0.2)  # 50 m a frame
    shown = [frame.conditions for frame in islice(iter(fast.frame, None), 12)]
    length = street.length
    assert shown == [seasons[int(50 * i / length) % 2] for i in range(12)]


@pytest.mark.slow
def test_a_carried_walker_is_elsewhere_but_not_for_its_wheels(street):
    walker = walk(speed=2.0, rate=2.0)
    before = frames(walker, 3)[-1]
    distance = walker.carry()
    after = walker.frame()
    assert 0.25 * street.length <= distance <= 0.75 * street.length
    assert np.hypot(after.truth.x - before.truth.x, after.truth.y - before.truth.y) > 20
    wheels = np.hypot(
        after.odometry.motion.x - before.odometry.motion.x, after.odometry.motion.y - before.odometry.motion.y
    )
    assert wheels == pytest.approx(1.0, abs=0.2)


@pytest.mark.parametrize(
    "changed, reason",
    [
        ({"seasons": ["spring"]}, "seasons: each must be one of summer, evening, .*, snow, is"),
        ({"seasons": []}, "seasons: must not be empty"),
        ({"speed": 0.0}, r"speed: must be within \[0.01, 20.0\], is 0.0"),
    ],
)
def test_parameters_out_of_range_are_refused(changed, reason):
    with pytest.raises(ValueError, match=reason):
        walk(**changed)


@pytest.fixture(scope="module")
def street_map(tmp_path_factory):
    """What was wanted, and the map that was made."""
    wanted = StreetMap(1, ["summer", "evening"], 40.0, SIZE, 3)
    return wanted, write_street_map(tmp_path_factory.mktemp("maps") / "street", wanted)


@pytest.mark.slow
def test_a_map_has_a_photo_of_every_place_in_every_season(street_map):
    _, path = street_map
    exact, parts = read_place_map(path), read_place_map(path.parent / CLUSTERS)
    assert path.name == MAP and len(exact.photos) == 18 and len(exact.places()) == 9
    assert [len(place) for place in exact.places()] == [2] * 9
    assert len(parts.places()) == 3
    frame, overview = exact.georeference, exact.overview
    street = Street(1, CONDITIONS["evening"])
    for photo in exact.photos[9:]:
        number = photo.id - 9
        x, y, yaw = street.pose(number * street.length / 9)
        assert frame.position(overview, photo.x, photo.y) == pytest.approx((x, y), abs=frame.resolution)
        assert np.angle(np.exp(1j * (frame.yaw(photo.yaw) - yaw))) == pytest.approx(0, abs=1e-3)
        image = cv2.imread(str(exact.path(photo)), cv2.IMREAD_GRAYSCALE)
        expected = street_view(street, [x, y, yaw], SIZE, 7)
        assert np.mean(np.abs(image.astype(int) - expected)) < 15
    assert cv2.imread(str(path.parent / overview.image)).shape[:2] == (overview.height, overview.width)


def test_a_map_of_another_street_is_not_taken_for_it(street_map):
    wanted, path = street_map
    folder = path.parent
    assert has_street_map(folder, wanted) and not has_street_map(folder / "elsewhere", wanted)
    others = {"seed": 2, "conditions": ["summer"], "spacing": 41.0, "size": (48, 64), "parts": 4}
    assert set(others) == set(wanted._fields)
    for name, value in others.items():
        with pytest.raises(ValueError, match=r'map.txt: is of {"seed": 1.*, expected {.*remove the folder'):
            has_street_map(folder, wanted._replace(**{name: value}))
    (folder / "street.json").unlink()
    with pytest.raises(ValueError, match="map.txt: is of an unknown street, expected"):
        has_street_map(folder, wanted)


@pytest.mark.slow
def test_a_map_of_nothing_is_not_written(tmp_path):
    with pytest.raises(ValueError, match="9 places cannot be divided into 10 clusters"):
        write_street_map(tmp_path, StreetMap(1, ["summer"], 40.0, SIZE, 10))
    assert list(tmp_path.iterdir()) == []


def test_the_aerial_picture_shows_houses_where_they_stand(street):
    aerial = aerial_image(street, 0.2)
    fronts = [each for each in street.uprights if each.mask is None]
    behind = []
    for front in fronts:
        along = front.right - front.left
        middle = (front.left + front.right) / 2
        behind.append(middle + 2 * np.array([-along[1], along[0]]) / np.linalg.norm(along))
    colours = np.array([aerial.image[y, x] for x, y in aerial.pixels(behind)], int)
    assert np.mean(colours[:, 0] > colours[:, 2] + 15) > 0.9  # red roofs; a crown may hide one
    x, y = aerial.pixels([(LENGTH / 2, WIDTH / 2)])[0]
    assert np.ptp(aerial.image[y, x].astype(int)) == 0  # lawn
    trees = [each for each in street.uprights if each.mask is not None and each.height > LOW]
    assert trees
