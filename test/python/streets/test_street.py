# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The simulated street: what stands where, what changes, and that it is seen where a pinhole shows it."""

from copy import copy
from dataclasses import replace
from functools import lru_cache

import cv2
import numpy as np
import pytest

from sextant.simulation.uprights import Upright
from sextant.streets.street import LENGTH, WIDTH, Street
from sextant.streets.street_camera import CAMERAS, StreetCamera
from sextant.streets.street_conditions import CONDITIONS, StreetConditions, at_hour, sun_at
from sextant.streets.street_view import street_view

STILL = replace(CONDITIONS["summer"], noise=0.0)
SIZE = (320, 240)
EYE = StreetCamera().height
F = 0.5 * SIZE[0] / np.tan(np.deg2rad(31.0))  # pixels, of 62 degrees


def board(left, right, height, tone):
    return Upright(np.array(left), np.array(right), height, np.full((400, 400), tone, np.uint8), None)


@lru_cache(maxsize=None)
def still_street(name="summer"):
    return Street(1, replace(CONDITIONS[name], noise=0.0))


@pytest.fixture
def empty():
    street = copy(still_street())
    street.uprights = []
    return street


def changed_box(street, before, pose):
    """First and last column and row that differ from a picture before."""
    rows, columns = np.nonzero(np.abs(street_view(street, pose, SIZE).astype(int) - before) > 20)
    return columns.min(), columns.max(), rows.min(), rows.max()


@pytest.mark.slow
@pytest.mark.parametrize("yaw", [0.0, 2.0])
def test_a_board_is_seen_where_a_pinhole_shows_it(empty, yaw):
    pose = np.array([40.0, 30.0, yaw])
    before = street_view(empty, pose, SIZE).astype(int)
    ahead, left = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
    depth, height = 8.0, 3.0
    corners = [pose[:2] + depth * ahead + aside * left for aside in (1.0, -2.0)]
    empty.uprights = [board(*corners, height, 10)]
    u = [159.5 - F * 1.0 / depth, 159.5 + F * 2.0 / depth]
    v = [119.5 - F * (height - EYE) / depth, 119.5 + F * EYE / depth]
    assert changed_box(empty, before, pose) == pytest.approx((*u, *v), abs=1.5)


def test_a_board_beside_the_camera_is_cut_off(empty):
    pose = np.array([40.0, 30.0, 0.0])
    before = street_view(empty, pose, SIZE).astype(int)
    empty.uprights = [board((30.0, 32.0), (50.0, 32.0), 3.0, 10)]  # begins behind
    box = changed_box(empty, before, pose)
    assert box[0] == 0 and box[1] == pytest.approx(159.5 - F * 2.0 / 10.0, abs=1.5)


def test_the_nearer_hides_the_farther(empty):
    pose = np.array([40.0, 30.0, 0.0])
    empty.uprights = [board((46.0, 31.0), (46.0, 29.0), 3.0, 10), board((52.0, 35.0), (52.0, 25.0), 3.0, 240)]
    image = street_view(empty, pose, SIZE)
    assert image[110, 160] < 40 < 180 < image[110, 60]


def test_the_walk_goes_around_the_block():
    street = still_street()
    poses = np.array([street.pose(arc) for arc in np.linspace(0, street.length, 200)])
    assert poses[0] == pytest.approx(poses[-1], abs=1e-6)
    assert poses[:, :2].min() == pytest.approx(0, abs=0.1)
    assert poses[:, :2].max(axis=0) == pytest.approx([LENGTH, WIDTH], abs=0.1)
    steps = np.linalg.norm(np.diff(poses[:, :2], axis=0), axis=1)
    assert steps == pytest.approx(np.full(199, street.length / 199), rel=0.02)
    x, y, yaw = street.pose(30.0, aside=2.0, turn=0.1)
    straight = street.pose(30.0)
    assert np.hypot(x - straight[0], y - straight[1]) == pytest.approx(2.0) and yaw == pytest.approx(
        straight[2] + 0.1
    )


