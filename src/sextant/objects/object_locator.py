# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the objects in a picture's boxes are, by a depth image of another camera beside."""

from dataclasses import dataclass
from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

import sextant
from sextant.base.strict_params import StrictParams, param, within
from sextant.objects.box_tangents import BOTTOM, LEFT, RIGHT, TANGENTS, TOP, BoxTangents
from sextant.objects.object_kinds import ObjectKind
from sextant.objects.round_fit import Planes, fit_round, goes_on, likely_ranges

GROWN = 0.7  # of its width, by which a box is looked at beyond its sides
MOST_POINTS = 800  # of a box: of large ones not every pixel is looked at

HIDDEN = 0.25  # share of the pixels beside a box that are nearer, from which its side is no outline
AMBIGUOUS = 0.4  # share of the points on the best fit, from which on another that fits may be right
LEAST_SHARE = 0.25  # of the depths in a box that are on it: a few are of what stands before it
TOO_NEAR, INNER = 0.5, 0.3  # metres to a pillar without depth; share of its width beside the middle
SMALLEST = 2.0  # pixels, a box's side
SURE, DISAGREE = 3.0, 5.0  # deviations
TILT = 0.1  # radians by which what is known of the camera's tilt may be wrong


@dataclass(frozen=True)
class ObjectLocatorParams(StrictParams):
    """How depth becomes a place, and how sure it is."""

    scale: float = param(1.0, within(0.5, 2))  # that depths are multiplied by
    fewest: int = param(12, within(1, 10000))  # depths of an object
    nearest: float = param(0.2, within(0.01, 100))  # metres; less is none
    farthest: float = param(8.0, within(0.01, 100))  # metres
    range_sigma: float = param(0.004, within(1e-6, 10))  # of a depth at 1 m, growing with its square, metres
    lump: float = param(7.0, within(1, 1000))  # pixels of the depth image, across which depths err alike
    scale_sigma: float = param(0.001, within(0, 1))  # deviation of the scale
    pixel_sigma: float = param(1.1, within(0.01, 100))  # deviation of a box's side, pixels
    size_sigma: float = param(0.022, within(0, 1))  # and, beside, of the box's width or height
    worst: float = param(0.05, within(0, 10))  # of the range: a place that is less sure is not told


class LocatedObject(NamedTuple):
    """The axis of a pillar or the middle of a ball, on the floor."""

    position: np.ndarray  # (2,) x and y in the robot frame, metres
    covariance: np.ndarray  # (2, 2)


class _Fit(NamedTuple):
    """A place from the camera, in the robot's axes."""

    points: int  # on it, in the box
    position: np.ndarray
    covariance: np.ndarray


