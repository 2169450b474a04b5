# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Index of a map's photos: their keypoints, the index of their descriptors, and their global descriptors.

Keypoints are stored as 16-bit fractions of a photo's longer side.
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
from sextant.base.strict_params import parse_struct
from sextant.place_maps.photo_file import decode_colour, decode_grey
from sextant.places.global_descriptor import GlobalDescriptor, GlobalDescriptorParams

UNIT = 65535  # stored coordinate that corresponds to the photo's longer side
SAMPLES = 400_000  # maximum number of training descriptors of an index
SEED = 1  # of the choice of training descriptors
MAX_KEYPOINTS = 65536  # per photo, a limit of sextant.DescriptorIndex
MAX_NAMES = 5  # maximum number of photos named in a message


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
    matcher: str = "faiss"  # one of sextant.matcher_names() that fits the extractor
    global_descriptor: Optional[GlobalDescriptorParams] = None  # None: keypoints only

    def feature_params(self) -> "sextant.FeatureParams":
        """The features as sextant.FeatureParams.

        :raises ValueError: an unknown field, a wrong type or a value out of range
        """
        return parse_struct(sextant.FeatureParams, self.features, "", "")

    def validate(self) -> None:
        """Checks the parameters.

        :raises OSError: the global descriptor's model cannot be read
        :raises ValueError: names the first invalid parameter and what is allowed
        """
        params = self.feature_params()
        sextant.validate_matcher(self.matcher, params.extractor, params.orb_wta_k)
        if self.global_descriptor:
            _descriptor_of(self.global_descriptor)

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


NO_VECTOR = np.zeros(0, np.float32)
FileState = Tuple[int, int, int]  # size in bytes, mtime and ctime in nanoseconds


class PhotoFeatures(NamedTuple):
    """Features of one photo."""

    digest: str  # of the file's content
    state: FileState  # of the file, to detect changes
    keypoints: np.ndarray  # uint16 (n, 2): x, y; UNIT is the longer side
    descriptors: np.ndarray  # float32 or uint8 (n, width)
    vector: np.ndarray = NO_VECTOR  # float32 (d,) global descriptor; d is 0 without one


class IndexedPhoto(NamedTuple):
    """A photo in the index."""

    image: str  # file name, as in the map
    digest: str  # of the file's content
    state: FileState  # if it is unchanged, the file is not read again
    image_id: int  # of its descriptors in the descriptor index
    first: int  # row of its first keypoint
    count: int  # number of keypoints


def file_state(path: Path) -> FileState:
    """State of a file; raises OSError if it does not exist."""
    status = path.stat()
    return status.st_size, status.st_mtime_ns, status.st_ctime_ns


def content_digest(content: bytes) -> str:
    """Hash of a file's content."""
    return hashlib.blake2b(content, digest_size=16).hexdigest()


def photo_features(params: IndexParams, path: Path) -> PhotoFeatures:
    """Reads a photo and extracts its found.

    :raises OSError: it cannot be read
    :raises ValueError: it is not an image, is damaged, or has too many keypoints
    """
    state, content = file_state(path), path.read_bytes()
    image, network = decode_photo(params, content, path), params.global_descriptor
    vector = _descriptor_of(network).describe(image) if network else NO_VECTOR
    found = sextant.FeatureExtractor(params.feature_params()).extract(image)
    if len(found.keypoints) > MAX_KEYPOINTS:
        raise ValueError(f"{len(found.keypoints)} keypoints, allowed are {MAX_KEYPOINTS}; set max_features")
    scaled = found.keypoints[:, :2] * (UNIT / max(found.size))
    keypoints = np.clip(np.rint(scaled), 0, UNIT).astype(np.uint16)
    return PhotoFeatures(content_digest(content), state, keypoints, found.descriptors, vector)


def decode_photo(params: IndexParams, content: bytes, path: Path) -> np.ndarray:
    """Decodes a photo for description: grey, or BGR for a global descriptor; large photos are reduced.

    :raises: as decode_grey()
    """
    side = params.feature_params().max_side
    if not params.global_descriptor:
        return decode_grey(content, path, side)
    return decode_colour(content, path, side and max(side, *_descriptor_of(params.global_descriptor).size))


def _descriptor_of(params: GlobalDescriptorParams) -> GlobalDescriptor:
    """The global descriptor, cached by this process until its file changes."""
    return _loaded(params, file_state(Path(params.model)), cv2.getNumThreads())


@lru_cache(maxsize=1)
def _loaded(params: GlobalDescriptorParams, _state: FileState, threads: int) -> GlobalDescriptor:
    return GlobalDescriptor(params, threads)


