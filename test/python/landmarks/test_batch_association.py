# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Association at known poses: the robot turns on the spot and sees four landmarks, two of each class."""

import numpy as np
import pytest

import sextant
from sextant.geometry.plane_poses import in_frame
from sextant.landmarks.batch_association import BatchAssociation, Map, Scan

PLACES = np.array([[2.0, 0.5], [2.2, -1.0], [-1.5, 1.0], [0.3, 2.5]])
CLASSES = np.array([0, 0, 1, 1])
POSES = np.array([[0.1 * np.cos(a), 0.1 * np.sin(a), a] for a in np.linspace(0, 4 * np.pi, 60)])
SIGMA = 0.03


def scans(rng, false_alarms=()):
    """All landmarks in view; besides them one observation in the map frame in each of the named scans."""
    made = []
    for index, pose in enumerate(POSES):
        points, classes = in_frame(pose, PLACES), CLASSES
        if index in false_alarms:
            points, classes = np.vstack([points, [1.0, 0.0] + rng.normal(0, 0.5, 2)]), np.append(CLASSES, 1)
        bearings = np.arctan2(points[:, 1], points[:, 0])
        seen = np.abs(bearings) < 0.5
        noisy = points[seen] + rng.normal(0, SIGMA, (seen.sum(), 2))
        noise = np.tile(SIGMA**2 * np.eye(2), (seen.sum(), 1, 1))
        made.append(Scan(index, noisy, noise, classes[seen], np.zeros(3)))
    return made


def association(identified=(), **settings):
    params = sextant.LandmarkSlamNodeParams()
    params.max_range, params.field_of_view = 4.0, 1.0
    batch = BatchAssociation(scans(np.random.default_rng(5), **settings), identified, params)
    batch.start(POSES)
    return batch


def landmarks(places, classes, fixed=0):
    return Map(np.array(places), np.array(classes), fixed, np.full(len(places), 0.8))


def improved(batch, made):
    _, made = batch.associate(made)
    return batch.improve(made)


def same_places(made):
    order = np.lexsort((made.positions[:, 0], made.classes))
    expected = np.lexsort((PLACES[:, 0], CLASSES))
    assert made.classes[order].tolist() == CLASSES[expected].tolist()
    assert made.positions[order] == pytest.approx(PLACES[expected], abs=3 * SIGMA)


def test_observations_are_of_the_landmarks_that_they_were_made_of():
    batch = association()
    found, made = batch.associate(landmarks(PLACES, CLASSES))
    for scan, of in zip(batch._scans, found):
        assert np.all(np.hypot(*(in_frame(POSES[scan.pose], PLACES[of]) - scan.positions).T) < 5 * SIGMA)
    assert np.all(made.detection > 0.85)


def test_a_map_that_is_right_stays():
    batch = association()
    _, made = batch.associate(landmarks(PLACES, CLASSES))
    assert batch.improve(made) is made


def test_a_landmark_that_lacks_is_added():
    same_places(improved(association(), landmarks(PLACES[:3], CLASSES[:3])))


def test_a_landmark_that_nothing_is_seen_of_is_removed():
    same_places(improved(association(), landmarks([*PLACES, [1.5, 2.0]], [*CLASSES, 0])))


def test_two_landmarks_that_are_one_are_joined():
    near = PLACES[1] + [0.05, -0.06]
    same_places(improved(association(), landmarks([*PLACES, near], [*CLASSES, 0])))


def test_one_landmark_that_is_two_is_split():
    both = PLACES[:2].mean(axis=0)
    same_places(improved(association(), landmarks([both, *PLACES[2:]], [0, 1, 1])))


def test_false_alarms_are_of_no_landmark_and_make_none():
    batch = association(false_alarms=(3, 20, 41))
    same_places(improved(batch, landmarks(PLACES, CLASSES)))


def test_what_was_known_or_has_an_id_is_not_removed():
    spare = [*PLACES, [1.5, 2.0]]
    assert len(improved(association(), landmarks(spare, [*CLASSES, 2], fixed=5)).positions) == 5
    assert len(improved(association(identified=[2]), landmarks(spare, [*CLASSES, 2])).positions) == 5


def test_scans_of_a_marker_camera_do_not_miss_other_landmarks():
    rates = {}
    for has_markers in (False, True):
        batch = association()
        nothing = np.zeros((0, 2)), np.zeros((0, 2, 2)), np.zeros(0, dtype=int)
        empty = Scan(0, *nothing, np.zeros(3), has_markers)
        more = [*batch._scans, *(empty._replace(pose=index) for index in range(len(POSES)))]
        params = sextant.LandmarkSlamNodeParams()
        params.max_range, params.field_of_view = 4.0, 1.0
        both = BatchAssociation(more, (), params)
        both.start(POSES)
        _, made = both.associate(landmarks(PLACES, CLASSES))
        rates[has_markers] = made.detection
    _, alone = association().associate(landmarks(PLACES, CLASSES))
    assert rates[True] == pytest.approx(alone.detection)
    assert np.all(rates[False] < 0.7)
