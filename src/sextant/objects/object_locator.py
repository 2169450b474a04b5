# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Localization of the objects in detected boxes by the depth image of a second camera; ignores pixels without
depth, and locates a near pillar by its width."""

from dataclasses import dataclass
from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

import sextant
from sextant.base.strict_params import StrictParams, param, within
from sextant.objects.box_tangents import BOTTOM, LEFT, RIGHT, TANGENTS, TOP, BoxTangents
from sextant.objects.circle_fit import CircleFit, TangentPlanes, candidate_ranges, extends_beyond, fit_circle
from sextant.objects.object_kinds import ObjectKind

BOX_MARGIN = 0.7  # depths up to this many box widths to the left and right of a box are used, too
MAX_POINTS = 800  # approximate number of depths used per box

MIN_OCCLUDED = 0.25  # a side is occluded if more than this fraction of the points beside it are nearer
AMBIGUOUS = 0.4  # a box is ambiguous if another fit has more than this fraction of the best fit's inliers
MIN_INLIERS = (
    0.25  # minimum fraction of the depths in a box; a fit with fewer inliers is of an object in front
)
MAX_RANGE_BY_WIDTH = 0.5  # metres; pillars farther away are not located by their width
# box widths to either side of the middle; for that, this strip must have fewer than min_points depths
INNER = 0.3
MIN_SIDE = 2.0  # minimum width and height of a box, pixels
CORNERS = np.array([[0, 1], [2, 1], [0, 3], [2, 3]])  # of a box: indices of x and y
GATE_SIGMAS, MAX_WIDTH_SIGMAS = 3.0, 5.0  # standard deviations
TILT_TOLERANCE = 0.1  # radians, error of the camera's assumed tilt


@dataclass(frozen=True)
class ObjectLocatorParams(StrictParams):
    """Depth range, error model and thresholds of the localization."""

    depth_scale: float = param(
        1.0, "factor that corrects the depths; `estimate_depth_scale` estimates it", within(0.5, 2)
    )
    min_points: int = param(12, "minimum number of depth pixels on an object", within(1, 10000))
    min_depth: float = param(0.2, "smaller depths are ignored", within(0.01, 100), "m")
    max_depth: float = param(8.0, "larger depths are ignored", within(0.01, 100), "m")
    depth_sigma: float = param(
        0.004,
        "standard deviation of a depth at 1 m; grows with the square of the depth",
        within(1e-6, 10),
        "m",
    )
    correlation_length: float = param(
        7.0, "correlation length of the depth noise in the depth image", within(1, 1000), "px"
    )
    depth_scale_sigma: float = param(0.001, "standard deviation of `depth_scale`", within(0, 1))
    pixel_sigma: float = param(1.1, "standard deviation of a box's side", within(0.01, 100), "px")
    size_sigma: float = param(
        0.022,
        "further part of the standard deviation of a box's side, as a fraction of the box's width or "
        "height",
        within(0, 1),
    )
    max_sigma: float = param(
        0.05,
        "maximum standard deviation of a position, as a fraction of its range; less certain objects "
        "are not published",
        within(0, 10),
    )


class LocatedObject(NamedTuple):
    """Position of a pillar's axis or a ball's centre on the floor."""

    position: np.ndarray  # (2,) x and y in the robot frame, metres
    covariance: np.ndarray  # (2, 2) square metres


class ObjectLocator:
    """Locates the objects in boxes of a colour image."""

    def __init__(
        self,
        params: ObjectLocatorParams,
        colour: "sextant.CameraModel",
        depth: "sextant.CameraModel",
        T_colour_depth: np.ndarray,
    ):
        """:param T_colour_depth: (4, 4) from the depth to the colour camera's optical frame

        :raises ValueError: a parameter out of range
        """
        self._params, self._colour, self._depth = params, colour, depth
        self._T_depth_colour = np.linalg.inv(T_colour_depth)
        width, height = depth.size
        x, y = np.meshgrid(np.arange(width), np.arange(height))
        rays = depth.rays(np.column_stack([x.ravel(), y.ravel()])) @ T_colour_depth[:3, :3].T
        self._rays = rays.reshape(height, width, 3)
        self._offset = T_colour_depth[:3, 3]

    def locate(
        self, depth: np.ndarray, boxes: np.ndarray, kinds: Sequence[ObjectKind], T_base_colour: np.ndarray
    ) -> List[Optional[LocatedObject]]:
        """Locate the object in each box; None: it cannot be located.

        :param depth: float32 (height, width), metres, 0: none, as from depth_encodings.metres_of()
        :param boxes: (n, 4) left, top, right, bottom, pixels of the colour image; (0, 0) is the outer
            corner of its top-left pixel
        :param T_base_colour: (4, 4), z up in the robot frame
        :raises ValueError: the depth image and its camera differ in size
        """
        width, height = self._depth.size
        if depth.shape != (height, width):
            raise ValueError(
                f"the depth image is {depth.shape[1]}×{depth.shape[0]}, its camera_info has {width}×{height}"
            )
        found = [
            self._located(depth, box, kind, T_base_colour) for box, kind in zip(np.asarray(boxes), kinds)
        ]
        return _without_duplicates(found, kinds)

    def _located(
        self, depth: np.ndarray, box: np.ndarray, kind: ObjectKind, T_base_colour: np.ndarray
    ) -> Optional[LocatedObject]:
        corners = self._corners(box)
        if corners is None:
            return None
        corners = corners @ T_base_colour[:3, :3].T
        tangents = TANGENTS[kind.shape](corners)
        points, pixels, step = self._points(depth, box, kind)
        # Relative to the camera, along the robot's axes.
        visible = (points @ T_base_colour[:3, :3].T)[:, : len(tangents.middle)]
        found = self._fits(box, tangents, kind, pixels, visible, step)
        fits = [each for each in found if _is_on_floor(each[1].position, kind, T_base_colour)]
        if not fits or fits[0][0] < self._params.min_points:
            return self._located_by_width(box, tangents, kind, pixels, T_base_colour)
        (best_count, best), *others = fits
        for count, other in others:
            if (
                count > AMBIGUOUS * best_count
                and np.linalg.norm(other.position - best.position) > kind.radius
            ):
                return None
        return self._located_object(best.position[:2], best.covariance[:2, :2], T_base_colour)

    def _corners(self, box: np.ndarray) -> Optional[np.ndarray]:
        """Rays (4, 3) to the corners of a box; None: too small, or outside the lens model."""
        rays = self._colour.rays(box[CORNERS] - 0.5)
        is_good = np.all(box[2:] - box[:2] >= MIN_SIDE) and np.isfinite(rays).all()
        return rays if is_good else None

    def _located_by_width(
        self, box: np.ndarray, tangents: BoxTangents, kind: ObjectKind, pixels: np.ndarray, T_base_colour
    ) -> Optional[LocatedObject]:
        """Locate a pillar below the minimum depth by its width in the image: the robot must avoid it."""
        params, focal = self._params, self._colour.focal_length
        offset = abs(pixels[:, 0] - 0.5 * (box[0] + box[2])) / (box[2] - box[0])
        deviation = np.hypot(params.pixel_sigma, params.size_sigma * (box[2] - box[0]))
        is_whole = min(box[0], self._colour.size[0] - box[2]) > GATE_SIGMAS * deviation
        if kind.shape != "pillar" or not is_whole or np.count_nonzero(offset < INNER) >= params.min_points:
            return None
        left, right = tangents.normals
        half = 0.5 * np.arccos(np.clip(-left @ right, -1.0, 1.0))
        distance = kind.radius / np.sin(half)
        if distance > MAX_RANGE_BY_WIDTH:
            return None
        along, across = tangents.middle, np.array([-tangents.middle[1], tangents.middle[0]])
        sigmas = np.array([distance / np.tan(half), distance]) * deviation / (np.sqrt(2.0) * focal)
        axes = np.column_stack([along, across]) * sigmas
        return self._located_object(distance * along, axes @ axes.T, T_base_colour)

    def _fits(
        self, box: np.ndarray, tangents: BoxTangents, kind: ObjectKind, pixels, visible: np.ndarray, step: int
    ) -> List[Tuple[int, CircleFit]]:
        """Fits to the points of a box, along the robot's axes, with their counts of inliers; most first."""
        params, found = self._params, []
        sigma, correlated, radius = params.depth_sigma, (params.correlation_length / step) ** 2, kind.radius
        inside = np.all((pixels >= box[:2]) & (pixels <= box[2:]), axis=1)
        for distance in candidate_ranges(visible[inside], tangents.middle, radius, sigma, params.min_points):
            sides = self._outlines(box, tangents, max(distance, radius), kind, pixels, visible)
            fit = sides and fit_circle(visible, distance * tangents.middle, radius, sides, sigma, correlated)
            if (
                fit
                and sides.agree(fit.position, radius)
                and not extends_beyond(visible, fit, radius, sides, sigma)
            ):
                points = int(np.count_nonzero(fit.on & inside))
                if points >= MIN_INLIERS * np.count_nonzero(inside):
                    found.append((points, fit))
        return sorted(found, key=lambda each: -each[0])

    def _located_object(
        self, position: np.ndarray, covariance: np.ndarray, T_base_colour: np.ndarray
    ) -> Optional[LocatedObject]:
        covariance = covariance + self._params.depth_scale_sigma**2 * np.outer(position, position)
        if np.linalg.eigvalsh(covariance)[-1] > (self._params.max_sigma**2) * (position @ position):
            return None
        return LocatedObject(position + T_base_colour[:2, 3], covariance)

    def _points(
        self, depth: np.ndarray, box: np.ndarray, kind: ObjectKind
    ) -> Tuple[np.ndarray, np.ndarray, int]:
        """Points (n, 3) in and beside a box in the colour camera's frame, their pixels (n, 2), pixel step."""
        params, size = self._params, box[2:] - box[:2]
        low, high = box[:2] - [BOX_MARGIN * size[0], 0.0], box[2:] + [BOX_MARGIN * size[0], 0.0]
        if kind.shape == "pillar":  # exclude the floor at its foot
            low[1], high[1] = low[1] + 0.05 * size[1], high[1] - 0.05 * size[1]
        left, top, right, bottom = self._window(low, high)
        step = max(1, int(np.sqrt((right - left) * (bottom - top) / MAX_POINTS)))
        window = slice(top, bottom, step), slice(left, right, step)
        found = params.depth_scale * depth[window].astype(float)
        which = (found >= params.min_depth) & (found <= params.max_depth)
        points = self._rays[window][which] * found[which][:, np.newaxis] + self._offset
        points = points[points[:, 2] > 0.5 * params.min_depth]
        pixels = self._colour.project_points(points) + 0.5
        near = np.all((pixels >= low) & (pixels <= high), axis=1)
        return points[near], pixels[near], step

    def _window(self, low: np.ndarray, high: np.ndarray) -> Tuple[int, int, int, int]:
        """Left, top, right and bottom in the depth image of a box in the colour image with these corners
        (2,), at any depth in range."""
        around = np.array([[low[0], low[1]], [high[0], low[1]], [low[0], high[1]], [high[0], high[1]]]) - 0.5
        rays = self._colour.rays(around)
        T = self._T_depth_colour
        ends = np.vstack([rays * z for z in (self._params.min_depth, self._params.max_depth)])
        found = self._depth.project_points(ends @ T[:3, :3].T + T[:3, 3])
        size = np.array(self._depth.size)
        # Outside the lens model the window extends to the image's border.
        first = np.clip(np.floor(np.nan_to_num(found).min(axis=0)), 0, size).astype(int)
        last = np.clip(np.ceil(np.nan_to_num(found, nan=max(size)).max(axis=0)) + 1, 0, size).astype(int)
        return first[0], first[1], last[0], last[1]

    def _outlines(
        self, box: np.ndarray, tangents: BoxTangents, distance: float, kind: ObjectKind, pixels, visible
    ) -> Optional[TangentPlanes]:
        """Tangent planes of the sides of the box that are the object's outline, not the image border or an
        occluder's edge. None: no left or right outline, or at this distance box and object differ in width
        and no occlusion explains it."""
        params, size, focal = self._params, np.tile(box[2:] - box[:2], 2), self._colour.focal_length
        deviations = np.hypot(params.pixel_sigma, params.size_sigma * size)  # of the sides, pixels
        limits = np.array([*box[:2], *(np.array(self._colour.size) - box[2:])])
        is_inside = limits > GATE_SIGMAS * deviations
        wide = 2.0 * np.arcsin(min(1.0, kind.radius / distance))
        is_outline = is_inside & ~_is_chord(is_inside, size[:2], 0.5 * wide * focal, kind)
        normals = dict(zip(tangents.sides, tangents.normals))
        left, right = normals[LEFT], normals[RIGHT]
        missing = (wide - np.arccos(np.clip(-left @ right, -1.0, 1.0))) * focal  # pixels
        sigmas, doubt = deviations * distance / focal, np.sqrt(2.0) * deviations[LEFT]
        # A box much wider than the object belongs to one below the minimum depth; the depths are of the
        # background.
        if -missing > max(MAX_WIDTH_SIGMAS * doubt, 0.5 * wide * focal):
            return None
        if is_outline[LEFT] and is_outline[RIGHT] and abs(missing) > GATE_SIGMAS * doubt:
            hidden = self._occluded(
                box, abs(missing), pixels, visible @ tangents.middle < distance - 2.0 * kind.radius
            )
            if missing > MAX_WIDTH_SIGMAS * doubt and not hidden.any():
                return None
            if missing > 0:
                is_outline[[LEFT, RIGHT]] = ~hidden
            sigmas[[LEFT, RIGHT]] += max(0.0, -missing) * distance / focal
        if not (is_outline[LEFT] or is_outline[RIGHT]):
            return None
        is_used = is_outline[tangents.sides]
        return TangentPlanes(tangents.normals[is_used], sigmas[tangents.sides][is_used])

    @staticmethod
    def _occluded(box: np.ndarray, missing: float, pixels: np.ndarray, nearer: np.ndarray) -> np.ndarray:
        """(2,) whether a nearer object occludes the left and the right side."""
        x = pixels[:, 0]
        beside = [(x < box[0]) & (x > box[0] - missing), (x > box[2]) & (x < box[2] + missing)]
        return np.array([which.any() and nearer[which].mean() > MIN_OCCLUDED for which in beside])


