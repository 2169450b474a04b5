# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of features, matching and localization that the node place_localizer and commands share."""

from dataclasses import dataclass, fields, replace

import sextant
from sextant.base.strict_params import (
    StrictParams,
    above_zero,
    nested,
    one_of,
    param,
    struct_param,
    within,
)
from sextant.places.global_descriptor import GlobalDescriptorParams
from sextant.places.place_index import PROFILES, IndexParams
from sextant.places.place_localizer import PlaceLocalizationParams

_LOCALIZATION = (
    *("mode", "max_places", "min_keypoints", "min_matches", "window"),
    *("reach", "kidnap_probability", "exit_probability", "unknown_prior", "evidence_exponent"),
    *("evidence_penalty", "distance_noise", "radius", "network_weight"),
)
_NETWORK = ("backend", "width", "height", "channels", "mean", "std")
_OF_PROFILE = ("max_side", "max_features", "sift_contrast")  # parameters with different values by profile


def _of_profile(name: str, unset: str) -> str:
    """Description of a field of sextant.FeatureParams whose default depends on the profile.

    :param unset: stands for the default of the profile
    """
    what = next(field[-1] for field in sextant.FeatureParams.fields() if field[0] == name)
    values = (f"`{profile}`: {make('SIFT', 'SIFT')[name]:g}" for profile, make in PROFILES.items())
    return f"{what}; {unset}: that of the profile ({', '.join(values)})"


@dataclass(frozen=True)
class PlaceMethodParams(StrictParams):
    """How photos are described and matched, and how an image is localized."""

    localization: PlaceLocalizationParams = nested(PlaceLocalizationParams, only=_LOCALIZATION)
    profile: str = param(
        "tuned",
        "`tuned`: upright keypoints of reduced images, compact descriptors; `plain`: OpenCV's defaults",
        one_of(*PROFILES),
    )
    detector: str = struct_param(sextant.FeatureParams, "detector", one_of(*sextant.feature_names()))
    extractor: str = struct_param(sextant.FeatureParams, "extractor", one_of(*sextant.feature_names()))
    matcher: str = param(
        IndexParams().matcher,
        "descriptor matcher; ORB and AKAZE need BruteForce-Hamming or faiss, SIFT and SURF any "
        "without Hamming",
        one_of(*sextant.matcher_names()),
    )
    max_side: int = param(-1, _of_profile("max_side", "-1"), within(-1, 16384), "px")
    max_features: int = param(-1, _of_profile("max_features", "-1"), within(-1, 1000000))
    sift_contrast: float = param(0.0, _of_profile("sift_contrast", "0"), within(0, 1))
    surf_threshold: float = struct_param(sextant.FeatureParams, "surf_threshold", above_zero(1e6))
    akaze_threshold: float = struct_param(sextant.FeatureParams, "akaze_threshold", above_zero(1))
    orb_wta_k: int = struct_param(sextant.FeatureParams, "orb_wta_k", within(2, 4))
    network: str = param(
        "", "ONNX file of a [global descriptor](../how_to/place_networks.md); empty: no network"
    )
    descriptor: GlobalDescriptorParams = nested(GlobalDescriptorParams, "network_", _NETWORK)

    def index_params(self) -> IndexParams:
        """The parameters of the index; see IndexParams.validate()."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        features = PROFILES[self.profile](self.detector, self.extractor)
        defaults = type(self)()
        unset = {name for name in _OF_PROFILE if values[name] == getattr(defaults, name)}
        features.update({name: values[name] for name in features.keys() & values.keys() - unset})
        network = replace(self.descriptor, model=self.network) if self.network else None
        return IndexParams(features, self.matcher, network)
