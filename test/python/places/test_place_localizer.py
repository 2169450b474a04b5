# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Walks through made photos, with known places: the answers, and when a carried robot is found again."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from made_photos import index_of, picture, shifted, written_photos
from posed_street import CAMERA, errors, view, write_street

from sextant.place_maps.place_map import MetricFrame
from sextant.place_points.place_points_file import points_of_map
from sextant.places.index_params import IndexParams, plain_features
from sextant.places.place_localizer import PlaceLocalizationParams, PlaceLocalizer, Status

COUNT = 24
ELSEWHERE, EMPTY = 200, np.full((240, 320), 90, np.uint8)
FRAME = MetricFrame("town", 0.1, (0.0, 0.0, 0.0))  # photos are 1 m apart
MESSAGE = Path(__file__).resolve().parents[3] / "msg" / "PlaceHypotheses.msg"


@pytest.fixture(scope="module")
def place_map(tmp_path_factory):
    return written_photos(tmp_path_factory.mktemp("map"), COUNT)._replace(georeference=FRAME)


@pytest.fixture(scope="module")
def index(place_map):
    return index_of(place_map, IndexParams())


@pytest.fixture(scope="module")
def plain_index(place_map):
    return index_of(place_map, IndexParams(plain_features("SIFT", "SIFT"), "FlannBased"))


def seen(place, seed=0, noise=6.0):
    return shifted(picture(place), 9, 3, noise, seed)


def overgrown(place):
    """Most of what is seen is new."""
    return np.clip(0.3 * seen(place, place) + 0.7 * picture(1000 + place), 0, 255).astype(np.uint8)


def localizer(place_map, index, mode, **changed):
    return PlaceLocalizer(place_map, index, PlaceLocalizationParams(mode=mode, **changed))


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["filter", "sequence", "single"])
def test_a_walk_is_followed(place_map, index, mode):
    robot = localizer(place_map, index, mode)
    walk = [robot.localize(seen(place, place)) for place in range(4, 16)]
    for place, found in list(zip(range(4, 16), walk))[3:]:
        assert found.status == Status.LOCALIZED
        assert found.hypotheses[0].photo.id == place
        assert found.estimate.x == pytest.approx(10 * place, abs=10)
        assert found.match.photo.id == place
    assert sum(found.relocalized for found in walk) == 1


