# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the node place_localizer, and their conversion to those of the library."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Callable

import sextant
from sextant.base.strict_params import StrictParams, nested, not_empty, one_of, param, required, within
from sextant.place_maps.place_map_file import read_place_map
from sextant.places.global_descriptor import GlobalDescriptorParams
from sextant.places.place_index import PROFILES, IndexParams
from sextant.places.place_index_update import PlaceIndexer
from sextant.places.place_localizer import PlaceLocalizationParams

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

    map_file: str = required(not_empty)  # place map
    wait_for_map: float = param(0.0, within(0.0, 3600.0))  # maximum time to wait for the map file, s
    localization: PlaceLocalizationParams = nested(PlaceLocalizationParams, only=_LOCALIZATION)
    profile: str = param("tuned", one_of(*PROFILES))  # plain: OpenCV's defaults
    detector: str = param(_FEATURES.detector, one_of(*sextant.feature_names()))
    extractor: str = param(_FEATURES.extractor, one_of(*sextant.feature_names()))
    matcher: str = param(IndexParams().matcher, one_of(*sextant.matcher_names()))
    orb_wta_k: int = param(_FEATURES.orb_wta_k, within(2, 4))  # points compared per descriptor element
    max_side: int = param(_FEATURES.max_side, within(0, 16384))  # pixels, profile tuned; 0: no limit
    max_features: int = param(_FEATURES.max_features, within(0, 1000000))  # profile tuned; 0: all
    use_odometry: bool = param(False)  # subscribe to odom
    network: str = param("")  # ONNX file of a global descriptor; empty: none
    descriptor: GlobalDescriptorParams = nested(GlobalDescriptorParams, "network_", _NETWORK)
    initialpose: str = param("never", one_of("never", "relocalized"))  # when it is published automatically
    compressed: bool = param(False)  # subscribe to image/compressed
    jobs: int = param(1, within(1, 256))  # processes for the description of the photos
    scheduler: str = param("")  # tcp://host:port of a Dask cluster for it; empty: none

    def place_indexer(self, report: Callable[[str], None]) -> PlaceIndexer:
        """Reads the map.

        :param report: called with progress messages
        :raises OSError, ValueError: as sextant.place_maps.place_map_file.read_place_map()
        """
        path, network = Path(self.map_file), replace(self.descriptor, model=self.network)
        params = IndexParams.of_profile(
            self.profile, self.detector, self.extractor, self.matcher, network, self.orb_wta_k,
            max_side=self.max_side, max_features=self.max_features,
        )  # fmt: skip
        return PlaceIndexer(path, read_place_map(path), params, self.jobs, self.scheduler, report)
