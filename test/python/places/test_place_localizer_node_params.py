# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the parameters of place_localizer are for the library."""

import pytest
from made_photos import written_photos

from sextant.base.strict_params import parse_params
from sextant.nodes.places.place_localizer_node_params import PlaceLocalizerNodeParams


def made(**values):
    return parse_params(PlaceLocalizerNodeParams, {"map_file": "park.txt", **values}, "/robot")


def test_every_one_arrives_where_it_belongs():
    values = {
        "reach": 1.5,
        "kidnap_probability": 0.25,
        "exit_probability": 0.125,
        "evidence_exponent": 0.75,
        "evidence_penalty": 3.5,
    }
    belief = made(**values).method.localization.belief
    assert {name: getattr(belief, name) for name in values} == values
    localization = made(
        mode="sequence", window=7, max_places=3, min_matches=11, min_keypoints=13, network_weight=2.5
    ).method.localization
    assert (localization.mode, localization.window) == ("sequence", 7)
    assert (localization.max_places, localization.min_matches) == (3, 11)
    assert (localization.recognition.min_keypoints, localization.recognition.network_weight) == (13, 2.5)


@pytest.fixture
def map_file(tmp_path):
    written_photos(tmp_path, 1)
    return str(tmp_path / "park.txt")


def settings(map_file, **values):
    return made(map_file=map_file, **values).place_indexer(print).params


def test_who_describes_the_photos_is_reported(map_file):
    library = made(map_file=map_file, jobs=3, scheduler="tcp://host:1").place_indexer(print)
    assert (library.jobs, library.scheduler) == (3, "tcp://host:1")


@pytest.mark.parametrize("profile", ["tuned", "plain"])
@pytest.mark.parametrize("points, matcher", [(2, "BruteForce-Hamming"), (4, "BruteForce-Hamming(2)")])
def test_each_kind_of_orb_has_its_matcher(map_file, profile, points, matcher):
    orb = {"detector": "ORB", "extractor": "ORB", "profile": profile, "orb_wta_k": points, "mode": "votes"}
    taken = settings(map_file, matcher=matcher, **orb)
    taken.validate()
    assert taken.features["orb_wta_k"] == points
    with pytest.raises(ValueError, match="matcher is"):
        settings(map_file, matcher=matcher, **{**orb, "orb_wta_k": 6 - points}).validate()


def test_rough_poses_are_refused_with_votes():
    assert made(use_rough_pose=True).use_rough_pose
    with pytest.raises(ValueError, match="not possible with mode votes"):
        made(use_rough_pose=True, mode="votes")


@pytest.mark.parametrize(
    "name, value", [("network_backend", "torch"), ("network_channels", "HSV"), ("orb_wta_k", 5)]
)
def test_what_cannot_be_is_named_in_full(name, value):
    with pytest.raises(ValueError, match=f"/robot/{name}: must be"):
        made(**{name: value})
