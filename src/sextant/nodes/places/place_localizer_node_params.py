# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the node place_localizer, and their conversion to those of the library."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Callable, Optional

import sextant
from sextant.base.strict_params import (
    StrictParams,
    nested,
    not_empty,
    one_of,
    param,
    required,
    struct_param,
    within,
)
from sextant.place_maps.place_map_file import read_place_map
from sextant.places.global_descriptor import GlobalDescriptorParams
from sextant.places.index_params import PROFILES, VOTE_MATCHER, IndexParams
from sextant.places.place_index_update import PlaceIndexer
from sextant.places.place_localizer import VOTES, PlaceLocalizationParams

_FEATURES = sextant.FeatureParams()
_LOCALIZATION = (
    *("mode", "max_places", "min_keypoints", "min_matches", "window"),
    *("reach", "kidnap_probability", "exit_probability", "evidence_exponent", "evidence_penalty"),
    "network_weight",
)
_NETWORK = ("backend", "width", "height", "channels", "mean", "std")


@dataclass(frozen=True)
class PlaceLocalizerNodeParams(StrictParams):
    """Private parameters of the node."""

    map_file: str = required(
        "[place map](../how_to/place_map.md); its index is cached beside it as `MAP.index`", not_empty
    )
    wait_for_map: float = param(
        0.0, "maximum time to wait for the map file, if another node writes it", within(0.0, 3600.0), "s"
    )
    localization: PlaceLocalizationParams = nested(PlaceLocalizationParams, only=_LOCALIZATION)
    profile: str = param(
        "tuned",
        "`tuned`: upright keypoints of reduced images, compact descriptors; `plain`: OpenCV's defaults",
        one_of(*PROFILES),
    )
    detector: str = struct_param(sextant.FeatureParams, "detector", one_of(*sextant.feature_names()))
    extractor: str = struct_param(sextant.FeatureParams, "extractor", one_of(*sextant.feature_names()))
    matcher: str = param(
        VOTE_MATCHER,
        "mode votes: descriptor matcher; ORB and AKAZE need BruteForce-Hamming or faiss, SIFT and SURF any "
        "without Hamming",
        one_of(*sextant.matcher_names()),
    )
    orb_wta_k: int = struct_param(sextant.FeatureParams, "orb_wta_k", within(2, 4))
    max_side: int = param(
        _FEATURES.max_side,
        "profile tuned: longer side to which images are reduced; 0: no limit",
        within(0, 16384),
        "px",
    )
    max_features: int = param(
        _FEATURES.max_features,
        "profile tuned: maximum number of keypoints per image; 0: all",
        within(0, 1000000),
    )
    use_odometry: bool = param(
        False,
        "subscribe to `odom`: predict the belief with the distance that odometry measures between two images",
    )
    network: str = param(
        "", "ONNX file of a [global descriptor](../how_to/place_networks.md); empty: no network"
    )
    descriptor: GlobalDescriptorParams = nested(GlobalDescriptorParams, "network_", _NETWORK)
    initialpose: str = param(
        "never", "when `initialpose` is published automatically", one_of("never", "relocalized")
    )
    compressed: bool = param(False, "subscribe to `image/compressed` instead of `image`")
    jobs: int = param(
        1, "number of processes that compute the descriptors of the map's photos", within(1, 256)
    )
    scheduler: str = param("", "`tcp://HOST:PORT` of a Dask cluster that computes them; empty: none")

    def place_indexer(self, report: Callable[[str], None]) -> PlaceIndexer:
        """Reads the map.

        :param report: called with progress messages
        :raises OSError, ValueError: as sextant.place_maps.place_map_file.read_place_map()
        """
        path, network = Path(self.map_file), replace(self.descriptor, model=self.network)
        params = IndexParams.of_profile(
            self.profile, self.detector, self.extractor, self._matcher(), network, self.orb_wta_k,
            max_side=self.max_side, max_features=self.max_features,
        )  # fmt: skip
        return PlaceIndexer(path, read_place_map(path), params, self.jobs, self.scheduler, report)

    def _matcher(self) -> Optional[str]:
        return self.matcher if self.localization.mode == VOTES else None
