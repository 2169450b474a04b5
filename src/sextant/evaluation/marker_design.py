# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How accurately a camera is located from markers on a wall: a sweep in simulation.

Every cell of the sweep is one distance, angle, size and number of markers under one setup: resolution,
family, noise and light. Images are rendered, the markers detected, the pose solved, and compared with the
truth. Each image is located on its own: neither odometry nor the previous pose resolves an ambiguous pose.
"""

import functools
import itertools
import time
from dataclasses import dataclass
from typing import Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

import sextant
from sextant.base.jobs import run_jobs
from sextant.base.strict_params import StrictParams, above_zero, each, param, within
from sextant.simulation.camera import camera_calibration, resized_calibration
from sextant.simulation.marker_wall import camera_poses, wall_map, wall_room

Resolution = Tuple[int, int]

QUANTILE = 0.95  # of the errors
WHITE_MARGIN = 1.3  # edge length of the print with its white margin, as a multiple of the marker's
_RENDERER = sextant.RoomRendererParams()


class Setup(NamedTuple):
    """Camera, family and conditions of a cell."""

    resolution: Resolution  # width, height, px
    family: str  # canonical
    noise: float  # standard deviation of the sensor noise, grey levels
    light: float  # grey level of white paper


class Cell(NamedTuple):
    """One combination of the sweep."""

    setup: Setup  # camera, family and conditions
    size: float  # edge length, m
    in_view: int  # number of markers
    distance: float  # of the camera from the centre of the markers, m
    angle: float  # between the wall's normal and the direction to the camera, degrees


class Target(NamedTuple):
    """Accuracy to reach."""

    error: float  # position error that QUANTILE of the poses do not exceed, m
    distance: float  # up to which it is reached, m


class CellResult(NamedTuple):
    """Figures of a cell; those of the images are NaN if the markers do not fit into the image."""

    cell: Cell  # what was simulated
    pixels: float  # edge length of a marker that faces the camera, px
    images: int  # number of images; 0: the markers do not fit into the image
    detected: float  # fraction of the markers
    located: float  # fraction of the images with a pose
    median_error: float  # of the position, m; infinite if fewer than half of the images have a pose
    error: float  # QUANTILE of the position errors, m; infinite if fewer images have a pose
    angle_error: float  # QUANTILE of the rotation errors, rad; infinite if fewer images have a pose
    cpu: float  # median time for detection and solution of an image on one core, s


@dataclass(frozen=True)
class DesignParams(StrictParams):
    """Values of the sweep; it contains all combinations."""

    resolution: Tuple[Resolution, ...] = param(
        (), "image sizes; none: that of the calibration, or 640 x 480", each(each(within(16, 8192))), "px"
    )
    family: Tuple[str, ...] = param(("tag36h11",), "marker families")
    size: Tuple[float, ...] = param(
        (0.05, 0.08, 0.12, 0.16, 0.25), "edge lengths", each(above_zero(10.0)), "m"
    )
    in_view: Tuple[int, ...] = param((1, 2), "numbers of markers in view", each(within(1, 10)))
    distance: Tuple[float, ...] = param(
        (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0),
        "distances of the camera from the centre of the markers",
        each(within(0.1, 100.0)),
        "m",
    )
    angle: Tuple[float, ...] = param(
        (0.0, 20.0, 45.0),
        "angles between the wall's normal and the camera",
        each(within(0.0, 80.0)),
        "degrees",
    )
    noise: Tuple[float, ...] = param(
        (_RENDERER.noise_sigma,), "standard deviations of the sensor noise", unit="grey levels"
    )
    light: Tuple[float, ...] = param((_RENDERER.white_level,), "grey levels of white paper")
    images: int = param(20, "number of images per combination", within(1, 10000))
    spacing: float = param(1.0, "distance of the centres of adjacent markers", above_zero(50.0), "m")
    fov: float = param(62.0, "horizontal field of view without a calibration", within(1.0, 170.0), "degrees")
    seed: int = param(1, "random seed of poses, noise and walls", within(0, 2**31 - 1))

    def __post_init__(self) -> None:
        super().__post_init__()
        for setup in self.setups([(640, 480)]):
            renderer_params(setup).validate()
            wall_map(setup.family, 0.1, max(self.in_view), self.spacing)
        room = WHITE_MARGIN * max(self.size)
        if max(self.in_view) > 1 and self.spacing < room:
            raise ValueError(f"spacing: markers of {max(self.size):g} m need at least {room:g} m")

    def setups(self, resolutions: Sequence[Resolution]) -> List[Setup]:
        """Returns the setups with these resolutions."""
        families = dict.fromkeys(map(sextant.canonical_family, self.family))
        return [Setup(*values) for values in itertools.product(resolutions, families, self.noise, self.light)]


def simulate_design(
    params: DesignParams, calibration: Optional["sextant.CameraCalibration"] = None, jobs: int = 1
) -> List[CellResult]:
    """Simulates all combinations.

    :param calibration: of the camera, for its own or another resolution of this aspect ratio; None: an ideal
        lens with params.fov
    :param jobs: number of parallel processes; the results are the same, except for the CPU time
    :raises ValueError: a resolution of another aspect ratio
    :raises JobError: a combination cannot be simulated
    """
    calibrations = camera_calibrations(params, calibration)
    function = functools.partial(simulate_cell, params, calibrations)
    all_cells = list(cells(params, list(calibrations)))
    return list(run_jobs(function, all_cells, jobs, progress="sweep"))


def camera_calibrations(
    params: DesignParams, calibration: Optional["sextant.CameraCalibration"]
) -> Dict[Resolution, "sextant.CameraCalibration"]:
    """Returns the calibration of every resolution; arguments and errors as simulate_design()."""
    if calibration is None:
        fov = np.deg2rad(params.fov)
        return {size: camera_calibration(*size, fov) for size in params.resolution or [(640, 480)]}
    own = (calibration.width, calibration.height)
    return {size: resized_calibration(calibration, *size) for size in params.resolution or [own]}


def cells(params: DesignParams, resolutions: Sequence[Resolution]) -> Iterator[Cell]:
    """Yields all combinations."""
    axes = (params.size, params.in_view, params.distance, params.angle)
    for setup, *values in itertools.product(params.setups(resolutions), *axes):
        yield Cell(setup, *values)


def simulate_cell(
    params: DesignParams, calibrations: Dict[Resolution, "sextant.CameraCalibration"], cell: Cell
) -> CellResult:
    """Renders the images of a cell, locates the camera in each, and compares the poses with the truth."""
    camera = sextant.CameraModel(calibrations[cell.setup.resolution])
    pixels = camera.focal_length * cell.size / cell.distance
    marker_map = wall_map(cell.setup.family, cell.size, cell.in_view, params.spacing)
    angle = np.deg2rad(cell.angle)
    poses = camera_poses(cell.distance, angle, params.images, params.seed)
    if not all(_is_in_sight(camera, marker_map, T_map_camera) for T_map_camera in poses):
        return CellResult(cell, pixels, 0, *[np.nan] * 6)
    scene = sextant.RoomScene(wall_room(marker_map, cell.distance, angle, params.seed), marker_map)
    renderer = sextant.RoomRenderer(renderer_params(cell.setup), scene, camera)
    localizer = _Localizer(cell.setup.family, camera, marker_map)
    images = (renderer.render([T], frame) for frame, T in enumerate(poses, params.seed))
    return _summary(cell, pixels, [localizer.locate(image, T) for image, T in zip(images, poses)])


def renderer_params(setup: Setup) -> "sextant.RoomRendererParams":
    """Returns the parameters of the simulated sensor."""
    params = sextant.RoomRendererParams()
    params.noise_sigma, params.white_level = setup.noise, setup.light
    return params


def _is_in_sight(camera: "sextant.CameraModel", marker_map: "sextant.MarkerMap", T_map_camera) -> bool:
    """Whether all markers with their white margins are in the image."""
    T_camera_map = np.linalg.inv(T_map_camera)
    for marker in marker_map.markers:
        prints = np.c_[sextant.marker_corners(WHITE_MARGIN * marker.size), np.ones(4)]
        for point in prints @ marker.T_map_marker.T @ T_camera_map.T:
            pixel = camera.project(point[:3]) if point[2] > 0.0 else None
            if pixel is None or np.any(pixel < 0) or np.any(pixel > [camera.width - 1, camera.height - 1]):
                return False
    return True


class _Trial(NamedTuple):
    detected: float  # fraction of the markers
    position_error: float  # m; infinite without a pose
    angle_error: float  # rad; infinite without a pose
    cpu: float  # s


class _Localizer:
    """Detects markers of a map in single images, and locates the camera."""

    def __init__(self, family: str, camera: "sextant.CameraModel", marker_map: "sextant.MarkerMap"):
        params = sextant.DetectorParams()
        params.families, params.search = [family], "full"  # tracking needs a sequence of images
        self._detector, self._locator = sextant.MarkerDetector(params), sextant.MarkerLocator()
        self._camera, self._map = camera, marker_map

    def locate(self, image: np.ndarray, T_map_camera: np.ndarray) -> _Trial:
        """Locates the camera and compares its pose with the truth."""
        start = time.process_time()
        detections = self._detector.detect(image, self._camera)
        view = sextant.MarkerView(self._camera, np.eye(4), detections)
        pose = self._locator.locate(self._map, [view]).pose
        cpu = time.process_time() - start
        ids = {marker.id for marker in self._map.markers}
        detected = len(ids & {each.id for each in detections}) / len(ids)
        if pose is None:
            return _Trial(detected, np.inf, np.inf, cpu)
        error = sextant.pose_error(T_map_camera, pose.T_map_base)
        return _Trial(detected, *(float(np.linalg.norm(part)) for part in np.split(error, 2)), cpu)


def _summary(cell: Cell, pixels: float, trials: List[_Trial]) -> CellResult:
    detected, errors, angle_errors, cpu = map(np.array, zip(*trials))
    return CellResult(
        cell,
        pixels,
        len(trials),
        detected=float(np.mean(detected)),
        located=float(np.mean(np.isfinite(errors))),
        median_error=_quantile(errors, 0.5),
        error=_quantile(errors, QUANTILE),
        angle_error=_quantile(angle_errors, QUANTILE),
        cpu=_quantile(cpu, 0.5),
    )


def _quantile(values: np.ndarray, fraction: float) -> float:
    """Returns the smallest value that at least this fraction of the values do not exceed."""
    return float(np.sort(values)[int(np.ceil(fraction * len(values) - 1e-9)) - 1])