class ObjectLocator:
    """Finds the places of objects in boxes of a colour image."""

    def __init__(
        self,
        params: ObjectLocatorParams,
        colour: "sextant.CameraModel",
        depth: "sextant.CameraModel",
        T_colour_depth: np.ndarray,
    ):
        """:param T_colour_depth: (4, 4) between the optical frames

        :raises ValueError: a setting out of range
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
        """What each box shows; None where that cannot be told.

        :param depth: as sextant.objects.depth_image.metres_of() gives it
        :param boxes: (n, 4) left, top, right, bottom, pixels of the colour image; its first corner is (0, 0)
        :param T_base_colour: (4, 4), z up in the robot frame
        :raises ValueError: the depth image is of another size than its camera
        """
        width, height = self._depth.size
        if depth.shape != (height, width):
            raise ValueError(
                f"the depth image is {depth.shape[1]}×{depth.shape[0]}, its camera {width}×{height}"
            )
        found = [
            self._located(depth, box, kind, T_base_colour) for box, kind in zip(np.asarray(boxes), kinds)
        ]
        return _without_doubles(found, kinds)

    def _located(
        self, depth: np.ndarray, box: np.ndarray, kind: ObjectKind, T_base_colour: np.ndarray
    ) -> Optional[LocatedObject]:
        corners = self._corners(box)
        if corners is None:
            return None
        corners = corners @ T_base_colour[:3, :3].T
        tangents = TANGENTS[kind.shape](corners)
        points, pixels, step = self._points(depth, box, kind)
        # From the camera, in the robot's axes.
        seen = (points @ T_base_colour[:3, :3].T)[:, : len(tangents.middle)]
        fits = [
            each
            for each in self._fits(box, tangents, kind, pixels, seen, step)
            if _is_on_floor(each.position, kind, T_base_colour)
        ]
        if not fits or fits[0].points < self._params.fewest:
            return self._too_near(box, tangents, kind, pixels, T_base_colour)
        others = (each for each in fits[1:] if np.linalg.norm(each.position - fits[0].position) > kind.radius)
        if any(each.points > AMBIGUOUS * fits[0].points for each in others):
            return None
        return self._told(fits[0].position[:2], fits[0].covariance[:2, :2], T_base_colour)

    def _corners(self, box: np.ndarray) -> Optional[np.ndarray]:
        """(4, 3) rays to the corners of a box; None: it is too small, or the lens model has no ray there."""
        rays = self._colour.rays(box[[[0, 1], [2, 1], [0, 3], [2, 3]]] - 0.5)
        is_good = np.all(box[2:] - box[:2] >= SMALLEST) and np.isfinite(rays).all()
        return rays if is_good else None

    def _too_near(
        self, box: np.ndarray, tangents: BoxTangents, kind: ObjectKind, pixels: np.ndarray, T_base_colour
    ) -> Optional[LocatedObject]:
        """A pillar that is nearer than depth begins, by how wide it looks: the robot must know of it."""
        params, focal = self._params, self._colour.focal_length
        off = abs(pixels[:, 0] - 0.5 * (box[0] + box[2])) / (box[2] - box[0])
        deviation = np.hypot(params.pixel_sigma, params.size_sigma * (box[2] - box[0]))
        is_whole = min(box[0], self._colour.size[0] - box[2]) > SURE * deviation
        if kind.shape != "pillar" or not is_whole or np.count_nonzero(off < INNER) >= params.fewest:
            return None
        left, right = tangents.normals
        half = 0.5 * np.arccos(np.clip(-left @ right, -1.0, 1.0))
        far = kind.radius / np.sin(half)
        if far > TOO_NEAR:
            return None
        along, across = tangents.middle, np.array([-tangents.middle[1], tangents.middle[0]])
        sigmas = np.array([far / np.tan(half), far]) * deviation / (np.sqrt(2.0) * focal)
        axes = np.column_stack([along, across]) * sigmas
        return self._told(far * along, axes @ axes.T, T_base_colour)

    def _fits(
        self, box: np.ndarray, tangents: BoxTangents, kind: ObjectKind, pixels, seen: np.ndarray, step: int
    ) -> List["_Fit"]:
        """All places that the box may show, that with the most points in it first."""
        params, found = self._params, []
        sigma, alike, radius = params.range_sigma, (params.lump / step) ** 2, kind.radius
        inside = np.all((pixels >= box[:2]) & (pixels <= box[2:]), axis=1)
        for far in likely_ranges(seen[inside], tangents.middle, radius, sigma, params.fewest):
            sides = self._outlines(box, tangents, max(far, radius), kind, pixels, seen)
            fit = sides and fit_round(seen, far * tangents.middle, radius, sides, sigma, alike)
            if fit and sides.agree(fit.position, radius) and not goes_on(seen, fit, radius, sides, sigma):
                points = int(np.count_nonzero(fit.on & inside))
                if points >= LEAST_SHARE * np.count_nonzero(inside):
                    found.append(_Fit(points, fit.position, fit.covariance))
        return sorted(found, key=lambda each: -each.points)

    def _told(
        self, position: np.ndarray, covariance: np.ndarray, T_base_colour: np.ndarray
    ) -> Optional[LocatedObject]:
        covariance = covariance + self._params.scale_sigma**2 * np.outer(position, position)
        if np.linalg.eigvalsh(covariance)[-1] > (self._params.worst**2) * (position @ position):
            return None
        return LocatedObject(position + T_base_colour[:2, 3], covariance)

    def _points(
        self, depth: np.ndarray, box: np.ndarray, kind: ObjectKind
    ) -> Tuple[np.ndarray, np.ndarray, int]:
        """About a box: (n, 3) in the colour camera's frame, their pixels (n, 2), the step between them."""
        params, size = self._params, box[2:] - box[:2]
        low, high = box[:2] - [GROWN * size[0], 0.0], box[2:] + [GROWN * size[0], 0.0]
        if kind.shape == "pillar":  # the floor at its foot is not of it
            low[1], high[1] = low[1] + 0.05 * size[1], high[1] - 0.05 * size[1]
        left, top, right, bottom = self._window(low, high)
        step = max(1, int(np.sqrt((right - left) * (bottom - top) / MOST_POINTS)))
        window = slice(top, bottom, step), slice(left, right, step)
        found = params.scale * depth[window].astype(float)
        which = (found >= params.nearest) & (found <= params.farthest)
        points = self._rays[window][which] * found[which][:, np.newaxis] + self._offset
        points = points[points[:, 2] > 0.5 * params.nearest]
        pixels = self._colour.project_points(points) + 0.5
        near = np.all((pixels >= low) & (pixels <= high), axis=1)
        return points[near], pixels[near], step

    def _window(self, low: np.ndarray, high: np.ndarray) -> Tuple[int, int, int, int]:
        """Left, top, right and bottom in the depth image of what may be seen between two pixels (2,)."""
        around = np.array([[low[0], low[1]], [high[0], low[1]], [low[0], high[1]], [high[0], high[1]]]) - 0.5
        rays = self._colour.rays(around)
        T = self._T_depth_colour
        ends = np.vstack([rays * z for z in (self._params.nearest, self._params.farthest)])
        found = self._depth.project_points(ends @ T[:3, :3].T + T[:3, 3])
        size = np.array(self._depth.size)
        # Where a lens model has no ray, the window ends where the image does.
        first = np.clip(np.floor(np.nan_to_num(found).min(axis=0)), 0, size).astype(int)
        last = np.clip(np.ceil(np.nan_to_num(found, nan=max(size)).max(axis=0)) + 1, 0, size).astype(int)
        return first[0], first[1], last[0], last[1]

    def _outlines(
        self, box: np.ndarray, tangents: BoxTangents, far: float, kind: ObjectKind, pixels, seen
    ) -> Optional[Planes]:
        """The sides of the box that are the object's outline, not the picture's border or another's; None: it
        would be far wider there than the box, or narrower, and nothing tells why."""
        params, size, focal = self._params, np.tile(box[2:] - box[:2], 2), self._colour.focal_length
        deviations = np.hypot(params.pixel_sigma, params.size_sigma * size)  # of sides, pixels
        limits = np.array([*box[:2], *(np.array(self._colour.size) - box[2:])])
        is_inside = limits > SURE * deviations
        wide = 2.0 * np.arcsin(min(1.0, kind.radius / far))
        is_outline = is_inside & ~_is_chord(is_inside, size[:2], 0.5 * wide * focal, kind)
        left, right = (
            tangents.normals[tangents.sides == LEFT][0],
            tangents.normals[tangents.sides == RIGHT][0],
        )
        missing = (wide - np.arccos(np.clip(-left @ right, -1.0, 1.0))) * focal  # pixels
        sigmas, doubt = deviations * far / focal, np.sqrt(2.0) * deviations[LEFT]
        if -missing > max(
            DISAGREE * doubt, 0.5 * wide * focal
        ):  # what is nearer than depth can be shows nothing
            return None
        if is_outline[LEFT] and is_outline[RIGHT] and abs(missing) > SURE * doubt:
            hidden = self._hidden(box, abs(missing), pixels, seen @ tangents.middle < far - 2.0 * kind.radius)
            if missing > DISAGREE * doubt and not hidden.any():
                return None
            if missing > 0:
                is_outline[[LEFT, RIGHT]] = ~hidden
            sigmas[[LEFT, RIGHT]] += max(0.0, -missing) * far / focal
        if not (is_outline[LEFT] or is_outline[RIGHT]):
            return None
        told = is_outline[tangents.sides]
        return Planes(tangents.normals[told], sigmas[tangents.sides][told])

    @staticmethod
    def _hidden(box: np.ndarray, missing: float, pixels: np.ndarray, nearer: np.ndarray) -> np.ndarray:
        """(2,) whether something nearer stands at the left and the right side."""
        x = pixels[:, 0]
        beside = [(x < box[0]) & (x > box[0] - missing), (x > box[2]) & (x < box[2] + missing)]
        return np.array([which.any() and nearer[which].mean() > HIDDEN for which in beside])


