# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tells whether a camera's calibration is still good, from photos of markers at measured distances.

A photo's folder is named by its distance in metres, straight from the lens to the middle of the marker.
Exit code: 0 still good, 1 not good, 2 cannot tell or bad input.
"""

import argparse
from pathlib import Path
from typing import Dict, List, Optional, Tuple

import cv2

import sextant
from sextant.calibration.calibration_check import CalibrationCheck, CheckParams, check_calibration
from sextant.calibration.calibration_file import read_calibration
from sextant.calibration.calibration_sightings import Sighting, board_sighting, sightings_of
from sextant.commands.command_line import Answer, CommandParser, run

_ENDINGS = (".png", ".jpg", ".jpeg", ".pgm", ".bmp", ".tif", ".tiff")
_EXAMPLES = """\
examples:
  check_calibration camera.yaml --family tag36h11 --size 0.16 0.5 1.0 2.0
  check_calibration camera.yaml --family tag36h11 --size 0.16 1.0/*.png 2.5/*.png --also corners
  check_calibration camera.yaml --map board.yaml --distances tape.txt
"""
_ANSWERS = ("good", "NOT GOOD", "cannot tell")

Photos = Dict[Path, Optional[float]]


def main(arguments: Optional[List[str]] = None) -> int:
    """:returns: exit code: 0 still good, 1 not good, 2 cannot tell or bad input."""
    return run(_parser(), arguments, _check)


def _parser() -> CommandParser:
    parser = CommandParser(prog="check_calibration", description=__doc__, epilog=_EXAMPLES)
    params = CheckParams()
    parser.add_argument("calibration", type=Path, help="YAML, as camera_calibration writes it")
    parser.add_argument("photos", type=Path, nargs="*", help="pictures, or folders of them")
    parser.add_argument("--family", help="dictionary or family of the marker: tag36h11, DICT_4X4_50, ...")
    parser.add_argument("--size", type=float, metavar="METRES", help="edge of the marker, as measured")
    parser.add_argument("--id", type=int, help="the measured marker, where photos show several")
    parser.add_argument(
        "--map",
        type=Path,
        metavar="FILE",
        help="marker map of a board, in place of --family, --size, --id: its markers must fit one pose;"
        " distances are those of the map's origin, the middle of a board of make_markers",
    )
    parser.add_argument(
        "--distances", type=Path, metavar="FILE", help="lines 'PHOTO METRES', photos as seen from the file"
    )
    parser.add_argument(
        "--also", type=Path, nargs="+", default=[], metavar="PHOTO", help="photos of no measured distance"
    )
    for name, what in (
        ("tape", "how exact a distance is, metres"),
        ("size", "how exact --size is, metres"),
        ("zero", "how far the tape's zero may be from the lens, metres"),
        ("corner", "noise of the markers' corners, pixels"),
    ):
        default = getattr(params, f"{name}_sigma")
        parser.add_argument(
            f"--{name}-sigma", type=float, default=default, help=f"{what} (default: %(default)s)"
        )
    return parser


def _check(options: argparse.Namespace) -> Answer:
    params = CheckParams(options.tape_sigma, options.size_sigma, options.zero_sigma, options.corner_sigma)
    _check_options(options)
    calibration = read_calibration(options.calibration)
    sightings, empty = _look(calibration, _photos(options), options)
    check = check_calibration(calibration, sightings, params)
    lines = _table(check)
    if empty:
        lines.append(f"no marker in {len(empty)}: {', '.join(map(str, empty))}")
    lines += (f"{_ANSWERS[check.state]}: {reason}" for reason in check.reasons)
    return Answer(lines, check.state)


def _check_options(options: argparse.Namespace) -> None:
    of_marker = {"--family": options.family, "--size": options.size}
    if options.map is not None:
        given = [name for name, value in {**of_marker, "--id": options.id}.items() if value is not None]
        if given:
            raise ValueError(f"{given[0]} is told by --map")
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
        for picture in _pictures(path):
            photos[picture] = _distance(picture.resolve().parent.name, f"{picture}: its folder's name")
    photos.update(_listed(options.distances) if options.distances else {})
    for path in options.also:
        photos.update(dict.fromkeys(_pictures(path)))
    if not photos:
        raise ValueError("which photos?")
    return photos


def _pictures(path: Path) -> List[Path]:
    if path.is_file():
        return [path]
    if not path.is_dir():
        raise ValueError(f"{path}: there is no such photo or folder")
    pictures = sorted(each for each in path.iterdir() if each.suffix.lower() in _ENDINGS)
    if not pictures:
        raise ValueError(f"{path}: there is no picture in this folder")
    return pictures


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
        picture = path.parent / photo.strip()
        if not picture.is_file():
            raise ValueError(f"{path}:{number}: there is no photo '{photo.strip()}'")
        photos[picture] = _distance(distance, f"{path}:{number}: the last word")
    return photos


# ---- markers in them --------------------------------------------------------------------------------------


def _look(calibration, photos: Photos, options: argparse.Namespace) -> Tuple[List[Sighting], List[Path]]:
    """What the photos show, and the photos that show nothing."""
    board = None if options.map is None else sextant.read_marker_map(str(options.map))
    params, camera = sextant.DetectorParams(), sextant.CameraModel(calibration)
    families = (
        [sextant.canonical_family(options.family)] if board is None else [m.family for m in board.markers]
    )
    params.families = sorted(set(families))
    detector = sextant.MarkerDetector(params)
    sightings, empty = [], []
    for photo, distance in photos.items():
        detections = detector.detect(_picture(photo, calibration), camera)
        noise = options.corner_sigma
        if board is None:
            found = sightings_of(str(photo), detections, options.size, distance, options.id, noise)
        else:
            found = board_sighting(str(photo), detections, board, distance, noise)
        sightings += found
        if not found:
            empty.append(photo)
    return sightings, empty


def _picture(photo: Path, calibration):
    picture = cv2.imread(str(photo), cv2.IMREAD_GRAYSCALE | cv2.IMREAD_IGNORE_ORIENTATION)
    if picture is None:
        raise ValueError(f"{photo}: is no picture")
    height, width = picture.shape
    if (width, height) != (calibration.width, calibration.height):
        raise ValueError(
            f"{photo}: has {width} x {height} pixels, the calibration is for"
            f" {calibration.width} x {calibration.height}"
        )
    return picture


# ---- what is printed --------------------------------------------------------------------------------------


def _table(check: CalibrationCheck) -> List[str]:
    lines = ["distance   seen as     photos"]
    for each in check.distances:
        lines.append(f"{each.told:6.3f} m   {each.seen:6.3f} m   {each.photos:6d}")
    lines += ["", "corners    off by      noise alone"]
    for ring in check.rings:
        lines.append(
            f"{ring.name:8s}  {ring.residual:6.2f} px   {ring.noise:6.2f} px   {ring.corners:4d} corners"
        )
    lines += ["", f"{'the calibration is':26s}off by        +-   allowed"]
    for each in check.deviations:
        told = f"{each.error:+8.2f} {each.sigma:9.2f} {each.tolerance:9.2f} {each.unit:3s}"
        lines.append(f"{each.name:24s}{told}{_ANSWERS[each.state]}")
    return [*lines, ""]
