# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the node place_localizer, and what they are for the library."""

from dataclasses import dataclass
from pathlib import Path
from typing import Callable, List

import sextant
from sextant.base.strict_params import not_empty, one_of, param, required, within
from sextant.place_maps.place_map_file import read_place_map
from sextant.places.global_descriptor import BACKEND_NAMES, CHANNELS, GlobalDescriptorSettings
from sextant.places.place_belief import BeliefParams
from sextant.places.place_index import PROFILES, IndexSettings
from sextant.places.place_library import Library
from sextant.places.place_localization import VOTES, LocalizationParams
from sextant.places.place_modes import MODES
from sextant.places.place_recognition import RecognitionParams

_FEATURES, _BELIEF = sextant.FeatureParams(), BeliefParams()
_LOCALIZATION, _RECOGNITION = LocalizationParams(), RecognitionParams()
_GLOBAL = GlobalDescriptorSettings()


@dataclass(frozen=True)
class PlaceLocalizerParams:
    """The map, how pictures are described and compared, and what is told."""

    map_file: str = required(not_empty)
    wait_for_map: float = param(0.0, within(0.0, 3600.0))  # seconds that the map may not be there yet
    mode: str = param(_LOCALIZATION.mode, one_of(*MODES, VOTES))
    profile: str = param("tuned", one_of(*PROFILES))  # plain: detector and extractor as OpenCV has them
    detector: str = param(_FEATURES.detector, one_of(*sextant.feature_names()))
    extractor: str = param(_FEATURES.extractor, one_of(*sextant.feature_names()))
    matcher: str = param(IndexSettings().matcher, one_of(*sextant.matcher_names()))
    orb_wta_k: int = param(_FEATURES.orb_wta_k, within(2, 4))  # points that decide a bit
    max_side: int = param(_FEATURES.max_side, within(0, 16384))  # pixels; of profile tuned; 0: any
    max_features: int = param(_FEATURES.max_features, within(0, 1000000))  # of profile tuned; 0: all
    max_places: int = param(_LOCALIZATION.max_places, within(1, 1000))  # that are told
    min_keypoints: int = param(_RECOGNITION.min_keypoints, within(1, 100000))
    min_matches: int = param(_LOCALIZATION.min_matches, within(1, 100000))  # of mode votes
    window: int = param(_LOCALIZATION.window, within(2, 1000))  # pictures, of mode sequence
    reach: float = param(_BELIEF.reach, within(1.0, 20.0))
    restart: float = param(_BELIEF.restart, within(0.0, 1.0))
    leave: float = param(_BELIEF.leave, within(0.0, 1.0))
    trust: float = param(_BELIEF.trust, within(1e-6, 1.0))
    doubt: float = param(_BELIEF.doubt, within(0.0, 20.0))
    use_odometry: bool = param(False)  # hear odom
    network: str = param("")  # ONNX file of a global descriptor
    network_backend: str = param(_GLOBAL.backend, one_of(*BACKEND_NAMES))
    network_width: int = param(_GLOBAL.width, within(0, 4096))  # pixels; 0: as the model says
    network_height: int = param(_GLOBAL.height, within(0, 4096))
    network_channels: str = param(_GLOBAL.channels, one_of(*CHANNELS))
    network_mean: List[float] = param(list(_GLOBAL.mean))
    network_std: List[float] = param(list(_GLOBAL.std))
    network_weight: float = param(_RECOGNITION.global_weight, within(0.0, 100.0))
    initialpose: str = param("never", one_of("never", "found_again"))  # when it is told unasked
    compressed: bool = param(False)  # hear image/compressed
    jobs: int = param(1, within(1, 256))  # processes that describe the map's photos
    scheduler: str = param("")  # tcp://host:port of a Dask cluster that does it

    def photo_library(self, report: Callable[[str], None]) -> Library:
        """The map's photos and their index.

        :raises OSError, ValueError: as sextant.place_maps.place_map_file.read_place_map()
        """
        path = Path(self.map_file)
        settings = IndexSettings.of_profile(
            self.profile, self.detector, self.extractor, self.matcher, self._network(), self.orb_wta_k,
            max_side=self.max_side, max_features=self.max_features,
        )  # fmt: skip
        return Library(path, read_place_map(path), settings, self.jobs, self.scheduler, report)

    def localization(self) -> LocalizationParams:
        """For sextant.places.place_localization.PlaceLocalizer."""
        return LocalizationParams(
            mode=self.mode,
            max_places=self.max_places,
            window=self.window,
            min_matches=self.min_matches,
            recognition=RecognitionParams(
                min_keypoints=self.min_keypoints, global_weight=self.network_weight
            ),
            belief=BeliefParams(
                reach=self.reach,
                restart=self.restart,
                leave=self.leave,
                trust=self.trust,
                doubt=self.doubt,
            ),
        )

    def _network(self) -> GlobalDescriptorSettings:
        return GlobalDescriptorSettings(
            self.network, self.network_backend, self.network_width, self.network_height,
            self.network_channels, tuple(self.network_mean), tuple(self.network_std),
        )  # fmt: skip