def test_odometry_predicts_how_far_the_next_place_is(place_map, index):
    robot = localizer(place_map, index, "filter")
    for place in (4, 5, 6):
        robot.localize(seen(place), 1.0)
    far = robot.localize(EMPTY, 10.0)
    assert far.status == Status.UNUSABLE and far.estimate is None
    # which way, nobody knows
    assert {answer.photo.id // 4 for answer in far.hypotheses[:2]} & {16 // 4}
    assert robot.localize(seen(16), 0.0).hypotheses[0].photo.id == 16


def test_a_carried_robot_is_found_again_once(place_map, index):
    robot = localizer(place_map, index, "filter")
    before = [robot.localize(seen(place)) for place in range(2, 8)]
    after = [robot.localize(seen(place)) for place in range(14, 23)]
    assert [found.relocalized for found in before].count(True) == 1
    assert [found.relocalized for found in after].count(True) == 1
    again = [found.relocalized for found in after].index(True)
    assert after[again].hypotheses[0].photo.id == 14 + again
    assert after[-1].status == Status.LOCALIZED and after[-1].hypotheses[0].photo.id == 22


def test_a_moment_of_doubt_is_not_a_carried_robot(place_map, index):
    robot = localizer(place_map, index, "filter")
    walk = [robot.localize(seen(place)) for place in range(2, 8)]
    unusable = [robot.localize(EMPTY) for _ in range(3)]
    walk += [robot.localize(seen(place)) for place in range(10, 14)]
    assert {found.status for found in unusable} == {Status.UNUSABLE}
    assert [found.relocalized for found in walk].count(True) == 1


@pytest.mark.slow
def test_a_robot_that_left_the_map_is_at_an_unknown_place_and_comes_back(place_map, index):
    robot = localizer(place_map, index, "filter")
    for place in range(2, 8):
        robot.localize(seen(place))
    outside = [robot.localize(picture(ELSEWHERE + i)) for i in range(25)]
    assert outside[-1].status == Status.UNKNOWN_PLACE and outside[-1].unknown_probability > 0.5
    back = [robot.localize(seen(place)) for place in range(7, 15)]
    assert [found.relocalized for found in back].count(True) == 1
    assert back[-1].status == Status.LOCALIZED


def test_probabilities_of_hypotheses_and_unknown_place_sum_to_at_most_one(place_map, index):
    robot = localizer(place_map, index, "filter", max_places=3)
    for place in (5, 6, 7, ELSEWHERE):
        found = robot.localize(seen(place))
        probabilities = [answer.probability for answer in found.hypotheses]
        assert probabilities == sorted(probabilities, reverse=True) and len(probabilities) <= 3
        assert sum(probabilities) + found.unknown_probability <= 1 + 1e-9


def right_of(robot, begin=8):
    """Part of the images of an overgrown walk whose place is right, but for the first ones."""
    walk = [robot.localize(overgrown(place)) for place in range(COUNT)]
    is_right = [
        found.status == Status.LOCALIZED and abs(found.hypotheses[0].photo.id - place) <= 1
        for place, found in enumerate(walk)
    ]
    return np.mean(is_right[begin:])


@pytest.mark.slow
def test_a_sequence_recognizes_what_one_image_cannot(place_map, index):
    single, sequence = localizer(place_map, index, "single"), localizer(place_map, index, "sequence")
    assert right_of(single) <= 0.5 and right_of(sequence) >= 0.9


def test_after_a_reset_nothing_is_known(place_map, index):
    robot = localizer(place_map, index, "filter")
    first = robot.localize(seen(9))
    for place in (10, 11, 12):
        robot.localize(seen(place))
    robot.reset()
    again = robot.localize(seen(9))
    assert [each.probability for each in again.hypotheses] == [each.probability for each in first.hypotheses]


@pytest.mark.slow
def test_votes_are_shares_of_the_matches(place_map, plain_index):
    robot = localizer(place_map, plain_index, "votes", min_matches=10, max_places=2)
    found = robot.localize(np.where(np.arange(320) < 190, seen(7), picture(12)))
    assert found.status == Status.LOCALIZED and found.unknown_probability == 0
    assert [answer.photo.id for answer in found.hypotheses] == [7, 12]
    assert 0.5 < found.hypotheses[0].probability < 1
    assert (found.estimate.x, found.estimate.y) == (70.0, 50.0)


def test_the_only_one_with_votes_is_certain(tmp_path):
    alone = written_photos(tmp_path, 1)
    index = index_of(alone, IndexParams(plain_features("SIFT", "SIFT"), "BruteForce"))
    found = localizer(alone, index, "votes").localize(seen(0))
    assert [(answer.photo.id, answer.probability) for answer in found.hypotheses] == [(0, 1.0)]


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["filter", "single"])
@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_map_of_few_places_is_recognized_and_nothing_else_is(tmp_path, count, mode):
    few = written_photos(tmp_path, count)
    robot = localizer(few, index_of(few), mode)
    there = [robot.localize(seen(count - 1, i)) for i in range(4)]
    assert {found.status for found in there[1:]} == {Status.LOCALIZED}
    assert there[-1].hypotheses[0].photo.id == count - 1
    robot.reset()
    elsewhere = [robot.localize(picture(ELSEWHERE + i)) for i in range(4)]
    assert {found.status for found in elsewhere} == {Status.UNKNOWN_PLACE}


@pytest.mark.parametrize("mode", ["votes", "filter"])
def test_an_empty_image_gives_no_evidence(place_map, index, plain_index, mode):
    found = localizer(place_map, plain_index if mode == "votes" else index, mode).localize(EMPTY)
    assert found.status == Status.UNUSABLE and found.estimate is None and not found.relocalized
    assert found.statistics.keypoints == 0


def test_too_few_matches_gives_no_evidence_in_mode_votes(place_map, plain_index):
    found = localizer(place_map, plain_index, "votes", min_matches=100000).localize(seen(7))
    assert found.status == Status.UNUSABLE and found.hypotheses == []


def test_the_numbers_of_a_status_are_those_of_the_message():
    lines = [line.partition("#")[0].split() for line in MESSAGE.read_text().splitlines()]
    constants = dict(fields[1].split("=") for fields in lines if len(fields) == 2 and "=" in fields[1])
    assert {name: yaml.safe_load(value) for name, value in constants.items()} == dict(Status.__members__)


@pytest.mark.parametrize(
    "changed, reason",
    [
        ({"mode": "best"}, "mode: must be one of filter, sequence, single, votes, is 'best'"),
        ({"max_places": 0}, r"max_places: must be within \[1, 1000\], is 0"),
        ({"window": 1}, r"window: must be within \[2, 1000\], is 1"),
    ],
)
def test_parameters_out_of_range_are_refused(changed, reason):
    with pytest.raises(ValueError, match=reason):
        PlaceLocalizationParams(**changed)


def test_a_metric_pose_needs_points_and_a_camera(tmp_path):
    path, street = write_street(tmp_path)
    points, index = points_of_map(path, street), index_of(street, IndexParams())
    image, T = view(7.4, 0.4, 0.05, seed=99)
    with_points, without = (
        PlaceLocalizer(street, index, PlaceLocalizationParams(mode="single"), each) for each in (points, None)
    )
    found = with_points.localize(image, camera=CAMERA.model())
    assert found.status == Status.LOCALIZED and found.estimate and found.pose
    assert max(errors(T, found.pose)) < 0.05
    assert with_points.localize(image).pose is None
    assert without.localize(image, camera=CAMERA.model()).pose is None
    assert with_points.localize(np.full_like(image, 90), camera=CAMERA.model()).pose is None
