# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks whether a camera's calibration is still valid, from photos of markers at measured distances.

The name of a photo's folder is the distance in metres, from the lens straight to the centre of the marker.
Exit code: 0 valid, 1 not valid, 2 undecided or invalid input.
"""

import argparse
from pathlib import Path
from typing import Dict, List, Optional, Tuple

import cv2

import sextant
from sextant.calibration.calibration_check import CalibrationCheck, CheckParams, check_calibration
from sextant.calibration.calibration_file import read_calibration
from sextant.calibration.calibration_observations import Observation, board_observation, marker_observations
from sextant.commands.command_line import Answer, CommandParser, run

_ENDINGS = (".png", ".jpg", ".jpeg", ".pgm", ".bmp", ".tif", ".tiff")
_EXAMPLES = """\
examples:
  check_calibration camera.yaml --family tag36h11 --size 0.16 0.5 1.0 2.0
  check_calibration camera.yaml --family tag36h11 --size 0.16 1.0/*.png 2.5/*.png --also corners
  check_calibration camera.yaml --map board.yaml --distances tape.txt
"""
_VERDICTS = ("good", "NOT GOOD", "undecided")

Photos = Dict[Path, Optional[float]]  # distance in metres by path; None: not measured


def main(arguments: Optional[List[str]] = None) -> int:
    """Runs the command.

    :returns: exit code: 0 valid, 1 not valid, 2 undecided or invalid input
    """
    return run(_parser(), arguments, _check)


def _parser() -> CommandParser:
    parser = CommandParser(prog="check_calibration", description=__doc__, epilog=_EXAMPLES)
    params = CheckParams()
    parser.add_argument("calibration", type=Path, help="YAML file of camera_calibration")
    parser.add_argument("photos", type=Path, nargs="*", help="photos, or folders of photos")
    parser.add_argument("--family", help="dictionary or family of the marker: tag36h11, DICT_4X4_50, ...")
    parser.add_argument("--size", type=float, metavar="METRES", help="measured edge length of the marker")
    parser.add_argument("--id", type=int, help="the measured marker, if photos show several")
    parser.add_argument(
        "--map",
        type=Path,
        metavar="FILE",
        help="marker map of a board, instead of --family, --size, --id: its markers must fit one pose;"
        " distances are to the origin of the map, the centre of a board of make_markers",
    )
    parser.add_argument(
        "--distances", type=Path, metavar="FILE", help="lines 'PHOTO METRES', paths relative to the file"
    )
    parser.add_argument(
        "--also", type=Path, nargs="+", default=[], metavar="PHOTO", help="photos without a measured distance"
    )
    for name, what in (
        ("tape", "a measured distance, metres"),
        ("size", "--size, metres"),
        ("zero", "the distance from the tape's zero to the lens, metres"),
        ("corner", "the markers' corners, pixels"),
    ):
        default = getattr(params, f"{name}_sigma")
        text = f"standard deviation of {what} (default: %(default)s)"
        parser.add_argument(f"--{name}-sigma", type=float, default=default, help=text)
    return parser


def _check(options: argparse.Namespace) -> Answer:
    params = CheckParams(options.tape_sigma, options.size_sigma, options.zero_sigma, options.corner_sigma)
    _check_options(options)
    calibration = read_calibration(options.calibration)
    observations, empty = _observe(calibration, _photos(options), options)
    check = check_calibration(calibration, observations, params)
    lines = _table(check)
    if empty:
        lines.append(f"no marker in {len(empty)}: {', '.join(map(str, empty))}")
    lines += (f"{_VERDICTS[check.state]}: {reason}" for reason in check.reasons)
    return Answer(lines, check.state)


def _check_options(options: argparse.Namespace) -> None:
    of_marker = {"--family": options.family, "--size": options.size}
    if options.map is not None:
        given = [name for name, value in {**of_marker, "--id": options.id}.items() if value is not None]
        if given:
            raise ValueError(f"{given[0]} has no effect with --map")
        return
    missing = [name for name, value in of_marker.items() if value is None]
    if missing:
        raise ValueError(f"{missing[0]} is needed, or --map")
    if not 0.0 < options.size <= 100.0:
        raise ValueError(f"--size is {options.size}, allowed is (0, 100] metres")


# ---- photos and their distances ---------------------------------------------------------------------------


def _photos(options: argparse.Namespace) -> Photos:
    photos: Photos = {}
    for path in options.photos:
        for photo in _photo_paths(path):
            photos[photo] = _distance(photo.resolve().parent.name, f"{photo}: its folder's name")
    photos.update(_listed(options.distances) if options.distances else {})
    for path in options.also:
        photos.update(dict.fromkeys(_photo_paths(path)))
    if not photos:
        raise ValueError("no photos are given")
    return photos


def _photo_paths(path: Path) -> List[Path]:
    if path.is_file():
        return [path]
    if not path.is_dir():
        raise ValueError(f"{path}: there is no such photo or folder")
    photos = sorted(each for each in path.iterdir() if each.suffix.lower() in _ENDINGS)
    if not photos:
        raise ValueError(f"{path}: there is no photo in this folder")
    return photos


def _distance(text: str, what: str) -> float:
    try:
        distance = float(text)
    except ValueError:
        distance = 0.0
    if not 0.0 < distance <= 1000.0:
        raise ValueError(f"{what} must be the distance in metres, not '{text}'")
    return distance


def _listed(path: Path) -> Photos:
    photos: Photos = {}
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        photo, _, distance = line.partition("#")[0].strip().rpartition(" ")
        if not photo and not distance:
            continue
        file = path.parent / photo.strip()
        if not file.is_file():
            raise ValueError(f"{path}:{number}: there is no photo '{photo.strip()}'")
        photos[file] = _distance(distance, f"{path}:{number}: the last word")
    return photos


# ---- markers in the photos --------------------------------------------------------------------------------


def _observe(
    calibration, photos: Photos, options: argparse.Namespace
) -> Tuple[List[Observation], List[Path]]:
    """Returns the observations, and the photos without markers."""
    board = None if options.map is None else sextant.read_marker_map(str(options.map))
    params, camera = sextant.DetectorParams(), sextant.CameraModel(calibration)
    families = (
        [sextant.canonical_family(options.family)] if board is None else [m.family for m in board.markers]
    )
    params.families = sorted(set(families))
    detector = sextant.MarkerDetector(params)
    observations, empty = [], []
    for photo, distance in photos.items():
        detections = detector.detect(_read_image(photo, calibration), camera)
        noise = options.corner_sigma
        if board is None:
            found = marker_observations(str(photo), detections, options.size, distance, options.id, noise)
        else:
            found = board_observation(str(photo), detections, board, distance, noise)
        observations += found
        if not found:
            empty.append(photo)
    return observations, empty


def _read_image(photo: Path, calibration):
    image = cv2.imread(str(photo), cv2.IMREAD_GRAYSCALE | cv2.IMREAD_IGNORE_ORIENTATION)
    if image is None:
        raise ValueError(f"{photo}: is not an image")
    height, width = image.shape
    if (width, height) != (calibration.width, calibration.height):
        raise ValueError(
            f"{photo}: has {width} x {height} pixels, the calibration is for"
            f" {calibration.width} x {calibration.height}"
        )
    return image


# ---- printed output ---------------------------------------------------------------------------------------


def _table(check: CalibrationCheck) -> List[str]:
    lines = ["measured   estimated   photos"]
    for each in check.distances:
        lines.append(f"{each.measured:6.3f} m   {each.estimated:6.3f} m   {each.photos:6d}")
    lines += ["", "corners    residual    noise alone"]
    for ring in check.rings:
        lines.append(
            f"{ring.name:8s}  {ring.residual:6.2f} px   {ring.noise:6.2f} px   {ring.corners:4d} corners"
        )
    lines += ["", f"{'calibration':26s} error        +-   allowed"]
    for each in check.deviations:
        numbers = f"{each.error:+8.2f} {each.sigma:9.2f} {each.tolerance:9.2f} {each.unit:3s}"
        lines.append(f"{each.name:24s}{numbers}{_VERDICTS[each.state]}")
    return [*lines, ""]
