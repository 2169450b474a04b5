# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is known of a map's photos: keypoints, an index of all their descriptors, vectors of whole photos.

Keypoints are stored as 16-bit parts of a photo's longer side.
"""

import hashlib
import json
from dataclasses import asdict, dataclass, field
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, Callable, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

import cv2
import numpy as np

import sextant
from sextant.base.jobs import JobError, run_jobs
from sextant.place_maps.photo_file import decode_colour, decode_grey
from sextant.places.global_descriptor import GlobalDescriptor, GlobalDescriptorParams

UNIT = 65535  # of a keypoint's coordinates: the longer side of its photo
SAMPLES = 400_000  # descriptors that an index learns from, at most
SEED = 1
MOST_KEYPOINTS = 65536  # of a photo, that sextant.DescriptorIndex takes
NAMED_AT_MOST = 5  # photos in an error
FEATURE_FIELDS = tuple(name for name in vars(sextant.FeatureParams) if not name.startswith("_"))


def default_features() -> Dict[str, Any]:
    """The fields of sextant.FeatureParams, for a camera that does not roll."""
    return _fields(sextant.FeatureParams())


def plain_features(detector: str, extractor: str) -> Dict[str, Any]:
    """The fields of sextant.FeatureParams that leave everything to the detector and the extractor."""
    return _fields(sextant.FeatureParams.plain(detector, extractor))


# by name: of a detector and an extractor, the fields of sextant.FeatureParams
PROFILES: Dict[str, Callable[[str, str], Dict[str, Any]]] = {
    "tuned": lambda detector, extractor: {**default_features(), "detector": detector, "extractor": extractor},
    "plain": plain_features,
}


def _fields(params: "sextant.FeatureParams") -> Dict[str, Any]:
    return {name: getattr(params, name) for name in FEATURE_FIELDS if not callable(getattr(params, name))}


@dataclass(frozen=True)
class IndexParams:
    """How photos are described and compared; another setting is another index."""

    features: Dict[str, Any] = field(default_factory=default_features)  # fields of sextant.FeatureParams
    matcher: str = "faiss"  # any of sextant.matcher_names() that compares what the extractor makes
    global_descriptor: Optional[GlobalDescriptorParams] = None  # None: photos have keypoints only

    @classmethod
    def of_profile(
        cls,
        profile: str,
        detector: str,
        extractor: str,
        matcher: str,
        network: GlobalDescriptorParams,
        orb_wta_k: int,
        **tuned: int,
    ) -> "IndexParams":
        """As people choose them.

        :param profile: one of PROFILES
        :param network: without a model there is none
        :param tuned: fields of sextant.FeatureParams that only the profile `tuned` has
        """
        features = PROFILES[profile](detector, extractor)
        features.update(tuned if profile == "tuned" else {}, orb_wta_k=orb_wta_k)
        return cls(features, matcher, network if network.model else None)

    def feature_params(self) -> "sextant.FeatureParams":
        """:raises ValueError: an unknown field or a value out of range"""
        params = sextant.FeatureParams()
        for name, value in self.features.items():
            if name not in default_features():
                raise ValueError(f"{name}: unknown; known are {', '.join(default_features())}")
            setattr(params, name, value)
        params.validate()
        return params

    def validate(self) -> None:
        """:raises OSError: the global descriptor's model cannot be read
        :raises ValueError: names the first setting that cannot be, and what can
        """
        params = self.feature_params()
        sextant.validate_matcher(self.matcher, params.extractor, params.orb_wta_k)
        if self.global_descriptor:
            _descriptor_of(self.global_descriptor)

    def as_json(self) -> Dict[str, Any]:
        """What two params that are the same have in common: of a model its content, wherever it lies.

        :raises OSError: the model cannot be read
        """
        described = asdict(self)
        if self.global_descriptor:
            content = Path(self.global_descriptor.model).read_bytes()
            described["global_descriptor"]["model"] = content_digest(content)
            del described["global_descriptor"]["backend"]  # they differ by rounding only
        return json.loads(json.dumps(described))  # JSON has lists


NO_VECTOR = np.zeros(0, np.float32)
FileState = Tuple[int, int, int]  # bytes, and nanoseconds of the last change of content and of anything


class PhotoFeatures(NamedTuple):
    """What one photo gives."""

    digest: str  # of the file's content
    state: FileState
    keypoints: np.ndarray  # uint16 (n, 2): x, y in parts of the longer side
    descriptors: np.ndarray  # float32 or uint8 (n, width)
    vector: np.ndarray = NO_VECTOR  # float32 (d,) of GlobalDescriptor.describe(); d is 0 without one


class IndexedPhoto(NamedTuple):
    """A photo in the index, whichever place it shows."""

    image: str  # as the map names it
    digest: str
    state: FileState  # as long as it is the same, so is the digest
    owner: int  # of its descriptors
    first: int  # row of its keypoints
    count: int


def file_state(path: Path) -> FileState:
    """Of a photo; raises OSError where it is not there."""
    status = path.stat()
    return status.st_size, status.st_mtime_ns, status.st_ctime_ns


def content_digest(content: bytes) -> str:
    """Tells files apart by their content."""
    return hashlib.blake2b(content, digest_size=16).hexdigest()


def photo_features(params: IndexParams, path: Path) -> PhotoFeatures:
    """Reads a photo and describes it.

    :raises OSError: it cannot be read
    :raises ValueError: it is no picture, or not all of one
    """
    state, content = file_state(path), path.read_bytes()
    image, network = decode_photo(params, content, path), params.global_descriptor
    vector = _descriptor_of(network).describe(image) if network else NO_VECTOR
    found = sextant.FeatureExtractor(params.feature_params()).extract(image)
    if len(found.keypoints) > MOST_KEYPOINTS:
        raise ValueError(f"{len(found.keypoints)} keypoints, allowed are {MOST_KEYPOINTS}; set max_features")
    parts = found.keypoints[:, :2] * (UNIT / max(found.size))
    keypoints = np.clip(np.rint(parts), 0, UNIT).astype(np.uint16)
    return PhotoFeatures(content_digest(content), state, keypoints, found.descriptors, vector)


def decode_photo(params: IndexParams, content: bytes, path: Path) -> np.ndarray:
    """What is described of a photo: it in grey, or in colour for a global descriptor, at the size it takes.

    :raises: as decode_grey()
    """
    side = params.feature_params().max_side
    if not params.global_descriptor:
        return decode_grey(content, path, side)
    return decode_colour(content, path, side and max(side, *_descriptor_of(params.global_descriptor).size))


def _descriptor_of(params: GlobalDescriptorParams) -> GlobalDescriptor:
    """The one of this process, loaded once."""
    return _loaded(params, file_state(Path(params.model)), cv2.getNumThreads())


@lru_cache(maxsize=1)
def _loaded(params: GlobalDescriptorParams, _state: FileState, threads: int) -> GlobalDescriptor:
    return GlobalDescriptor(params, threads)


def extract_all(
    params: IndexParams, paths: Sequence[Path], jobs: int = 1, scheduler: str = ""
) -> List[PhotoFeatures]:
    """Of all photos, with a progress bar.

    :param jobs: scheduler: as in sextant.base.jobs.run_jobs()
    :raises ValueError: photos that cannot be used, by name
    """
    results = run_jobs(
        partial(photo_features, params), paths, jobs, scheduler, return_errors=True, progress="photos"
    )
    features = list(results)
    errors = [each for each in features if isinstance(each, JobError)]
    if errors:
        more = f"; and {len(errors) - NAMED_AT_MOST} more" if len(errors) > NAMED_AT_MOST else ""
        raise ValueError("; ".join(str(error) for error in errors[:NAMED_AT_MOST]) + more)
    return features


class PlaceIndex:
    """Photos, their keypoints and vectors, descriptors of all in one index. Searching is thread-safe."""

    def __init__(
        self,
        params: IndexParams,
        photos: Iterable[IndexedPhoto],
        keypoints: np.ndarray,
        descriptors: "sextant.DescriptorIndex",
        learned_from: int,
        vectors: Optional[np.ndarray] = None,
    ):
        self.params = params
        self.learned_from = learned_from  # photos, when it was made
        self.photos = list(photos)
        self.keypoints = keypoints  # uint16 (all, 2)
        self.descriptors = descriptors
        # float32 (photos, d): of every photo a unit vector; d is 0 without a global descriptor
        self.vectors = np.zeros((len(self.photos), 0), np.float32) if vectors is None else vectors

    @classmethod
    def built(
        cls, params: IndexParams, images: Sequence[str], features: Sequence[PhotoFeatures]
    ) -> "PlaceIndex":
        """:raises ValueError: the photos have nothing to be told apart by"""
        total = sum(len(each.descriptors) for each in features)
        if not total:
            raise ValueError("no keypoint in any photo of the map")
        descriptors = sextant.DescriptorIndex(params.matcher, _samples(features, total), total)
        keypoints = np.zeros((0, 2), np.uint16)
        vectors = np.zeros((0, len(features[0].vector)), np.float32)
        index = cls(params, [], keypoints, descriptors, len(features), vectors)
        index.add(images, features)
        return index

    def add(self, images: Sequence[str], features: Sequence[PhotoFeatures]) -> None:
        """Photos that are new, with owners from the highest one on."""
        if not images:  # what is mapped stays so
            return
        owner = 1 + max((photo.owner for photo in self.photos), default=-1)
        first = len(self.keypoints)
        for image, each in zip(images, features):
            count = len(each.keypoints)
            self.photos.append(IndexedPhoto(image, each.digest, each.state, owner, first, count))
            self.descriptors.add(owner, each.descriptors)
            owner, first = owner + 1, first + count
        self.keypoints = np.concatenate([self.keypoints, *(each.keypoints for each in features)])
        self.vectors = np.concatenate([self.vectors, *(each.vector[np.newaxis] for each in features)])

    def remove(self, photos: Iterable[IndexedPhoto]) -> None:
        """Takes photos out; the keypoints of the others move together."""
        gone = {photo.owner for photo in photos}
        for owner in gone:
            self.descriptors.remove(owner)
        if not gone:  # what is mapped stays so
            return
        self.vectors = self.vectors[[photo.owner not in gone for photo in self.photos]]
        kept = [photo for photo in self.photos if photo.owner not in gone]
        self.keypoints = np.concatenate([self.keypoints[:0], *(self.keypoints_of(photo) for photo in kept)])
        firsts = np.cumsum([0, *(photo.count for photo in kept)])
        self.photos = [photo._replace(first=int(first)) for photo, first in zip(kept, firsts)]

    def keypoints_of(self, photo: IndexedPhoto) -> np.ndarray:
        """uint16 (n, 2): x, y in parts of the longer side."""
        return self.keypoints[photo.first : photo.first + photo.count]

    @property
    def bytes(self) -> int:
        """Of memory that descriptors, keypoints and vectors take."""
        return self.descriptors.bytes + self.keypoints.nbytes + self.vectors.nbytes


def _samples(features: Sequence[PhotoFeatures], total: int) -> np.ndarray:
    """Descriptors to learn from: all, or as many as are enough, evenly drawn."""
    chosen = np.arange(total)
    if total > SAMPLES:
        chosen = np.sort(np.random.default_rng(SEED).choice(total, SAMPLES, replace=False))
    ends = np.cumsum([len(each.descriptors) for each in features])
    parts = np.split(chosen, np.searchsorted(chosen, ends[:-1]))
    firsts = [0, *ends[:-1]]
    picked = [each.descriptors[part - first] for each, part, first in zip(features, parts, firsts)]
    return np.concatenate([part for part in picked if len(part)])
