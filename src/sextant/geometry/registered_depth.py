# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Depth images in the view of another camera."""

from typing import Tuple

import numpy as np

import sextant

MAX_SPREAD = 0.05  # of the depths around a pixel by their median; beyond, it is at an edge
MIN_KNOWN = 4  # of the nine depths around a pixel


class DepthRegistration:
    """Takes the images of a depth camera to the view of a colour camera."""

    def __init__(
        self, colour: "sextant.CameraModel", depth: "sextant.CameraModel", T_colour_depth: np.ndarray
    ):
        """:param T_colour_depth: (4, 4) from the depth to the colour camera's optical frame, metres"""
        width, height = depth.size
        pixels = np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1).reshape(-1, 2)
        self._rays = depth.rays(pixels) @ T_colour_depth[:3, :3].T
        self._offset, self._colour, self._size = T_colour_depth[:3, 3], colour, depth.size
        # As large as a pixel of the depth image, so that few cells remain without a depth.
        self._cell = max(1, round(colour.focal_length / depth.focal_length))

    def registered(self, depth: np.ndarray) -> np.ndarray:
        """Depth in cells of the colour image, of the nearest surface.

        :param depth: float32 (height, width) of the depth camera, metres, 0: none
        :returns: float32 (height, width) of the colour image by the size of a cell; metres along the colour
            camera's optical axis, 0: none
        :raises ValueError: the image does not have the depth camera's size
        """
        if depth.shape[::-1] != self._size:
            sizes = (f"{width} x {height}" for width, height in (depth.shape[::-1], self._size))
            raise ValueError("the depth image has {} pixels, its camera_info {}".format(*sizes))
        points = self._rays * depth.reshape(-1, 1) + self._offset
        points = points[(depth.ravel() > 0) & (points[:, 2] > 0)]
        points = points[np.argsort(-points[:, 2], kind="stable")]  # the nearest is assigned last
        pixels = self._colour.project_points(points)
        width, height = (-(-side // self._cell) for side in self._colour.size)
        at = np.floor((np.nan_to_num(pixels, nan=-1.0) + 0.5) / self._cell).astype(int)
        inside = np.all((at >= 0) & (at < [width, height]), axis=1)
        found = np.zeros((height, width), np.float32)
        found[at[inside, 1], at[inside, 0]] = points[inside, 2]
        return found


def depths_at(depth: np.ndarray, pixels: np.ndarray, size: Tuple[int, int]) -> np.ndarray:
    """Median depths (n,) around pixels; NaN: few are known, or they differ as at an edge.

    :param depth: of DepthRegistration.registered()
    :param pixels: (n, 2) of the colour image, (0, 0) is the centre of the first one; NaN: no depth
    :param size: width and height of the colour image, pixels
    """
    height, width = depth.shape
    padded = np.full((height + 2, width + 2), np.nan)
    padded[1:-1, 1:-1] = np.where(depth > 0, depth, np.nan)
    cell = round(size[0] / width)
    at = np.floor((np.nan_to_num(pixels, nan=-1e6) + 0.5) / cell).astype(int)
    inside = np.all((at >= 0) & (at < [width, height]), axis=1)
    x, y = np.where(inside[:, None], at, 0).T
    around = np.stack([padded[y + i, x + j] for i in range(3) for j in range(3)])
    known = inside & (np.isfinite(around).sum(axis=0) >= MIN_KNOWN)
    found = np.full(len(pixels), np.nan)
    around = around[:, known]
    middle = np.nanmedian(around, axis=0)
    flat = np.nanmax(around, axis=0) - np.nanmin(around, axis=0) <= MAX_SPREAD * middle
    found[np.flatnonzero(known)[flat]] = middle[flat]
    return found
