# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Codes of descriptors whose principal components are known."""

import numpy as np
import pytest

from sextant.places.descriptor_codes import LARGEST, DescriptorCodes


def drawn(rng, count=4000):
    """Descriptors (count, 5) with variance in two directions only, and these directions (5, 2)."""
    directions = np.linalg.qr(rng.normal(size=(5, 2)))[0]
    components = rng.normal(size=(count, 2)) * [30.0, 10.0]
    return (components @ directions.T + [1, 2, 3, 4, 5]).astype(np.float32), directions


def test_the_basis_are_the_principal_components():
    descriptors, directions = drawn(np.random.default_rng(1))
    codes = DescriptorCodes.learned(descriptors, 2)
    cosines = np.abs(codes.basis.T @ directions) / codes.scale
    assert cosines == pytest.approx(np.eye(2), abs=0.03)


def test_distances_of_codes_are_those_of_the_descriptors_times_the_scale():
    descriptors, _ = drawn(np.random.default_rng(2))
    coder = DescriptorCodes.learned(descriptors, 2)
    codes = coder.encode(descriptors)
    assert codes.dtype == np.int8
    kept = np.abs(codes).max(axis=1) < LARGEST
    descriptors, codes = descriptors[kept], codes[kept].astype(float)
    exact = np.linalg.norm(descriptors[0] - descriptors[1:], axis=1)
    found = np.linalg.norm(codes[0] - codes[1:], axis=1) / coder.scale
    assert np.abs(found - exact).max() < 2 / coder.scale  # rounding of two codes of two components


def test_few_codes_are_clipped():
    descriptors, _ = drawn(np.random.default_rng(3))
    coder = DescriptorCodes.learned(descriptors, 2)
    assert np.mean(np.abs(coder.encode(descriptors)) == LARGEST) < 0.002
    assert np.abs(coder.encode(1000 * descriptors).astype(int)).max() == LARGEST


def test_bits_of_binary_descriptors_are_values():
    bytes_ = np.random.default_rng(4).integers(0, 256, (3000, 4), np.uint8)
    coder = DescriptorCodes.learned(bytes_, 32)
    codes = coder.encode(bytes_).astype(float)
    hamming = np.unpackbits(bytes_[:1] ^ bytes_[1:], axis=1).sum(axis=1)
    assert np.linalg.norm(codes[0] - codes[1:], axis=1) / coder.scale == pytest.approx(
        np.sqrt(hamming), rel=0.05
    )


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("samples", [np.zeros((0, 5), np.float32), np.full((3, 5), 7, np.float32)])
def test_nothing_to_learn_from_gives_codes_all_the_same(samples):
    coder = DescriptorCodes.learned(samples, 2)
    assert coder.encode(samples).shape == (len(samples), 2)
    assert not coder.encode(samples).any()


def test_without_width_there_are_no_codes():
    descriptors, _ = drawn(np.random.default_rng(5), 10)
    assert DescriptorCodes.learned(descriptors, 0).encode(descriptors).shape == (10, 0)
