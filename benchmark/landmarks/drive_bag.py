# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes a recorded drive of the UTIAS MRCLAM dataset as a bag with the parameters of its robots.

In benchmark/:

    python3 -m landmarks.drive_bag ../../shared/data/landmarks/mrclam 1 2 -o drive.bag
    rosrun sextant map_landmarks drive.bag -o map.yaml --params drive.yaml
"""

import argparse
import sys
from pathlib import Path
from typing import Callable, Optional, Sequence

import numpy as np
import rosbag
import rospy
import yaml
from geometry_msgs.msg import Point, Pose, PoseWithCovariance, Quaternion
from nav_msgs.msg import Odometry
from std_msgs.msg import Header

from landmarks.commanded_drive import read_commanded_drive
from landmarks.stamped_drive import DELAY, LABELS, StampedDrive, arriving, labelled, slam_params
from sextant.base.atomic_file import atomic_file, atomic_files
from sextant.commands.command_line import Answer, CommandParser, check_output, run
from sextant.messages.landmark_messages import observations_to_messages
from sextant.msg import LandmarkObservations

BEGIN = 1.0  # seconds: a stamp of zero is none
ODOMETRY, BASE = "odom", "base_link"


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """:returns: exit code"""
    parser = CommandParser(prog="drive_bag", description=__doc__)
    parser.add_argument("folder", type=Path, help="of the dataset, with a folder for each set")
    parser.add_argument("set", type=int, help="number of the set")
    parser.add_argument("robot", type=int, help="number of the robot")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="BAG", help="bag to write, .bag")
    parser.add_argument(
        "--labels", choices=list(LABELS), default="three classes",
        help="of the landmarks (default: %(default)s, the remainder of the id divided by three)",
    )  # fmt: skip
    parser.add_argument("--force", action="store_true", help="overwrite existing files")
    return run(parser, arguments, _write)


def _write(options: argparse.Namespace) -> Answer:
    params = options.output.with_suffix(".yaml")
    if options.output.suffix != ".bag":
        raise ValueError(f"{options.output}: the file name of a bag must end in .bag")
    for path in (options.output, params):
        check_output(path, options.force)
    drive = read_commanded_drive(options.folder, options.set, options.robot)
    write_drive_bag(options.output, drive, LABELS[options.labels])
    with atomic_file(params) as file:
        yaml.safe_dump(_differing(slam_params()), file)
    return Answer([f"{options.output}: {len(drive.scans)} scans", f"{params}: parameters of landmark_slam"])


def write_drive_bag(path: Path, drive: StampedDrive, label: Callable[[int], object]) -> None:
    """Writes odometry and each scan DELAY after its stamp, as the benchmark has them."""
    with atomic_files(path.parent) as folder, rosbag.Bag(str(folder / path.name), "w") as bag:
        written = _Odometry(bag)
        for stamp, sightings in arriving(drive, written):
            seen = [labelled(each, label) for each in sightings]
            message = LandmarkObservations(_header(stamp, BASE), observations_to_messages(seen))
            bag.write("/landmarks", message, _time(stamp + DELAY))


class _Odometry:
    """Writes readings in place of a timeline."""

    def __init__(self, bag: rosbag.Bag):
        self._bag = bag

    def odometry(self, stamp: float, pose: np.ndarray) -> None:
        """Writes a pose (3,), stamp in seconds."""
        turn = Quaternion(0.0, 0.0, np.sin(0.5 * pose[2]), np.cos(0.5 * pose[2]))
        at = PoseWithCovariance(pose=Pose(Point(pose[0], pose[1], 0.0), turn))
        message = Odometry(header=_header(stamp, ODOMETRY), child_frame_id=BASE, pose=at)
        self._bag.write("/odom", message, _time(stamp))


def _header(stamp: float, frame: str) -> Header:
    return Header(stamp=_time(stamp), frame_id=frame)


def _time(stamp: float) -> rospy.Time:
    return rospy.Time(0, round(1e9 * (BEGIN + stamp)))


def _differing(params) -> dict:
    """Values by name of the parameters that differ from their defaults."""
    default = type(params)()
    names = [name for name, *_ in type(params).fields()]
    return {name: getattr(params, name) for name in names if getattr(params, name) != getattr(default, name)}


if __name__ == "__main__":
    sys.exit(main())