@pytest.mark.slow
def test_a_seed_makes_the_same_street():
    streets = [still_street(), *(Street(seed, STILL) for seed in (1, 2))]
    pictures = [street_view(street, street.pose(20.0), SIZE) for street in streets]
    assert np.array_equal(pictures[0], pictures[1])
    assert not np.array_equal(pictures[0], pictures[2])


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in CONDITIONS if name != "summer"])
def test_conditions_change_the_picture_but_not_where_houses_stand(name):
    usual, other = still_street(), still_street(name)
    assert not np.array_equal(
        street_view(usual, usual.pose(20.0), SIZE), street_view(other, other.pose(20.0), SIZE)
    )
    houses = [
        {
            (*upright.left, *upright.right, upright.height)
            for upright in street.uprights
            if upright.mask is None
        }
        for street in (usual, other)
    ]
    assert houses[0] == houses[1] and len(houses[0]) > 20


@pytest.mark.slow
def test_a_view_is_as_rich_as_a_photo():
    street = still_street()
    views = [street_view(street, street.pose(arc)) for arc in np.arange(0, street.length, 40)]
    assert np.median([len(cv2.SIFT_create().detect(view)) for view in views]) >= 1000


@pytest.mark.slow
def test_both_sizes_show_the_same():
    street, small = still_street(), (320, 240)
    for arc in np.arange(5, street.length, 60):
        pose = street.pose(arc)
        large = street_view(street, pose, (1280, 960))
        error = cv2.resize(large, small, interpolation=cv2.INTER_AREA) - street_view(street, pose, small)
        assert np.abs(error.astype(np.int8)).mean() < 6


def hard(name="low_sun", seed=1, **changed):
    return Street(seed, replace(CONDITIONS[name], noise=0.0, **changed))


def outlines(street):
    """Ends of what stands without an opaque front: plants, cars and people."""
    return {(*each.left, *each.right) for each in street.uprights if each.mask is not None}


@pytest.mark.slow
def test_another_look_has_other_cars_and_people_and_another_seed_other_shadows():
    usual, again, look, other = hard(), hard(), hard(look=99), hard(seed=2)
    assert outlines(usual) == outlines(again) != outlines(look)
    assert 30 < len(outlines(usual) - outlines(look)) < 150  # cars and people; the plants are the same
    views = [street_view(each, each.pose(20.0), SIZE) for each in (usual, again, look, other)]
    assert np.array_equal(views[0], views[1])
    assert not np.array_equal(views[0], views[2]) and not np.array_equal(views[0], views[3])
    grounds = [each.ground.layout[0][:, :, 0] for each in (usual, other)]
    assert np.mean(np.abs(grounds[0].astype(int) - grounds[1]) > 40) > 0.05


@pytest.mark.slow
def test_there_are_as_many_pedestrians_as_set():
    count = [len(hard(people=people, parked=0.0).uprights) for people in (0.0, 2.0)]
    expected = 2.0 * still_street().length / 10
    assert count[1] - count[0] == pytest.approx(expected, abs=4 * np.sqrt(expected))


@pytest.mark.slow
def test_a_wall_is_bright_where_the_sun_reaches_it_and_dark_where_it_turns_away():
    """With all light from the sun a wall that turns away is black."""
    street = hard(direct=1.0, people=0.0, parked=0.0)
    toward = np.array([np.cos(street.conditions.sun), np.sin(street.conditions.sun)])
    sunny = []
    for each in street.uprights:
        if each.mask is None:
            along = each.right - each.left
            facing = np.array([along[1], -along[0]]) @ toward / np.linalg.norm(along)
            assert facing > 0 or each.grey.max() == 0
            sunny += [each.grey.max() > 20] if facing > 0.3 else []
    assert len(sunny) > 10 and np.mean(sunny) > 0.5  # the rest is in the shade of other houses


@pytest.mark.slow
def test_wet_ground_mirrors_what_stands_above_it():
    street = hard("wet", haze=0.0)
    street.uprights = [board((48.0, 35.0), (48.0, 25.0), 4.0, 0)]
    street.ground.puddles[:] = 255
    pose = np.array([32.0, 30.0, 0.0])
    mirror = street_view(street, pose, (640, 480)).astype(int)
    street.ground.puddles[:] = 0
    difference = (mirror - street_view(street, pose, (640, 480)))[:, 300:340].mean(axis=1)
    top = 239.5 + 2 * F * (EYE + 4.0) / 16.0  # row of the mirror image of the board's upper edge
    assert difference[round(top) - 20 : round(top) - 5].max() < 0  # of the black board
    assert difference[round(top) + 5 : round(top) + 20].min() > 0  # of the sky above it


