# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of place_localizer, as they reach the library."""

import pytest

from sextant.nodes.params import parse_params
from sextant.nodes.place_localizer_params import PlaceLocalizerParams


def parsed(tmp_path, **values):
    (tmp_path / "map.txt").write_text("park.png;10;10\n0;0.png;1;1\n")
    return parse_params(
        PlaceLocalizerParams, {"map_file": str(tmp_path / "map.txt"), **values}, "/robot/places"
    )


def settings_of(params):
    return params.library(print).settings


@pytest.mark.parametrize("profile", ["tuned", "plain"])
@pytest.mark.parametrize("points, matcher", [(2, "BruteForce-Hamming"), (4, "BruteForce-Hamming(2)")])
def test_each_kind_of_orb_has_its_matcher(tmp_path, profile, points, matcher):
    orb = {"detector": "ORB", "extractor": "ORB", "profile": profile, "orb_wta_k": points}
    settings = settings_of(parsed(tmp_path, matcher=matcher, **orb))
    settings.validate()
    assert settings.features["orb_wta_k"] == points
    with pytest.raises(ValueError, match="matcher is"):
        settings_of(parsed(tmp_path, matcher=matcher, **{**orb, "orb_wta_k": 6 - points})).validate()


def test_sizes_are_of_the_tuned_profile(tmp_path):
    sizes = {"max_side": 100, "max_features": 9}
    tuned, plain = (
        settings_of(parsed(tmp_path, profile=profile, **sizes)).features for profile in ("tuned", "plain")
    )
    assert (tuned["max_side"], tuned["max_features"]) == (100, 9)
    assert (plain["max_side"], plain["max_features"]) == (0, 0)


@pytest.mark.parametrize(
    "name, value", [("network_backend", "torch"), ("network_channels", "HSV"), ("orb_wta_k", 5)]
)
def test_what_cannot_be_is_named_in_full(tmp_path, name, value):
    with pytest.raises(ValueError, match=f"/robot/places/{name}: must be"):
        parsed(tmp_path, **{name: value})


def test_the_others_reach_the_localizer(tmp_path):
    given = {"mode": "sequence", "window": 7, "min_keypoints": 3, "network_weight": 0.5, "reach": 9.0}
    taken = parsed(tmp_path, **given).localization()
    assert (taken.mode, taken.window, taken.belief.reach) == ("sequence", 7, 9.0)
    assert (taken.recognition.min_keypoints, taken.recognition.global_weight) == (3, 0.5)
