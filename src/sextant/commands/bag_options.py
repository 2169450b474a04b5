# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Options of commands that read bags, and parallel reading of bags."""

import argparse
from typing import Any, Callable, Dict, List, Sequence, Tuple

import numpy as np

import sextant
from sextant.bags.bag_params import BagParams
from sextant.base.jobs import JobError, run_jobs


def add_bag_options(group) -> None:
    """Adds the options of topics and calibrations."""
    group.add_argument("--images", nargs="+", default=[], metavar="TOPIC", help="topics of images")
    group.add_argument("--markers", nargs="+", default=[], metavar="TOPIC", help="topics of marker_detector")
    group.add_argument(
        "--calibrations", nargs="+", type=pair, default=[], metavar="TOPIC=FILE",
        help="calibration files that replace camera_info",
    )  # fmt: skip
    group.add_argument(
        "--rectified", nargs="+", default=[], metavar="TOPIC",
        help="topics of rectified images, besides those named image_rect...",
    )  # fmt: skip
    group.add_argument("--every", type=int, default=1, metavar="N", help="use every n-th image only")


def add_robot_options(group) -> None:
    """Adds the options of camera mounts and odometry."""
    add_mount_options(group)
    group.add_argument(
        "--odometry", default="", metavar="TOPIC", help="topic of odometry, or none (default: the only one)"
    )


def add_mount_options(group) -> None:
    """Adds the options of camera mounts."""
    group.add_argument(
        "--mounts", nargs="+", type=pair, default=[], metavar="FRAME=X,Y,Z,ROLL,PITCH,YAW",
        help="poses of optical frames in the base frame, if the bag has no tf",
    )  # fmt: skip
    group.add_argument(
        "--base-frame", default=BagParams.base_frame, help="base frame of the robot (default: %(default)s)"
    )


def add_job_options(group) -> None:
    """Adds the options of parallel reading."""
    group.add_argument("--skip", action="store_true", help="skip bags that cannot be read")
    group.add_argument("--jobs", type=int, default=1, metavar="N", help="number of bags read in parallel")
    group.add_argument(
        "--scheduler", default="", metavar="tcp://HOST:PORT", help="Dask cluster that reads the bags"
    )


def pair(text: str) -> Tuple[str, str]:
    """Parses NAME=VALUE.

    :raises argparse.ArgumentTypeError: another form
    """
    name, equals, value = text.partition("=")
    if not (name and equals and value):
        raise argparse.ArgumentTypeError(f"{text!r} is not NAME=VALUE")
    return name, value


def bag_params(options: argparse.Namespace, families: Sequence[str] = (), **others: Any) -> BagParams:
    """Returns the parameters set by add_bag_options() and add_robot_options().

    :param families: empty: the detector's default
    :param others: further fields
    :raises ValueError: an invalid value
    """
    given: Dict[str, Any] = {"families": tuple(families)} if families else {}
    return BagParams(
        images=tuple(options.images), markers=tuple(options.markers),
        calibrations=dict(options.calibrations), rectified=tuple(options.rectified), every=options.every,
        mounts=read_mounts(options.mounts), base_frame=options.base_frame, odometry=options.odometry,
        **given, **others,
    )  # fmt: skip


def read_mounts(pairs: Sequence[Tuple[str, str]]) -> Dict[str, np.ndarray]:
    """Parses --mounts.

    :returns: T_base_camera (4, 4) by camera frame
    :raises ValueError: an invalid pose
    """
    return {frame: _mount(frame, text) for frame, text in pairs}


def _mount(frame: str, text: str) -> np.ndarray:
    try:
        numbers = [float(word) for word in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != 6:
        raise ValueError(f"--mounts {frame} is {text!r}, allowed are six numbers: x,y,z,roll,pitch,yaw")
    return sextant.pose_from_xyz_rpy(numbers[:3], numbers[3:])


def read_bags(
    read: Callable[[str], Any], bags: Sequence[str], options: argparse.Namespace
) -> Tuple[List[Tuple[str, Any]], List[str]]:
    """Calls read(bag) for every bag, as set by add_job_options().

    :param read: a module's function or functools.partial of one; its result has a field warnings
    :returns: (bag, result) of every bag, and notes
    :raises JobError: a bag cannot be read, without --skip
    :raises ValueError: no bag can be read
    """
    results = run_jobs(
        read, bags, options.jobs, options.scheduler, return_errors=options.skip, progress="bags"
    )
    good: List[Tuple[str, Any]] = []
    notes: List[str] = []
    for bag, result in zip(bags, results):
        if isinstance(result, JobError):
            notes.append(f"skipped: {result}")
            continue
        good.append((bag, result))
        notes += [f"{bag}: {warning}" for warning in result.warnings]
    if not good:
        raise ValueError("no bag could be read: " + "; ".join(notes))
    return good, notes