def _is_on_floor(position: np.ndarray, kind: ObjectKind, T_base_colour: np.ndarray) -> bool:
    """Whether a ball's middle, from the camera, is its radius above the floor."""
    if kind.shape != "ball":
        return True
    above = position[2] + T_base_colour[2, 3] - kind.radius
    return bool(abs(above) < kind.radius + TILT * np.linalg.norm(position))


def _is_chord(is_inside: np.ndarray, size: np.ndarray, radius: float, kind: ObjectKind) -> np.ndarray:
    """(4,) which sides of a ball's box touch nothing, for the picture ends before its middle.

    :param is_inside: (4,) whether the sides are off the picture's borders
    :param size: (2,) of the box, pixels. :param radius: of the ball, pixels
    """
    is_cut = np.array([not is_inside[[LEFT, RIGHT]].all(), not is_inside[[TOP, BOTTOM]].all()])
    across, along = is_cut & (size < radius) & (kind.shape == "ball")
    return np.array([along, across, along, across])


def _without_doubles(
    found: List[Optional[LocatedObject]], kinds: Sequence[ObjectKind]
) -> List[Optional[LocatedObject]]:
    """Of two that would stand in one another the surer one: the other's box shows what is before it."""
    order = sorted((each is None or each.covariance.trace(), i) for i, each in enumerate(found))
    kept: List[int] = []
    for _, i in order:
        if found[i] is not None and not any(
            np.linalg.norm(found[i].position - found[j].position) < max(kinds[i].radius, kinds[j].radius)
            for j in kept
        ):
            kept.append(i)
    return [each if i in kept else None for i, each in enumerate(found)]
