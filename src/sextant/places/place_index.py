# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Features of all photos of a map."""

from typing import Iterable, List, NamedTuple, Optional, Sequence

import numpy as np

import sextant
from sextant.places.index_params import IndexParams
from sextant.places.photo_features import FileState, PhotoFeatures
from sextant.places.photo_keypoints import CodedKeypoints, Keypoints, PhotoKeypoints

WIDTHS = (64, 32)  # of the codes of each kind of keypoints
SAMPLES = 100_000  # maximum number of training descriptors
SEED = 1  # of the choice of training descriptors
SEARCHED = 128  # keypoints of a photo of a large map, the strongest ones, by which it becomes a candidate
EXHAUSTIVE = 800  # maximum number of photos with each of which an image is compared


class IndexedPhoto(NamedTuple):
    """A photo in the index."""

    image: str  # file name, as in the map
    digest: str  # of the file's content
    state: FileState  # if it is unchanged, the file is not read again
    image_id: int  # of its descriptors in the descriptor index
    count: int  # number of keypoints of all kinds


class ComparedPhotos(NamedTuple):
    """Some photos of an index compared with all others: what the scores of other places are in this map."""

    rows: np.ndarray  # int (m,) of the compared photos
    scores: np.ndarray  # float32 (kinds, m, photos) see place_scores.PhotoScores.logs; nan: the photo itself


def is_large(photos: int) -> bool:
    """Whether a search finds candidates, instead of comparing an image with each of the photos."""
    return photos > EXHAUSTIVE and sextant.has_faiss()