def extract_all(
    params: IndexParams, paths: Sequence[Path], jobs: int = 1, scheduler: str = ""
) -> List[PhotoFeatures]:
    """Extracts the features of photos, with a progress bar.

    :param jobs: scheduler: see sextant.base.jobs.run_jobs()
    :raises ValueError: names the photos that cannot be used
    """
    results = run_jobs(
        partial(photo_features, params), paths, jobs, scheduler, return_errors=True, progress="photos"
    )
    features = list(results)
    errors = [each for each in features if isinstance(each, JobError)]
    if errors:
        more = f"; and {len(errors) - MAX_NAMES} more" if len(errors) > MAX_NAMES else ""
        raise ValueError("; ".join(str(error) for error in errors[:MAX_NAMES]) + more)
    return features


class PlaceIndex:
    """Photos with their keypoints, descriptors and global descriptors. Searching is thread-safe."""

    def __init__(
        self,
        params: IndexParams,
        photos: Iterable[IndexedPhoto],
        keypoints: np.ndarray,
        descriptors: "sextant.DescriptorIndex",
        learned_from: int,
        vectors: Optional[np.ndarray] = None,
    ):
        """:param photos: see IndexedPhoto

        :param keypoints: uint16 (n, 2) of all photos, in units of the longer side / UNIT
        :param descriptors: of all photos
        :param learned_from: number of photos that trained the descriptor index
        :param vectors: float32 (photos, d) unit vectors; None: no global descriptor
        """
        self.params = params
        self.learned_from = learned_from
        self.photos = list(photos)
        self.keypoints = keypoints
        self.descriptors = descriptors
        self.vectors = np.zeros((len(self.photos), 0), np.float32) if vectors is None else vectors

    @classmethod
    def built(
        cls, params: IndexParams, images: Sequence[str], features: Sequence[PhotoFeatures]
    ) -> "PlaceIndex":
        """A new index of photos.

        :param images: file names, as in the map
        :raises ValueError: no photo has a keypoint
        """
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
        """Adds photos that are not in the index."""
        if not images:  # keeps the arrays memory-mapped
            return
        image_id = 1 + max((photo.image_id for photo in self.photos), default=-1)
        first = len(self.keypoints)
        for image, each in zip(images, features):
            count = len(each.keypoints)
            self.photos.append(IndexedPhoto(image, each.digest, each.state, image_id, first, count))
            self.descriptors.add(image_id, each.descriptors)
            image_id, first = image_id + 1, first + count
        self.keypoints = np.concatenate([self.keypoints, *(each.keypoints for each in features)])
        self.vectors = np.concatenate([self.vectors, *(each.vector[np.newaxis] for each in features)])

    def remove(self, photos: Iterable[IndexedPhoto]) -> None:
        """Removes photos; renumbers the rows of the other keypoints."""
        removed = {photo.image_id for photo in photos}
        for image_id in removed:
            self.descriptors.remove(image_id)
        if not removed:  # keeps the arrays memory-mapped
            return
        self.vectors = self.vectors[[photo.image_id not in removed for photo in self.photos]]
        kept = [photo for photo in self.photos if photo.image_id not in removed]
        self.keypoints = np.concatenate([self.keypoints[:0], *(self.keypoints_of(photo) for photo in kept)])
        firsts = np.cumsum([0, *(photo.count for photo in kept)])
        self.photos = [photo._replace(first=int(first)) for photo, first in zip(kept, firsts)]

    def keypoints_of(self, photo: IndexedPhoto) -> np.ndarray:
        """Keypoints of a photo, uint16 (n, 2): x, y; UNIT is the longer side."""
        return self.keypoints[photo.first : photo.first + photo.count]

    @property
    def bytes(self) -> int:
        """Memory of descriptors, keypoints and vectors, bytes."""
        return self.descriptors.bytes + self.keypoints.nbytes + self.vectors.nbytes


def _samples(features: Sequence[PhotoFeatures], total: int) -> np.ndarray:
    """Descriptors that train the index: all of them, or a uniform sample of SAMPLES."""
    rows = np.arange(total)
    if total > SAMPLES:
        rows = np.sort(np.random.default_rng(SEED).choice(total, SAMPLES, replace=False))
    ends = np.cumsum([len(each.descriptors) for each in features])
    parts = np.split(rows, np.searchsorted(rows, ends[:-1]))
    firsts = [0, *ends[:-1]]
    samples = [each.descriptors[part - first] for each, part, first in zip(features, parts, firsts)]
    return np.concatenate([each for each in samples if len(each)])