def _is_on_floor(position: np.ndarray, kind: ObjectKind, T_base_colour: np.ndarray) -> bool:
    """Whether a ball's centre (3,), relative to the camera, is one radius above the floor."""
    if kind.shape != "ball":
        return True
    above = position[2] + T_base_colour[2, 3] - kind.radius
    return bool(abs(above) < kind.radius + TILT_TOLERANCE * np.linalg.norm(position))


def _is_chord(is_inside: np.ndarray, size: np.ndarray, radius: float, kind: ObjectKind) -> np.ndarray:
    """(4,) which sides of a ball's box are not tangents, because the image's border cuts off its centre.

    :param is_inside: (4,) whether the sides are inside the image's borders
    :param size: (2,) of the box, pixels. :param radius: of the ball, pixels
    """
    is_cut = np.array([not is_inside[[LEFT, RIGHT]].all(), not is_inside[[TOP, BOTTOM]].all()])
    across, along = is_cut & (size < radius) & (kind.shape == "ball")
    return np.array([along, across, along, across])


def _without_duplicates(
    found: List[Optional[LocatedObject]], kinds: Sequence[ObjectKind]
) -> List[Optional[LocatedObject]]:
    """Of two objects that overlap keep the more certain one: the other's box contains its points."""
    order = sorted((each is None or each.covariance.trace(), i) for i, each in enumerate(found))
    kept: List[int] = []
    for _, i in order:
        if found[i] is not None and not any(
            np.linalg.norm(found[i].position - found[j].position) < max(kinds[i].radius, kinds[j].radius)
            for j in kept
        ):
            kept.append(i)
    return [each if i in kept else None for i, each in enumerate(found)]
