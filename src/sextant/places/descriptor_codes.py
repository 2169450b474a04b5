# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Short codes of descriptors: their principal components, rounded to 8 bits."""

from typing import NamedTuple

import numpy as np

LARGEST = 127  # code
CLIPPED = 0.9995  # quantile of the absolute principal components that gets the largest code
MIN_COMPONENT = 1e-6  # smaller quantiles are raised to it: all samples may be equal


class DescriptorCodes(NamedTuple):
    """Projection of descriptors to their principal components."""

    mean: np.ndarray  # float32 (w,) of the samples
    basis: np.ndarray  # float32 (w, d) principal components as columns, all of the same length

    @classmethod
    def learned(cls, samples: np.ndarray, width: int) -> "DescriptorCodes":
        """The principal components of some descriptors.

        :param samples: (n, w) float32, or (n, w / 8) uint8 of binary descriptors
        :param width: d of the codes; at most w of them are used
        """
        values = _values(samples if width else samples[:0])
        if not width:
            return cls(np.zeros(values.shape[1], np.float32), np.zeros((values.shape[1], 0), np.float32))
        mean = values.mean(axis=0) if len(values) else np.zeros(values.shape[1], np.float32)
        centred = values - mean
        _, vectors = np.linalg.eigh(centred.T @ centred)  # in ascending order
        basis = vectors[:, ::-1][:, :width].astype(np.float32)
        largest = np.quantile(np.abs(centred @ basis), CLIPPED) if len(values) else 1.0
        return cls(mean, np.ascontiguousarray(basis * np.float32(LARGEST / max(largest, MIN_COMPONENT))))

    @property
    def scale(self) -> float:
        """Distance of two codes over that of their descriptors."""
        return float(np.linalg.norm(self.basis[:, 0]))

    def encode(self, descriptors: np.ndarray) -> np.ndarray:
        """Codes int8 (n, d) of descriptors, of the samples' type and width."""
        if not self.basis.shape[1]:
            return np.zeros((len(descriptors), 0), np.int8)
        components = (_values(descriptors) - self.mean) @ self.basis
        return np.clip(np.rint(components), -LARGEST, LARGEST).astype(np.int8)


def _values(descriptors: np.ndarray) -> np.ndarray:
    """Descriptors as float32 (n, w): each bit of a binary one is a value."""
    values = np.unpackbits(descriptors, axis=1) if descriptors.dtype == np.uint8 else descriptors
    return values.astype(np.float32)
