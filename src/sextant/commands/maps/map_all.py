# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes all maps of one drive in one frame: markers, landmarks, and photos of places with their poses.

    map_all drive.bag -o hall/ --size 0.16
    map_all drive.bag -o hall/ --size 0.16 --known door.yaml      in the frame of door.yaml

What the bags lack is left out. roslaunch sextant localization.launch maps:=hall/ uses the maps. Landmarks are
mapped among the markers, and photos get the poses of that estimate.
"""

import argparse
import functools
from typing import List, NamedTuple, Optional, Sequence, Set, Tuple, Union

import numpy as np

import sextant
from sextant.bags.bag_file import BagError, BagFile
from sextant.bags.bag_params import NO_ODOMETRY
from sextant.bags.camera_topics import MARKERS as MARKER_ARRAY
from sextant.bags.camera_topics import choose_image_topic, image_topics
from sextant.bags.drive_photos import BasePath, read_drive_photos
from sextant.bags.drive_reader import RecordedDrive
from sextant.bags.landmark_reader import LANDMARKS as OBSERVATIONS
from sextant.bags.odometry import ODOMETRY
from sextant.base.findings import count_text, verdict_text
from sextant.commands.bag_options import add_bag_options, add_job_options, add_robot_options, read_bags
from sextant.commands.command_line import Answer, CommandParser, run
from sextant.commands.map_landmarks import (
    MadeLandmarks,
    landmark_params,
    made_landmarks,
    observation_reading,
    report_landmarks,
)
from sextant.commands.map_markers import (
    MadeMarkers,
    MarkerInputs,
    add_frame_options,
    add_marker_options,
    drive_reading,
    made_markers,
    marker_inputs,
    write_markers,
)
from sextant.commands.maps.drive_maps import (
    Drives,
    Params,
    Recorded,
    landmarks_among,
    own_landmarks,
    path_of_landmarks,
    path_of_markers,
    with_path_by_landmarks,
)
from sextant.commands.maps.maps_folder import (
    LANDMARK_PAGE,
    LANDMARKS,
    MARKER_PAGE,
    MARKERS,
    PLACES,
    MapPart,
    add_folder_options,
    begin_folder,
    check_folder,
    detector_arguments,
    params_arguments,
    write_folder,
)
from sextant.commands.places import place_map_of_drives as photos_of_drives
from sextant.landmarks.landmark_findings import list_findings
from sextant.landmarks.slam_run import SlamRun
from sextant.mapping.map_findings import findings as marker_findings
from sextant.mapping.map_findings import verdict as marker_verdict

FLOOR_SIGMA = 0.01  # metres, default of --floor-sigma: landmarks are in the plane of the floor
CAMERA_INFO = "sensor_msgs/CameraInfo"

Reason = str  # why there is no map


class _Recording(NamedTuple):
    """What the bags have."""

    types: Set[str]  # of messages
    has_images: bool  # of a camera


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """:returns: exit code: 0, or 2 when nothing was written."""
    return run(_parser(), arguments, _make)


def _parser() -> CommandParser:
    parser = CommandParser(prog="map_all", description=__doc__)
    parser.add_argument("bags", nargs="+", metavar="BAG", help="bag with odometry, images and landmarks")
    add_folder_options(parser)
    add_frame_options(parser.add_argument_group("map frame"))
    add_marker_options(parser.add_argument_group("markers"))
    landmarks = parser.add_argument_group("landmarks").add_argument
    landmarks("--landmarks", default="", metavar="TOPIC", help="of the observations (default: the only one)")
    landmarks("--params", metavar="YAML", help="parameters of the nodelet landmark_slam")
    photos = parser.add_argument_group("photos")
    for add in (photos_of_drives.add_photo_options, photos_of_drives.add_image_options):
        add(photos)
    bags = parser.add_argument_group("bags")
    for add in (add_bag_options, add_robot_options, add_job_options):
        add(bags)
    # Those of make_place_map drive that are not set here: a new map, with the poses of the other maps.
    parser.set_defaults(
        floor_sigma=FLOOR_SIGMA, pose="", add=False, map_yaml=None, margin=photos_of_drives.MARGIN
    )
    return parser


def _make(options: argparse.Namespace) -> Answer:
    """Reads the bags, makes the maps, and writes them with a page of findings."""
    check_folder(options.output, options.force)
    inputs, params = _checked(options)
    recording, notes = _recording(options), []
    drives = _read_markers(options, inputs, recording, notes)
    recorded = _read_landmarks(options, recording, notes)
    markers = _markers(options, inputs, drives, recorded, params)
    landmarks = _landmarks(markers, (drives, recorded), inputs, params, notes)
    path = _base_path(markers, landmarks)
    if path is None:
        raise ValueError(f"no map can be made: {markers}; {landmarks}")
    begin_folder(options.output)
    parts = [_written_markers(options, markers), _written_landmarks(options, landmarks)]
    parts.append(_photos(options, recording, path, notes))
    arguments = params_arguments(options.output, options.params)
    if not isinstance(markers, Reason):
        arguments.update(detector_arguments(markers.result.map, inputs.sizes))
    written = write_folder(options.output, "Maps of a drive", parts, arguments)
    return Answer([*notes, *(line for part in parts for line in part.lines()), *written])


def _checked(options: argparse.Namespace) -> Tuple[MarkerInputs, "sextant.LandmarkSlamNodeParams"]:
    """Checks the options before any bag is read."""
    photos_of_drives.check(options)
    photos_of_drives.photo_params(options)
    params, _ = landmark_params(options.params)
    params.map_file, params.marker_map_file, params.map_frame = "", "", options.frame
    params.start, params.read_only = "origin", False
    return marker_inputs(options), params


def _recording(options: argparse.Namespace) -> _Recording:
    """:raises BagError: a bag cannot be read, or it has several cameras and none is named"""
    types: Set[str] = set()
    has_images = False
    for path in options.bags:
        try:
            with BagFile(path) as bag:
                types.update(bag.types.values())
                if image_topics(bag)[0]:
                    choose_image_topic(bag, options.image)
                    has_images = True
        except BagError:
            if not options.skip:
                raise
    return _Recording(types, has_images)


# ---- what is read and made


def _read_markers(
    options: argparse.Namespace, inputs: MarkerInputs, recording: _Recording, notes: List[str]
) -> Union[Drives, Reason]:
    has_calibration = CAMERA_INFO in recording.types or options.calibrations
    if MARKER_ARRAY not in recording.types and not (recording.has_images and has_calibration):
        return f"the bags have neither {MARKER_ARRAY} nor images with camera_info"
    read, more = read_bags(drive_reading(options, inputs.known), options.bags, options)
    notes += [f"markers: {note}" for note in more]
    return dict(read)


def _read_landmarks(
    options: argparse.Namespace, recording: _Recording, notes: List[str]
) -> Union[Recorded, Reason]:
    if options.odometry == NO_ODOMETRY:
        return "odometry is not used"
    missing = sorted({OBSERVATIONS, ODOMETRY} - recording.types)
    if missing:
        return f"the bags have no {' and no '.join(missing)}"
    read, more = read_bags(observation_reading(options), options.bags, options)
    notes += [f"landmarks: {note}" for note in more]
    return dict(read)


def _markers(
    options: argparse.Namespace,
    inputs: MarkerInputs,
    drives: Union[Drives, Reason],
    recorded: Union[Recorded, Reason],
    params: Params,
) -> Union[MadeMarkers, Reason]:
    if isinstance(drives, Reason):
        return drives
    if all(map(_is_base, drives.values())):
        inputs.params.floor_height_sigma = 0.0
    elif not isinstance(recorded, Reason):
        drives = with_path_by_landmarks(drives, recorded, inputs, params)
    try:
        return made_markers(options, inputs, list(drives.values()))
    except RuntimeError as error:  # no marker can be located
        return str(error)


def _is_base(drive: RecordedDrive) -> bool:
    """Whether the poses are those of a camera, which is not on the floor."""
    return all(np.array_equal(camera.T_base_camera, np.eye(4)) for camera in drive.cameras.values())


def _landmarks(
    markers: Union[MadeMarkers, Reason],
    read: Tuple[Union[Drives, Reason], Union[Recorded, Reason]],
    inputs: MarkerInputs,
    params: Params,
    notes: List[str],
) -> Union[MadeLandmarks, Reason]:
    drives, recorded = read
    if isinstance(recorded, Reason):
        return recorded
    if isinstance(markers, Reason) or isinstance(drives, Reason):
        made = made_landmarks(list(recorded.values()), SlamRun(params))
    else:
        made = landmarks_among(markers, drives, recorded, inputs, params)
    notes += [f"landmarks: {note}" for note in made.notes]
    return made if own_landmarks(made) else "no landmark was observed often enough"


def _base_path(
    markers: Union[MadeMarkers, Reason], landmarks: Union[MadeLandmarks, Reason]
) -> Optional[BasePath]:
    """Poses of the base by all observations; None: there are none."""
    if not isinstance(landmarks, Reason):
        return path_of_landmarks(landmarks)
    return None if isinstance(markers, Reason) else path_of_markers(markers)


# ---- what is written


def _written_markers(options: argparse.Namespace, made: Union[MadeMarkers, Reason]) -> MapPart:
    if isinstance(made, Reason):
        return MapPart("markers", f"no map: {made}")
    write_markers(made, options.output / MARKERS, options.output / MARKER_PAGE)
    return MapPart(
        "markers", marker_verdict(made.quality), marker_findings(made.quality), MARKER_PAGE, MARKERS
    )


def _written_landmarks(options: argparse.Namespace, made: Union[MadeLandmarks, Reason]) -> MapPart:
    if isinstance(made, Reason):
        return MapPart("landmarks", f"no map: {made}")
    sextant.write_landmark_map(made.result.map, str(options.output / LANDMARKS))
    own, page, findings = own_landmarks(made), "", []
    if made.result.sightings:  # otherwise the map is that of the filter: the problems have the reason
        values = {"recording": ", ".join(options.bags), "params": options.params}
        report_landmarks(made, options.output / LANDMARK_PAGE, values)
        page, findings = LANDMARK_PAGE, [each for each in list_findings(made.result) if own & set(each.keys)]
    named = own & {key for finding in findings for key in finding.keys}
    verdict = verdict_text(f"{count_text(len(own), 'landmark')} mapped", len(named), "landmark")
    return MapPart("landmarks", verdict, [*made.problems, *map(str, findings)], page, LANDMARKS)


def _photos(options: argparse.Namespace, recording: _Recording, path: BasePath, notes: List[str]) -> MapPart:
    """Reads and writes the photos; the other maps remain if that is not possible."""
    if not recording.has_images:
        return MapPart("places", "no map: the bags have no images")
    of_photos = argparse.Namespace(**{**vars(options), "output": options.output / PLACES})
    reading = functools.partial(
        read_drive_photos, params=photos_of_drives.photo_params(options), base_path=path
    )
    try:
        read, more = read_bags(reading, options.bags, options)
        of_photos.output.parent.mkdir(exist_ok=True)
        *lines, made = photos_of_drives.write_photos(of_photos, read, more).lines
    except (OSError, ValueError, RuntimeError) as error:
        return MapPart("places", f"no map: {error}")
    notes += [f"places: {line}" for line in lines]
    return MapPart("places", made.removeprefix(f"{of_photos.output}: "), file=PLACES)
