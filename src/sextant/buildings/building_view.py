# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Renders camera images of the simulated building: floor and ceiling, the walls that are seen, pillars."""

from typing import NamedTuple, Tuple

import cv2
import numpy as np

import sextant
from sextant.buildings.building_looks import PILLAR_HEIGHT, PILLAR_RADIUS, BuildingLooks
from sextant.buildings.building_textures import HEIGHT, PLANE_SIDE, PLANE_TEXELS
from sextant.simulation.building import Building
from sextant.simulation.camera import HORIZONTAL_FOV, camera_calibration, camera_mount
from sextant.simulation.image_pyramid import Pyramid, sampled
from sextant.simulation.uprights import Upright, UprightView, upright_image

NEAR = 0.05  # clipping distance, metres
SLANT = 2.5  # texels per pixel above which floor and ceiling are reduced, along the viewing direction
ROUNDING = 1e-6  # of the fraction of a wall, so that no column falls between two


class BuildingCamera(NamedTuple):
    """An ideal camera with a horizontal optical axis."""

    width: int = 640  # of the images, pixels
    height: int = 480  # of the images, pixels
    horizontal_fov: float = HORIZONTAL_FOV  # radians
    ahead: float = 0.1  # of the robot's centre, metres
    above: float = 1.0  # the floor, metres
    noise: float = 4.0  # standard deviation, grey levels

    def calibration(self) -> "sextant.CameraCalibration":
        """Its calibration."""
        return camera_calibration(self.width, self.height, self.horizontal_fov)

    @property
    def T_base_camera(self) -> np.ndarray:
        """Mount (4, 4) on the robot, metres."""
        return camera_mount([self.ahead, 0.0, self.above], [0.0, 0.0, 0.0])

    def pose(self, pose: np.ndarray) -> np.ndarray:
        """T_map_camera (4, 4). :param pose: (3,) of the robot in the map"""
        x, y, yaw = pose
        return sextant.pose_from_xyz_rpy([x, y, 0.0], [0.0, 0.0, yaw]) @ self.T_base_camera

    def view(self, pose: np.ndarray) -> UprightView:
        """What the camera of a robot sees. :param pose: (3,) of the robot in the map"""
        x, y, yaw = pose
        x, y = x + self.ahead * np.cos(yaw), y + self.ahead * np.sin(yaw)
        K = self.calibration().K
        return UprightView(x, y, yaw, self.width, self.height, K[0, 0], K[1, 2], self.above, NEAR)


def building_view(
    building: Building, looks: BuildingLooks, camera: BuildingCamera, pose: np.ndarray, number: int
) -> np.ndarray:
    """Renders an image, uint8 (height, width).

    :param pose: (3,) of the robot in the map
    :param number: of the image, random seed of its noise
    """
    view = camera.view(pose)
    light = _planes(looks, view)
    owners, depths = visible_walls(looks, view)
    for index in np.unique(owners[owners >= 0]):
        _draw(light, looks.panels[index], view, owners == index, depths)
    _draw_pillars(light, building, looks, view, depths)
    noise = np.random.default_rng(number).standard_normal(light.shape, np.float32)
    return np.clip(light + np.float32(camera.noise) * noise, 0, 255).astype(np.uint8)


def visible_walls(looks: BuildingLooks, view: UprightView) -> Tuple[np.ndarray, np.ndarray]:
    """The nearest panel in each column of an image. All panels reach from the floor to the ceiling.

    :returns: its index (width,), -1: none, and its depth (width,), metres
    """
    ends = np.array([(each.left, each.right) for each in looks.panels])
    depth, right = (each.reshape(-1, 2) for each in view.depth_and_right(ends.reshape(-1, 2)))
    tangent = (np.arange(view.width) - view.centre[0]) / view.f
    is_facing = right[:, 1] * depth[:, 0] > right[:, 0] * depth[:, 1]
    nearby = np.flatnonzero(is_facing & (depth.max(axis=1) > view.near))
    begin_depth, begin_right = depth[nearby, :1], right[nearby, :1]
    along_depth, along_right = (each[nearby, 1:] - each[nearby, :1] for each in (depth, right))
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (tangent * begin_depth - begin_right) / (along_right - tangent * along_depth)
        distance = begin_depth + share * along_depth
    is_met = (share >= -ROUNDING) & (share <= 1 + ROUNDING) & (distance > view.near)
    distance = np.where(is_met, distance, np.inf)
    nearest = np.argmin(distance, axis=0)
    depths = distance[nearest, np.arange(view.width)]
    return np.where(np.isfinite(depths), nearby[nearest], -1), depths


