# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of an index: how photos are described and matched."""

import hashlib
import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Callable, Dict, Optional

import sextant
from sextant.base.strict_params import parse_struct
from sextant.places.global_descriptor import GlobalDescriptorParams, cached_descriptor

MAX_SIDE = 16384  # maximum of sextant.FeatureParams.max_side
VOTE_MATCHER = "faiss"  # default of mode votes
FINE = {"support_scale": 1.0, "min_size": 2.5}  # of the fine keypoints, in images of twice the size


def default_features() -> Dict[str, Any]:
    """Default fields of sextant.FeatureParams, for a camera without roll."""
    return _fields(sextant.FeatureParams())


def plain_features(detector: str, extractor: str) -> Dict[str, Any]:
    """Fields of sextant.FeatureParams with OpenCV's defaults."""
    return _fields(sextant.FeatureParams.plain(detector, extractor))


# name: function of detector and extractor that returns the fields of sextant.FeatureParams
PROFILES: Dict[str, Callable[[str, str], Dict[str, Any]]] = {
    "tuned": lambda detector, extractor: {**default_features(), "detector": detector, "extractor": extractor},
    "plain": plain_features,
}


def _fields(params: "sextant.FeatureParams") -> Dict[str, Any]:
    return {name: getattr(params, name) for name, *_ in params.fields()}


@dataclass(frozen=True)
class IndexParams:
    """How photos are described and matched. An index is valid for one set of parameters."""

    features: Dict[str, Any] = field(default_factory=default_features)  # fields of sextant.FeatureParams
    matcher: Optional[str] = None  # one of sextant.matcher_names(), for votes; None: to compare photos
    global_descriptor: Optional[GlobalDescriptorParams] = None  # None: keypoints only

    def feature_params(self) -> "sextant.FeatureParams":
        """The features as sextant.FeatureParams.

        :raises ValueError: an unknown field, a wrong type or a value out of range
        """
        return parse_struct(sextant.FeatureParams, self.features, "", "")

    def fine_params(self) -> Optional["sextant.FeatureParams"]:
        """Parameters of the fine keypoints of images larger than max_side; None: there are none.

        They distinguish places that look alike; the others recognize a place after months.
        """
        params = self.feature_params()
        is_measured = (params.detector, params.extractor) == ("SIFT", "SIFT")
        if self.matcher or not is_measured or not params.max_side:
            return None
        fine = {**self.features, **FINE, "max_side": min(2 * params.max_side, MAX_SIDE)}
        return parse_struct(sextant.FeatureParams, fine, "", "")

    def validate(self) -> None:
        """Checks the parameters.

        :raises OSError: the global descriptor's model cannot be read
        :raises ValueError: names the first invalid parameter and what is allowed
        """
        params = self.feature_params()
        if self.matcher:
            sextant.validate_matcher(self.matcher, params.extractor, params.orb_wta_k)
        if self.global_descriptor:
            cached_descriptor(self.global_descriptor)

    def as_json(self) -> Dict[str, Any]:
        """Values that are equal for equal parameters; a model is identified by its content, not by its path.

        :raises OSError: the model cannot be read
        """
        described = asdict(self)
        if self.global_descriptor:
            content = Path(self.global_descriptor.model).read_bytes()
            described["global_descriptor"]["model"] = content_digest(content)
            del described["global_descriptor"]["backend"]  # backends differ by rounding only
        return json.loads(json.dumps(described))  # tuples become lists, as when read from a file


def content_digest(content: bytes) -> str:
    """Hash of a file's content."""
    return hashlib.blake2b(content, digest_size=16).hexdigest()