class PlaceIndex:
    """Photos with their keypoints and global descriptors. Searching is thread-safe."""

    def __init__(
        self,
        params: IndexParams,
        photos: Iterable[IndexedPhoto],
        keypoints: Sequence[PhotoKeypoints],
        descriptors: "Optional[sextant.DescriptorIndex]",
        learned_from: int,
        vectors: Optional[np.ndarray] = None,
        compared: Optional[ComparedPhotos] = None,
    ):
        """:param photos: see IndexedPhoto

        :param keypoints: of the photos, for each kind
        :param descriptors: nearest neighbours of the first kind: of its descriptors if the parameters name a
            matcher, else of its codes; None: there are few photos
        :param learned_from: number of photos that trained the codes and the descriptor index
        :param vectors: float32 (photos, d) unit vectors; None: no global descriptor
        :param compared: None: not yet; adding and removing photos discards it
        """
        self.params = params
        self.learned_from = learned_from
        self.photos = list(photos)
        self.keypoints = list(keypoints)
        self.descriptors = descriptors
        self.vectors = np.zeros((len(self.photos), 0), np.float32) if vectors is None else vectors
        self.compared = compared
        self.is_incomplete = False  # whether photos were added with a kind of keypoints that it does not have
        self._image_ids: Optional[np.ndarray] = None  # (photos,) made when it is needed

    @classmethod
    def built(
        cls,
        params: IndexParams,
        images: Sequence[str],
        features: Sequence[PhotoFeatures],
        expected: Optional[int] = None,
    ) -> "PlaceIndex":
        """A new index of photos.

        :param images: file names, as in the map
        :param expected: number of photos when all have been added; None: no more are
        :raises ValueError: no photo has a keypoint
        """
        kinds = [[each.descriptors for each in kind] for kind in zip(*(each.kinds for each in features))]
        if not any(map(len, kinds[0])):
            raise ValueError("no keypoint in any photo of the map")
        samples = [_samples(kind) for kind in kinds if any(map(len, kind))]
        widths = [0] if params.matcher else WIDTHS
        keypoints = [PhotoKeypoints.empty(each, width) for each, width in zip(samples, widths)]
        expected = expected or len(images)
        total = sum(map(len, kinds[0])) * expected // len(images)
        descriptors = _descriptor_index(params.matcher, expected, total, samples[0], keypoints[0])
        vectors = np.zeros((0, len(features[0].vector)), np.float32)
        index = cls(params, [], keypoints, descriptors, expected, vectors)
        index.add(images, features)
        return index

    def add(self, images: Sequence[str], features: Sequence[PhotoFeatures]) -> None:
        """Adds photos that are not in the index."""
        if not images:  # keeps the arrays memory-mapped
            return
        self.compared = self._image_ids = None
        image_id = 1 + max((photo.image_id for photo in self.photos), default=-1)
        for number, (image, each) in enumerate(zip(images, features), image_id):
            self.photos.append(IndexedPhoto(image, each.digest, each.state, number, each.count))
            if self.descriptors is not None:
                self.descriptors.add(number, self.searched(each.kinds[0]))
        self.is_incomplete |= any(len(kind.positions) for each in features for kind in self._lacking(each))
        for number, kind in enumerate(self.keypoints):
            kind.add([each.kinds[number] for each in features])
        self.vectors = np.concatenate([self.vectors, *(each.vector[np.newaxis] for each in features)])

    def _lacking(self, features: PhotoFeatures) -> Sequence[Keypoints]:
        """Kinds of keypoints that this index does not have."""
        return features.kinds[len(self.keypoints) :]

    def remove(self, photos: Iterable[IndexedPhoto]) -> None:
        """Removes photos; renumbers the others."""
        removed = {photo.image_id for photo in photos}
        if not removed:  # keeps the arrays memory-mapped
            return
        self.compared = self._image_ids = None
        if self.descriptors is not None:
            for image_id in removed:
                self.descriptors.remove(image_id)
        kept = np.array([photo.image_id not in removed for photo in self.photos])
        for kind in self.keypoints:
            kind.keep(kept)
        self.vectors = self.vectors[kept]
        self.photos = [photo for photo in self.photos if photo.image_id not in removed]

    def numbers(self, rows: np.ndarray) -> np.ndarray:
        """Index in rows by image_id; -1: a photo that is not among them, and image_id -1.

        :param rows: int (m,) of photos
        """
        if self._image_ids is None:
            self._image_ids = np.array([photo.image_id for photo in self.photos])
        numbers = np.full(2 + self._image_ids.max(initial=0), -1)  # the last element is that of -1
        numbers[self._image_ids[rows]] = np.arange(len(rows))
        return numbers

    def searched(self, keypoints: Keypoints) -> np.ndarray:
        """What the descriptor index contains of keypoints of the first kind."""
        if self.params.matcher:
            return keypoints.descriptors
        return _values(self.keypoints[0].coder.encode(keypoints.descriptors[:SEARCHED]))

    def encode(self, kinds: Sequence[Keypoints]) -> List[CodedKeypoints]:
        """Codes of the keypoints of an image, for each kind that the index has."""
        return [kind.encode(each) for kind, each in zip(self.keypoints, kinds)]

    @property
    def bytes(self) -> int:
        """Memory of descriptors, keypoints and vectors, bytes."""
        searched = self.descriptors.bytes if self.descriptors is not None else 0
        return searched + sum(kind.bytes for kind in self.keypoints) + self.vectors.nbytes


def _descriptor_index(
    matcher: Optional[str], photos: int, total: int, samples: np.ndarray, keypoints: PhotoKeypoints
) -> "Optional[sextant.DescriptorIndex]":
    """An empty index, for the matcher or, without one, for the codes of a large map; None for a small one.

    :param total: expected number of descriptors
    :param samples: descriptors to learn from
    :param keypoints: of the first kind
    """
    if matcher:
        return sextant.DescriptorIndex(matcher, samples, total)
    if is_large(photos):
        values = _values(keypoints.coder.encode(samples))
        return sextant.DescriptorIndex("faiss", values, min(total, SEARCHED * photos))
    return None


def _values(codes: np.ndarray) -> np.ndarray:
    return codes.astype(np.float32)


def _samples(descriptors: Sequence[np.ndarray]) -> np.ndarray:
    """Descriptors to learn from: all of them, or a uniform sample of SAMPLES."""
    ends = np.cumsum([len(each) for each in descriptors])
    rows = np.arange(ends[-1])
    if len(rows) > SAMPLES:
        rows = np.sort(np.random.default_rng(SEED).choice(ends[-1], SAMPLES, replace=False))
    parts = np.split(rows, np.searchsorted(rows, ends[:-1]))
    samples = [each[part - first] for each, part, first in zip(descriptors, parts, [0, *ends[:-1]])]
    return np.concatenate([each for each in samples if len(each)])