def _draw(
    light: np.ndarray, upright: Upright, view: UprightView, columns: np.ndarray, depths: np.ndarray
) -> None:
    """Draws the part of an upright in these columns (width,), in place. :param depths: (width,) metres"""
    shown = np.flatnonzero(columns)
    seen = upright_image(upright, view, (shown[0], shown[-1] + 1)) if len(shown) else None
    if seen is None:
        return
    left, top, stop_x, stop_y = seen.box
    rows = np.arange(top, stop_y, dtype=np.float32)[:, None]
    scale = np.float32(view.f / depths[left:stop_x])
    above = rows - (np.float32(view.horizon) + scale * np.float32(view.eye - upright.height)) + 0.5
    below = np.float32(view.horizon) + scale * np.float32(view.eye) - rows + 0.5
    opaque = np.clip(np.minimum(above, below), 0, 1) * columns[left:stop_x].astype(np.float32)
    part = light[top:stop_y, left:stop_x]
    part += opaque * (seen.grey - part)


def _draw_pillars(
    light: np.ndarray, building: Building, looks: BuildingLooks, view: UprightView, depths: np.ndarray
) -> None:
    """Draws the pillars as boards that face the camera, the farthest first."""
    distances, _ = view.depth_and_right(building.pillars)
    for index in np.argsort(-distances):
        if distances[index] < 2 * PILLAR_RADIUS:
            break
        at = building.pillars[index]
        towards = (at - (view.x, view.y)) / np.hypot(*(at - (view.x, view.y)))
        half = PILLAR_RADIUS * np.array([towards[1], -towards[0]])
        board = Upright(at - half, at + half, PILLAR_HEIGHT, looks.pillar_texture(index), None)
        _draw(light, board, view, depths > distances[index], np.full(view.width, distances[index]))


def _planes(looks: BuildingLooks, view: UprightView) -> np.ndarray:
    """Floor and ceiling without walls, float32 (height, width); computed for every second pixel."""
    size, middle = (view.width, view.height), view.height // 4
    view = view._replace(width=view.width // 2, f=0.5 * view.f, horizon=0.5 * view.horizon - 0.25)
    ceiling = _plane(looks.ceiling, view, np.arange(middle), HEIGHT - view.eye)
    floor = _plane(looks.floor, view, np.arange(middle, view.height // 2), view.eye)
    return cv2.resize(np.concatenate([ceiling, floor]), size, interpolation=cv2.INTER_LINEAR)


def _plane(levels: Pyramid, view: UprightView, rows: np.ndarray, distance: float) -> np.ndarray:
    """A horizontal plane in some rows, float32. :param distance: to the camera, along z, metres"""
    depth = np.float32(distance * view.f / np.maximum(np.abs(rows - view.horizon), 0.25))
    right = np.outer(depth, np.float32(np.arange(view.width) - view.centre[0]) / np.float32(view.f))
    cosine, sine = np.float32(np.cos(view.yaw)), np.float32(np.sin(view.yaw))
    x = view.x + cosine * depth[:, None] + sine * right
    y = view.y + sine * depth[:, None] - cosine * right
    footprint = depth / view.f * np.maximum(depth / distance / SLANT, 1)
    at = (np.mod(each * np.float32(PLANE_TEXELS), PLANE_SIDE) for each in (x, y))
    return sampled(levels, *at, footprint * PLANE_TEXELS, cv2.BORDER_WRAP)
