# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The keypoints of all photos of a map, with which those of an image are compared."""

from typing import NamedTuple, Sequence

import numpy as np

import sextant
from sextant.places.descriptor_codes import DescriptorCodes

UNIT = 65535  # stored coordinate that corresponds to the photo's longer side
BACKGROUND = 16  # k of sextant.photo_scores()
NO_MATCHES = 1e-3  # added to the scores before the logarithm


class Keypoints(NamedTuple):
    """Keypoints of one image or photo, strongest first."""

    positions: np.ndarray  # uint16 (n, 2): x, y; UNIT is the longer side
    descriptors: np.ndarray  # float32 or uint8 (n, w)


class CodedKeypoints(NamedTuple):
    """Keypoints of one image or photo, with the codes of their descriptors."""

    positions: np.ndarray  # uint16 (n, 2): x, y; UNIT is the longer side
    codes: np.ndarray  # int8 (n, d)


class KeypointScores(NamedTuple):
    """Scores of photos for an image, see sextant.photo_scores()."""

    logs: np.ndarray  # (photos,) at least 0: logarithm of the product of both scores over that of no match
    nearest: np.ndarray  # (n,) distance of each keypoint's descriptor from the most similar one of all photos
    background: np.ndarray  # (n,) distance from those that do not match, in codes


class PhotoKeypoints:
    """Keypoints of one kind (extracted with the same parameters) of all photos, in the photos' order."""

    def __init__(
        self, coder: DescriptorCodes, positions: np.ndarray, codes: np.ndarray, counts: Sequence[int]
    ):
        """:param coder: of the codes

        :param positions: uint16 (n, 2)
        :param codes: int8 (n, d)
        :param counts: (photos,) number of keypoints of each photo; their sum is n
        """
        self.coder, self.positions, self.codes = coder, positions, codes
        self._count(counts)

    @classmethod
    def empty(cls, samples: np.ndarray, width: int) -> "PhotoKeypoints":
        """No photos yet.

        :param samples: descriptors that the codes are learned from
        :param width: of the codes; 0: without codes
        """
        coder = DescriptorCodes.learned(samples, width)
        return cls(coder, np.zeros((0, 2), np.uint16), np.zeros((0, coder.basis.shape[1]), np.int8), [])

    @property
    def bytes(self) -> int:
        """Memory of positions and codes."""
        return self.positions.nbytes + self.codes.nbytes

    def _count(self, counts: Sequence[int]) -> None:
        self.counts = np.asarray(counts, int)  # (photos,) number of keypoints of each photo
        self.firsts = np.cumsum(self.counts) - self.counts  # (photos,) first row of each photo

    def add(self, photos: Sequence[Keypoints]) -> None:
        """Adds photos after the others."""
        codes = [self.coder.encode(each.descriptors) for each in photos]
        self.codes = np.concatenate([self.codes, *codes])
        self.positions = np.concatenate([self.positions, *(each.positions for each in photos)])
        self._count([*self.counts, *(len(each) for each in codes)])

    def keep(self, kept: np.ndarray) -> None:
        """Removes photos.

        :param kept: bool (photos,) whether each remains
        """
        rows = np.repeat(kept, self.counts)
        self.positions, self.codes = self.positions[rows], self.codes[rows]
        self._count(self.counts[kept])

    def of(self, number: int) -> CodedKeypoints:
        """The keypoints of one photo."""
        rows = slice(self.firsts[number], self.firsts[number] + self.counts[number])
        return CodedKeypoints(self.positions[rows], self.codes[rows])

    def encode(self, image: Keypoints) -> CodedKeypoints:
        """The keypoints of an image, with codes."""
        return CodedKeypoints(image.positions, self.coder.encode(image.descriptors))

    def scores(self, image: CodedKeypoints, numbers: np.ndarray) -> KeypointScores:
        """Compares an image with photos.

        :param numbers: int (m,) of the photos
        """
        distinctive, consistent, background, nearest = sextant.photo_scores(
            image.positions, image.codes, self.positions, self.codes,
            self.firsts[numbers], self.counts[numbers], BACKGROUND,
        )  # fmt: skip
        logs = np.log1p(distinctive / NO_MATCHES) + np.log1p(consistent / NO_MATCHES)
        return KeypointScores(_neutral(logs, self.counts[numbers]), nearest / self.coder.scale, background)


def _neutral(logs: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Scores in which photos without keypoints, such as small ones, get the median of the others."""
    empty = counts == 0
    return logs if not empty.any() or empty.all() else np.where(empty, np.median(logs[~empty]), logs)
