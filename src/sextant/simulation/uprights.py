# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Textures that stand upright on the ground, and their images in a camera that looks along the ground."""

from typing import NamedTuple, Optional, Tuple

import cv2
import numpy as np

COARSER = 4  # ratio of texel sizes of successive levels of detail
SHARP = 1.5  # texels per pixel above which a texture is reduced


class Upright(NamedTuple):
    """A lit texture that stands upright on the ground between two points."""

    left: np.ndarray  # (2,) left end seen from the front, metres
    right: np.ndarray  # (2,) right end, metres
    height: float  # metres
    grey: np.ndarray  # uint8 (rows, columns)
    mask: Optional[np.ndarray]  # uint8, opacity; None: opaque
    coarse: Optional["Upright"] = None  # next level of detail


class UprightView(NamedTuple):
    """Camera with a horizontal optical axis; x, y, eye and near in metres, the rest in pixels."""

    x: float  # in the map
    y: float  # in the map
    yaw: float  # of the optical axis, radians
    width: int  # of the image
    height: int  # of the image
    f: float  # focal length
    horizon: float  # row
    eye: float  # height above the ground; negative: the mirror image below it
    near: float = 0.5  # clipping distance

    @property
    def centre(self) -> Tuple[float, float]:
        """Pixel of the optical axis."""
        return (self.width - 1) / 2, self.horizon

    def depth_and_right(self, points: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Depth and lateral offset of points (n, 2) on the ground, metres."""
        offset = points - (self.x, self.y)
        cosine, sine = np.cos(self.yaw), np.sin(self.yaw)
        return offset @ (cosine, sine), offset @ (sine, -cosine)


class UprightImage(NamedTuple):
    """What a camera shows of an upright."""

    box: Tuple[int, int, int, int]  # left, top, right and bottom in the image, pixels
    grey: np.ndarray  # uint8 (rows, columns) of the box
    opaque: Optional[np.ndarray]  # float32 (rows, columns), opacity, [0, 1]; None: not computed
    nearest: float  # depth of the nearest visible part, metres


def with_coarse(upright: Upright) -> Upright:
    """The upright with its coarser levels of detail."""
    if min(upright.grey.shape) < 2 * COARSER**2:
        return upright
    size = tuple(side // COARSER for side in upright.grey.shape[::-1])
    grey, mask = (
        None if each is None else cv2.resize(each, size, interpolation=cv2.INTER_AREA)
        for each in (upright.grey, upright.mask)
    )
    return upright._replace(coarse=with_coarse(upright._replace(grey=grey, mask=mask)))


def upright_image(
    upright: Upright, view: UprightView, columns: Optional[Tuple[int, int]] = None
) -> Optional[UprightImage]:
    """Projects an upright; None if it is not in the image.

    :param columns: the first column to show, and the one after the last; the upright must cover all of them,
        as its opacity is not computed. None: all
    """
    depth, right = view.depth_and_right(np.array([upright.left, upright.right]))
    parts = _visible(depth, right, (view.width / 2 + 1) / view.f, view.near)
    nearest = (depth[0] + np.array(parts) * (depth[1] - depth[0])).min()
    upright, scale = _sharp_enough(upright, view.f / max(nearest, view.near))
    count = upright.grey.shape[1]
    first, last = int(parts[0] * (count - 1)), int(np.ceil(parts[1] * (count - 1)))
    if last - first < 2:
        return None
    parts = np.array([first, last]) / (count - 1)
    depth, right = (each[0] + parts * (each[1] - each[0]) for each in (depth, right))
    corners = _projected(view, depth, right, upright.height)
    box = _box(corners, columns or (0, view.width), view.height)
    grey, mask = (_reduced(each, first, last, scale) for each in (upright.grey, upright.mask))
    if box is None or min(grey.shape) < 2:
        return None
    H, size = _to_box(grey.shape, corners, box)
    warped = cv2.warpPerspective(grey, H, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    if columns is not None:
        return UprightImage(box, warped, None, depth.min())
    opaque = cv2.warpPerspective(np.full_like(grey, 255) if mask is None else mask, H, size)
    return UprightImage(box, warped, opaque / np.float32(255), depth.min())


def _to_box(
    shape: Tuple[int, int], corners: np.ndarray, box: Tuple[int, int, int, int]
) -> Tuple[np.ndarray, Tuple[int, int]]:
    """Homography from a texture of this shape to the box of its image, and width and height of the box."""
    left, top, stop_x, stop_y = box
    rows, columns = shape
    source = np.float32([[0, 0], [columns - 1, 0], [columns - 1, rows - 1], [0, rows - 1]])
    H = cv2.getPerspectiveTransform(source, np.float32(corners - (left, top)))
    return H, (stop_x - left, stop_y - top)


def _sharp_enough(upright: Upright, pixels: float) -> Tuple[Upright, float]:
    """The coarsest level of detail that is sharp enough, and its scale in the image; pixels: per metre."""
    width = np.linalg.norm(upright.right - upright.left)
    while True:
        scale = SHARP * pixels * width / upright.grey.shape[1]
        if upright.coarse is None or scale * COARSER > 1:
            return upright, min(1.0, scale)
        upright = upright.coarse


def _visible(depth: np.ndarray, right: np.ndarray, tangent: float, near: float) -> Tuple[float, float]:
    """Clips the segment between two points to the field of view; returns the fractions of its ends.

    :param tangent: of half the field of view
    :param near: clipping distance, metres
    """
    low, high = 0.0, 1.0
    for begin, end in (depth - near, tangent * depth - right, tangent * depth + right):
        if begin < 0 and end < 0:
            return 0.0, 0.0
        if begin < 0:
            low = max(low, begin / (begin - end))
        elif end < 0:
            high = min(high, begin / (begin - end))
    return low, high


def _projected(view: UprightView, depth: np.ndarray, right: np.ndarray, height: float) -> np.ndarray:
    """Pixels (4, 2) of the corners: upper left, upper right, lower right, lower left."""
    centre_x, centre_y = view.centre
    u = centre_x + view.f * right / depth
    top, bottom = (centre_y + view.f * (view.eye - z) / depth for z in (height, 0.0))
    return np.array([[u[0], top[0]], [u[1], top[1]], [u[1], bottom[1]], [u[0], bottom[0]]])


def _box(corners: np.ndarray, columns: Tuple[int, int], height: int) -> Optional[Tuple[int, int, int, int]]:
    """Left, top, right and bottom of the bounding box in the image; None if the box is outside.

    :param columns: the first one of the image, and the one after its last
    """
    low = np.maximum(np.floor(corners.min(axis=0)), (columns[0], 0)).astype(int)
    high = np.minimum(np.ceil(corners.max(axis=0)), (columns[1], height)).astype(int)
    return (*low, *high) if np.all(high > low) else None


def _reduced(texture: Optional[np.ndarray], first: int, last: int, scale: float) -> Optional[np.ndarray]:
    """The visible columns of a texture, reduced by the scale."""
    if texture is None:
        return None
    part = texture[:, first : last + 1]
    size = (max(1, round(part.shape[1] * scale)), max(1, round(part.shape[0] * scale)))
    return cv2.resize(part, size, interpolation=cv2.INTER_AREA) if scale < 1 else part
