# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulates a robot that stands at surveyed points, and writes the bags, points.csv and map.yaml.

    simulate_series simulated                          nine points in a room with eight markers
    simulate_series simulated --points points.csv --map map.yaml --calibration camera.yaml

accuracy_statistics reads them. With your points, map and camera, it shows which accuracy to expect before
anything is mounted. points.csv has the columns bag,x,y,z,yaw (m, rad); the bags are written.
"""

import argparse
import functools
from pathlib import Path
from typing import Iterator, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

import sextant
from sextant.bags.camera_bag_writer import write_camera_bag
from sextant.base.jobs import run_jobs
from sextant.calibration.calibration_file import read_calibration
from sextant.commands.command_line import Answer, CommandParser, check_output, run
from sextant.commands.located_bags import read_map
from sextant.evaluation.surveyed_points import SURVEYED, SurveyedPoint, read_points, write_points
from sextant.simulation.drive import DriveParams, SimulatedDrive
from sextant.simulation.motion import Motion
from sextant.simulation.room_markers import MARKER_SIZE, default_map

GRID, HEADING = 0.61, 0.785  # of the default points: distance in metres; yaw in radians, to a corner
START = 1_600_000_000 * 10**9  # stamp of the first image, nanoseconds
PAUSE = 60 * 10**9  # nanoseconds between the first images of two points
STEP = 10**8  # nanoseconds between two images
CAMERA = (*DriveParams().camera_xyz, *DriveParams().camera_rpy)


class _Station(NamedTuple):
    number: int  # of the point, from 1
    point: SurveyedPoint
    path: Path  # bag to write


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Runs the command.

    :returns: exit code: 0, or 2 for invalid input
    """
    return run(_parser(), arguments, _simulate)


def _parser() -> CommandParser:
    parser = CommandParser(prog="simulate_series", description=__doc__)
    add = parser.add_argument
    add("folder", type=Path, metavar="FOLDER", help="folder to write, created if it does not exist")
    add("--force", action="store_true", help="overwrite existing files")
    add("--points", type=Path, metavar="FILE", help="points, .csv (default: a grid of nine points)")
    add("--images", type=int, default=30, metavar="N", help="images per point (default: %(default)s)")
    add("--map", metavar="FILE", help="marker map (default: eight markers in a room of 6 m x 6 m)")
    add("--family", default=sextant.DetectorParams().families[0], help="default: %(default)s")
    add(
        "--size", type=float, default=MARKER_SIZE, metavar="METRES",
        help="edge length of the markers of a map in the plain text format (default: %(default)s)",
    )  # fmt: skip
    add("--calibration", metavar="FILE", help="of your camera (default: 640 x 480 pixels, 62 degrees)")
    add(
        "--camera", type=float, nargs=6, default=CAMERA, metavar=("X", "Y", "Z", "ROLL", "PITCH", "YAW"),
        help="the camera on the robot, m and rad; 0 0 0: it faces forward (default:"
        f" {' '.join(f'{each:g}' for each in CAMERA)})",
    )  # fmt: skip
    add("--seed", type=int, default=1, help="random seed of walls and noise (default: %(default)s)")
    add("--jobs", type=int, default=1, metavar="N", help="number of bags written in parallel")
    return parser


def _simulate(options: argparse.Namespace) -> Answer:
    if options.images < 1:
        raise ValueError(f"--images is {options.images}, allowed is a whole number from 1 on")
    points = read_points(options.points) if options.points else default_points()
    stations = _stations(points, options)
    table, map_file = options.folder / "points.csv", options.folder / "map.yaml"
    _prepare([table, map_file, *(station.path for station in stations)], options.force)
    names = [point.where or point.bag for point in points]
    written = list(run_jobs(functools.partial(_write, options=options), stations, options.jobs, names=names))
    sextant.write_marker_map(_marker_map(options), str(map_file))
    write_points(table, points)
    lines = [f"{path}: {options.images} images" for path in written]
    following = f"accuracy_statistics --points {table} --map {map_file}"
    return Answer([*lines, f"{table}, {map_file}: points and map. Next: {following}"])


def _prepare(paths: Sequence[Path], force: bool) -> None:
    """Creates the folders of files to write.

    :raises ValueError: a file exists; no folder was created
    """
    for path in paths:
        if path.parent.is_dir():
            check_output(path, force)
    for path in paths:
        path.parent.mkdir(parents=True, exist_ok=True)


def default_points() -> List[SurveyedPoint]:
    """Nine points on a grid in the middle of the default room; the robot faces a corner."""
    grid = (GRID, 0.0, -GRID)
    return [
        SurveyedPoint(f"p{number}.bag", dict(zip(SURVEYED, (x, y, 0.0, HEADING))))
        for number, (x, y) in enumerate(((x, y) for x in grid for y in grid), 1)
    ]


def _stations(points: Sequence[SurveyedPoint], options: argparse.Namespace) -> List[_Station]:
    """Checks everything before the first bag is written.

    :raises ValueError: a coordinate is unknown, the camera is outside of the room, or a bag of the folder
    """
    stations = [_station(number, point, options.folder) for number, point in enumerate(points, 1)]
    drive = _simulated(options)
    for station in stations:
        if not drive.is_camera_inside(_motion(station.point)):
            what = "the camera is outside of the room, which encloses the markers of the map"
            raise ValueError(f"{station.point.where}: {what}; correct the point or --camera")
    return stations


def _station(number: int, point: SurveyedPoint, folder: Path) -> _Station:
    unknown = [axis for axis, value in point.truth.items() if value is None]
    if unknown:
        raise ValueError(f"{point.where}: {unknown[0]} is unknown; a simulated robot needs a number")
    name = Path(point.bag)
    if name.is_absolute() or ".." in name.parts:
        raise ValueError(f"{point.where}: {point.bag} is not in {folder}; name a file in it, e.g. p1.bag")
    return _Station(number, point, folder / (name if name.suffix == ".bag" else name / "1.bag"))


def _motion(point: SurveyedPoint) -> Motion:
    return Motion(*(float(point.truth[axis]) for axis in SURVEYED))


def _marker_map(options: argparse.Namespace) -> "sextant.MarkerMap":
    return read_map(options) or default_map(options.family)


def _simulated(options: argparse.Namespace, first: int = 0) -> SimulatedDrive:
    xyz, rpy = list(options.camera[:3]), list(options.camera[3:])
    params = DriveParams(seed=options.seed, camera_xyz=xyz, camera_rpy=rpy, obstacles=False)
    calibration = read_calibration(options.calibration) if options.calibration else None
    return SimulatedDrive(params, _marker_map(options), calibration, first)


def _write(station: _Station, options: argparse.Namespace) -> Path:
    """Renders and writes the images of one point."""
    drive = _simulated(options, station.number * options.images)
    images = _images(drive, _motion(station.point), START + station.number * PAUSE, options.images)
    write_camera_bag(station.path, images, drive.calibration, drive.T_base_camera)
    return station.path


def _images(
    drive: SimulatedDrive, motion: Motion, start: int, count: int
) -> Iterator[Tuple[int, np.ndarray]]:
    for number in range(count):
        yield start + number * STEP, drive.frame(motion).image