@pytest.mark.slow
@pytest.mark.parametrize("name", ["low_sun", "snow", "wet"])
def test_a_camera_with_half_the_tangent_shows_the_middle_twice_as_large(name):
    street, wide = hard(name, drops=0.0), StreetCamera(horizontal_fov=1.2)
    narrow = replace(wide, horizontal_fov=2 * np.arctan(np.tan(0.6) / 2))
    large = street_view(street, street.pose(20.0), (1280, 960), camera=wide)[240:720, 320:960]
    error = large.astype(int) - street_view(street, street.pose(20.0), (640, 480), camera=narrow)
    assert np.abs(error).mean() < 6


@pytest.mark.slow
def test_the_exposure_of_an_image_changes_with_its_seed_only():
    street, pose = hard(), still_street().pose(20.0)
    images = [street_view(street, pose, SIZE, seed, CAMERAS["phone"]) for seed in (1, 2, 1)]
    assert np.array_equal(images[0], images[2]) and abs(images[0].mean() - images[1].mean()) > 3


@pytest.mark.slow
def test_snow_makes_roofs_sills_and_ground_white():
    diffuse = {"direct": 0.0, "exposure": 1.0, "people": 0.0, "parked": 0.0}
    snow, bare = (hard(name, **diffuse) for name in ("snow", "low_sun"))
    white = [np.mean([np.mean(each.grey > 190) for each in street.uprights]) for street in (snow, bare)]
    assert white[0] > white[1] + 0.1
    assert snow.ground.layout[0][:, :, 0].mean() > bare.ground.layout[0][:, :, 0].mean() + 60


def test_the_sun_is_in_the_south_at_noon_and_moves_west():
    azimuth, height = sun_at(12.0)
    assert azimuth == pytest.approx(-np.pi / 2)
    assert np.arctan(height) == pytest.approx(np.deg2rad(90 - 50 - 23.4))  # 90 - latitude + declination
    morning, evening = sun_at(9.0), sun_at(15.0)
    assert morning[1] == pytest.approx(evening[1]) and morning[1] < height
    assert morning[0] + np.pi / 2 == pytest.approx(-(evening[0] + np.pi / 2)) and morning[0] > azimuth
    assert sun_at(6.0, 0.0)[0] == pytest.approx(0.0) and sun_at(6.0, 0.0)[1] == pytest.approx(0, abs=1e-12)


def test_a_sun_below_the_horizon_is_refused():
    with pytest.raises(ValueError, match="sun_height: must be within"):
        at_hour(CONDITIONS["low_sun"], 5.0)


def test_the_ground_stays_where_it_is_when_the_camera_moves(empty):
    before, after = (street_view(empty, np.array([x, 0.0, 0.0]), (640, 480)) for x in (40.0, 40.5))
    rows, f = np.arange(300, 420), 320 / np.tan(np.deg2rad(31.0))
    depth = EYE * f / (rows - 239.5)
    moved = 239.5 + EYE * f / (depth - 0.5)  # where the same ground is seen afterwards
    seen = cv2.remap(after, *shrunk(rows, moved, depth / (depth - 0.5)), cv2.INTER_LINEAR)
    assert np.corrcoef(before[rows, 220:420].ravel(), seen.ravel())[0, 1] > 0.8


def shrunk(rows, moved, factor):
    u = 319.5 + np.outer(factor, np.arange(220, 420) - 319.5)
    return u.astype(np.float32), np.tile(moved.astype(np.float32)[:, None], (1, 200))


@pytest.mark.parametrize(
    "changed, reason",
    [
        ({"season": "spring"}, "season: must be one of summer, autumn, bare, winter, snow, is 'spring'"),
        ({"direct": 2}, "direct: must be"),
    ],
)
def test_conditions_that_cannot_be_are_refused(changed, reason):
    with pytest.raises(ValueError, match=reason):
        Street(1, StreetConditions(**changed))
