# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of nodes and commands as those of the index."""

import pytest

import sextant
from sextant.base.strict_params import flat_fields, parse_params
from sextant.places.place_belief import BeliefParams
from sextant.places.place_index import IndexParams, default_features, plain_features
from sextant.places.place_localizer import PlaceLocalizationParams
from sextant.places.place_method_params import PlaceMethodParams


def made(**values):
    return parse_params(PlaceMethodParams, values, "", "")


def test_without_any_the_defaults_are_the_librarys():
    assert made().localization == PlaceLocalizationParams()
    assert made().index_params() == IndexParams()


@pytest.mark.parametrize(
    "profile, default", [("tuned", default_features()), ("plain", plain_features("SIFT", "SIFT"))]
)
def test_a_profile_has_defaults_of_its_own_and_what_is_set_replaces_them(profile, default):
    assert made(profile=profile).index_params().features == default
    values = {
        **{"max_side": 200, "max_features": 90, "sift_contrast": 0.02},
        **{"surf_threshold": 600.0, "akaze_threshold": 0.004, "orb_wta_k": 3},
    }
    assert made(profile=profile, **values).index_params().features == {**default, **values}


@pytest.mark.parametrize("profile", ["tuned", "plain"])
def test_no_limit_can_be_set_in_every_profile(profile):
    features = made(profile=profile, max_side=0, max_features=0).index_params().features
    assert (features["max_side"], features["max_features"]) == (0, 0)


def test_every_threshold_and_all_of_the_belief_can_be_set():
    names = set(flat_fields(PlaceMethodParams))
    features = {name for name, *_ in sextant.FeatureParams.fields()}
    assert features - names == {"upright", "root_sift", "support_scale"}  # set by the profile
    assert set(flat_fields(BeliefParams)) <= names


@pytest.mark.parametrize(
    "name, value",
    [
        *(("max_side", -2), ("max_side", 16385), ("max_features", -2), ("sift_contrast", 1.5)),
        *(("surf_threshold", 0.0), ("akaze_threshold", 0.0), ("akaze_threshold", 2.0), ("orb_wta_k", 5)),
        *(("profile", "best"), ("detector", "FAST"), ("matcher", "none"), ("radius", -1.0)),
    ],
)
def test_what_cannot_be_is_named(name, value):
    with pytest.raises(ValueError, match=f"^{name}: must be"):
        made(**{name: value})


def test_a_network_comes_with_its_settings():
    assert made().index_params().global_descriptor is None
    values = {"network_channels": "grey", "network_mean": [0], "network_std": [1], "network_width": 64}
    network = made(network="n.onnx", network_height=32, **values).index_params().global_descriptor
    assert (network.model, network.width, network.height, network.channels) == ("n.onnx", 64, 32, "grey")
    assert (network.mean, network.std) == ((0.0,), (1.0,))
