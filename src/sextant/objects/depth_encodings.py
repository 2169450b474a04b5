# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Conversion of depth images in the encodings of REP 118."""

import numpy as np


def metres_of(depth: np.ndarray) -> np.ndarray:
    """Convert a depth image (uint16 mm or float32 m) to float32 metres; 0: no depth.

    :raises ValueError: another shape or type
    """
    if depth.ndim == 2 and depth.dtype == np.uint16:
        return depth.astype(np.float32) * np.float32(1e-3)
    if depth.ndim == 2 and depth.dtype == np.float32:
        return np.where(np.isfinite(depth) & (depth > 0), depth, np.float32(0))
    raise ValueError(f"a depth image is {depth.dtype} {depth.shape}, it must be 16UC1 (mm) or 32FC1 (m)")
